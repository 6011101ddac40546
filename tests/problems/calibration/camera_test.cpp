#include "graticule/problems/calibration/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "graticule/solver/error.hpp"
#include "lenses.hpp"

namespace graticule {
namespace {

class EveryLens : public ::testing::TestWithParam<CameraIntrinsics> {};

TEST_P(EveryLens, FindsTheRayOfEveryPixelThatItHasARayFor) {
  const Camera camera(GetParam());
  int found = 0;
  for (int v = 0; v < camera.Height(); v += 7)
    for (int u = 0; u < camera.Width(); u += 7) {
      const Eigen::Vector2d pixel(u + .3, v + .4);
      const auto ray = camera.Unproject(pixel);
      if (!ray) continue;
      ++found;
      EXPECT_NEAR(ray->norm(), 1, 1e-12);
      const auto again = camera.Project(*ray * 2.5);
      ASSERT_TRUE(again);
      EXPECT_NEAR((*again - pixel).norm(), 0, 1e-8);
    }
  EXPECT_GT(found, 0.9 * 69 * 92);
}

TEST_P(EveryLens, FindsTheRayThatWasProjected) {
  const Camera camera(GetParam());
  std::mt19937_64 random(7);
  for (int i = 0; i < 500; ++i) {
    const double angle = std::uniform_real_distribution<double>(0, camera.MaxAngle() - .02)(random);
    const double turn = std::uniform_real_distribution<double>(-M_PI, M_PI)(random);
    const Eigen::Vector3d ray(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                              std::cos(angle));
    const auto pixel = camera.Project(ray);
    ASSERT_TRUE(pixel);
    const auto again = camera.Unproject(*pixel);
    ASSERT_TRUE(again) << angle;
    EXPECT_NEAR((*again - ray).norm(), 0, 1e-7);
  }
}

TEST_P(EveryLens, HasNoImageOfWhatIsStraightBehind) {
  const Camera camera(GetParam());
  EXPECT_FALSE(camera.Project({0, 0, -1}));
  EXPECT_LT(camera.MaxAngle(), M_PI);
}

std::string LensName(const ::testing::TestParamInfo<CameraIntrinsics>& info) {
  return info.param.model;
}
INSTANTIATE_TEST_SUITE_P(All, EveryLens, ::testing::ValuesIn(testing::Lenses()), LensName);

TEST(Camera, ListsHaveEveryModel) {
  std::set<std::string> models;
  for (const CameraIntrinsics& lens : testing::Lenses()) models.insert(lens.model);
  EXPECT_EQ(models.size(), CameraModels().size());
}

TEST(Camera, WideLensesSeeBehindTheirPlane) {
  const Camera camera({"", "angular1", 640, 480, {120, 120, 320, 240, 0}});
  const auto pixel = camera.Project({1, 0, -.1});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 320 + 120 * (M_PI / 2 + std::atan(.1)), 1e-9);
}

TEST(Camera, StopsWhereThePolynomialTurnsBack) {
  // r = theta - 0.3 theta^3 grows up to 1/sqrt(0.9) = 1.054
  const Camera camera({"", "angular1", 640, 480, {120, 120, 320, 240, -.3}});
  EXPECT_NEAR(camera.MaxAngle(), 1 / std::sqrt(.9), .011);
  EXPECT_LT(camera.MaxAngle(), 1 / std::sqrt(.9));
  EXPECT_FALSE(camera.Project({std::sin(1.2), 0, std::cos(1.2)}));
  EXPECT_FALSE(camera.Unproject({320 + 120 * .75, 240}));
}

TEST(Camera, RefusesWhatIsNoCamera) {
  EXPECT_THROW(Camera({"", "angular", 640, 480, {1, 1, 0, 0}}), Error);
  EXPECT_THROW(Camera({"", "pinhole", 640, 480, {1, 1, 0}}), Error);
  EXPECT_THROW(Camera({"", "pinhole", 640, 480, {1, NAN, 0, 0}}), Error);
  EXPECT_THROW(Camera({"", "pinhole", 640, 480, {-1, 1, 0, 0}}), Error);
  EXPECT_THROW(Camera({"", "pinhole", 0, 480, {1, 1, 0, 0}}), Error);
}

}  // namespace
}  // namespace graticule
