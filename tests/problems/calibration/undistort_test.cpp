#include "graticule/problems/calibration/undistort.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "lenses.hpp"

namespace graticule {
namespace {

// What a scene of soft stripes looks like along a ray.
double ShadeOf(const Eigen::Vector3d& ray) {
  return 128 + 50 * std::sin(12 * ray.x() / ray.z()) + 50 * std::sin(9 * ray.y() / ray.z());
}

GreyImage ImageOf(const Camera& camera) {
  GreyImage image;
  image.width = static_cast<std::size_t>(camera.Width());
  image.height = static_cast<std::size_t>(camera.Height());
  for (int y = 0; y < camera.Height(); ++y)
    for (int x = 0; x < camera.Width(); ++x) {
      const auto ray = camera.Unproject({static_cast<double>(x), static_cast<double>(y)});
      image.shades.push_back(
          ray && ray->z() > 0.1 ? static_cast<std::uint8_t>(std::lround(ShadeOf(*ray))) : 0);
    }
  return image;
}

TEST(Undistort, FillsAViewOfValidPixels) {
  for (const CameraIntrinsics& lens : testing::Lenses()) {
    RectifyOptions options;
    options.width = 160;
    options.height = 120;
    const Camera camera(lens);
    const CameraIntrinsics view = RectifiedView(camera, options);
    EXPECT_EQ(Rectifier(camera, Camera(view)).Filled(), 1) << lens.model;
    // And no more could be had: a view that is a hundredth wider has empty pixels, or reaches the
    // angle that it may.
    CameraIntrinsics wider = view;
    wider.parameters[0] /= 1.02;
    wider.parameters[1] /= 1.02;
    const double corner =
        std::atan(std::hypot(std::max(wider.parameters[2], 159 - wider.parameters[2]),
                             std::max(wider.parameters[3], 119 - wider.parameters[3])) /
                  wider.parameters[0]);
    EXPECT_TRUE(corner > options.widest_rad || Rectifier(camera, Camera(wider)).Filled() < 1)
        << lens.model;
  }
}

TEST(Undistort, KeepsAllPixelsWhereThatIsAskedFor) {
  RectifyOptions options;
  options.keep = RectifyKeep::kAll;
  for (const CameraIntrinsics& lens : testing::Lenses()) {
    const Camera camera(lens), view(RectifiedView(camera, options));
    for (double x = 0; x < camera.Width(); x += 43)
      for (double y = 0; y < camera.Height(); y += 43) {
        const auto ray = camera.Unproject({x, y});
        if (!ray || std::acos(ray->z()) > options.widest_rad) continue;
        const auto pixel = view.Project(*ray);
        ASSERT_TRUE(pixel) << lens.model;
        EXPECT_GE(pixel->x(), -0.01) << lens.model;
        EXPECT_GE(pixel->y(), -0.01) << lens.model;
        EXPECT_LE(pixel->x(), view.Width() - 0.99) << lens.model;
        EXPECT_LE(pixel->y(), view.Height() - 0.99) << lens.model;
      }
  }
}

TEST(Undistort, ShowsTheSceneAsThePinholeWould) {
  CameraIntrinsics lens = StudyLenses()[2].camera;
  lens.width /= 4;  // for speed
  lens.height /= 4;
  for (std::size_t i = 0; i < 4; ++i) lens.parameters[i] /= 4;
  const Camera camera(lens);
  const Camera view(RectifiedView(camera));
  const GreyImage image = Rectifier(camera, view).Image(ImageOf(camera));
  const GreyImage truth = ImageOf(view);
  double sum = 0;
  for (std::size_t i = 0; i < truth.shades.size(); ++i) {
    const int off = std::abs(truth.shades[i] - image.shades[i]);
    // Interpolation, which OpenCV does in steps of 1/32 of a pixel, and rounding.
    EXPECT_LE(off, 3);
    sum += off;
  }
  EXPECT_LT(sum / static_cast<double>(truth.shades.size()), 0.5);
}

TEST(Undistort, LeavesAnImageOfThePinholeItselfAsItIs) {
  const Camera pinhole({"", "pinhole", 64, 48, {50, 50, 31, 24}});
  const GreyImage image = ImageOf(pinhole);
  const Rectifier rectifier(pinhole, pinhole);
  EXPECT_EQ(rectifier.Image(image).shades, image.shades);
  // Three channels alike.
  std::vector<std::uint8_t> colours, out(3 * image.shades.size());
  for (const std::uint8_t shade : image.shades) colours.insert(colours.end(), 3, shade);
  rectifier.Image(colours.data(), 3 * image.width, 3, out.data());
  EXPECT_EQ(out, colours);
  EXPECT_THROW(rectifier.Image(GreyImage{2, 2, {0, 0, 0, 0}}), Error);
}

TEST(Undistort, TakesWiderViewsToo) {
  // Of a fisheye as an equidistant lens without terms.
  const Camera camera(testing::Lenses()[9]);
  const Camera view({"", "angular1", 160, 120, {40, 40, 79.5, 59.5, 0}});
  const Rectifier rectifier(camera, view);
  EXPECT_GT(rectifier.Filled(), 0.7);
  const auto ray = view.Unproject({130, 60});
  ASSERT_TRUE(ray);
  const auto pixel = camera.Project(*ray);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(rectifier.X()[60 * 160 + 130], pixel->x(), 1e-3);
  EXPECT_NEAR(rectifier.Y()[60 * 160 + 130], pixel->y(), 1e-3);
}

}  // namespace
}  // namespace graticule
