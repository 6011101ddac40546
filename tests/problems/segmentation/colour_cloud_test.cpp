#include "graticule/problems/segmentation/colour_cloud.hpp"

#include <gtest/gtest.h>

#include "graticule/problems/segmentation/segment_statistics.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// A wall 4 m ahead, red on the left and blue on the right, and a post before it at 2 m that hides
// a strip of it from the camera, which is 1 m to the side of the LIDAR.
struct Post {
  PointCloud cloud;
  ColourImage image;
  Camera camera{{"cam0", "pinhole", 200, 100, {100, 100, 99.5, 49.5}}};
  std::array<double, 7> camera_from_lidar = {1, 0, 0, 0, 0, 0, 1};  // both look along z

  Post() {
    image.width = 200;
    image.height = 100;
    image.rgb.assign(3 * 200 * 100, 40);
    cloud.width = 121;
    cloud.height = 41;
    for (int r = -20; r <= 20; ++r)
      for (int c = -60; c <= 60; ++c) {
        const double u = 0.02 * c, v = 0.02 * r;
        const double z = std::fabs(u * 2) < 0.25 ? 2 : 4;
        cloud.in_sensor.push_back(Eigen::Vector3d(u * z, v * z, z).cast<float>());
      }
  }
};

TEST(ColoursOf, LeaveOutWhatIsHiddenAndWhatIsOutside) {
  Post post;
  const CloudColours colours =
      ColoursOf(post.cloud, post.image, post.camera, post.camera_from_lidar);
  EXPECT_EQ(colours.seen + colours.hidden + colours.outside, post.cloud.Size());
  // The post covers x in (-0.25, 0.25) at 2 m; from the camera at x = -1 that is, on the wall,
  // x in (0.5, 1.5).
  for (std::size_t i = 0; i < post.cloud.Size(); ++i) {
    const Eigen::Vector3f& p = post.cloud.in_sensor[i];
    const Eigen::Vector2d pixel(100 * (p.x() + 1) / p.z() + 99.5, 100 * p.y() / p.z() + 49.5);
    const bool is_inside = pixel.x() < 199.5 && pixel.y() > -0.5 && pixel.y() < 99.5;
    const bool is_seen = colours.is_seen[i] != 0;
    const bool is_shown = is_inside && (p.z() < 3 || p.x() < 0.3 || p.x() > 1.7);
    const bool is_not = !is_inside || (p.z() > 3 && p.x() > 0.6 && p.x() < 1.4);
    EXPECT_TRUE((is_seen || !is_shown) && (!is_seen || !is_not)) << p.transpose();
  }
  const PointCloud dropped = Coloured(post.cloud, colours, false);
  const PointCloud kept = Coloured(post.cloud, colours, true);
  std::size_t left = 0;
  for (const Eigen::Vector3f& p : dropped.in_sensor) left += p.allFinite();
  EXPECT_EQ(left, colours.seen);
  EXPECT_EQ(kept.in_sensor, post.cloud.in_sensor);
}

TEST(ColoursOf, AreThoseOfTheThingsThatAreSeen) {
  const SimulatedScene scene = SimulateScene("hallway");
  const CloudColours colours =
      ColoursOf(scene.cloud, scene.image, Camera(scene.camera), scene.camera_from_lidar);
  EXPECT_GT(colours.seen, 50000u);
  EXPECT_GT(colours.hidden, 100u);
  // The blue bin is blue, where it is seen, but for its rim.
  std::size_t bin = 0, blue = 0;
  for (std::size_t i = 0; i < scene.cloud.Size(); ++i) {
    if (scene.cloud.labels[i] != 30 || !colours.is_seen[i]) continue;
    ++bin;
    blue += colours.colours[i][2] > 110 && colours.colours[i][0] < 90;
  }
  EXPECT_GT(bin, 1000u);
  EXPECT_GT(static_cast<double>(blue), 0.97 * static_cast<double>(bin));
}

TEST(ColoursOf, RefuseAPictureOfAnotherSize) {
  Post post;
  post.image.width = 100;
  EXPECT_THROW(ColoursOf(post.cloud, post.image, post.camera, post.camera_from_lidar), Error);
}

TEST(SegmentStatistics, MeanColoursAreOfPointsThatHaveOne) {
  PointCloud cloud;
  cloud.width = 4;
  for (int i = 0; i < 4; ++i) cloud.in_sensor.emplace_back(1, 0.1f * static_cast<float>(i), 0);
  cloud.colours = {{200, 100, 50}, {0, 0, 0}, {100, 0, 50}, {0, 0, 0}};
  const std::vector<std::uint32_t> labels = {1, 1, 1, 2};
  const auto some = StatisticsOf(cloud, labels, 2, {1, 0, 1, 0});
  EXPECT_EQ(some[0].mean_colour, Eigen::Vector3d(150, 50, 50));
  EXPECT_EQ(some[0].points, 3u);
  EXPECT_FALSE(some[1].has_colour);
  EXPECT_EQ(StatisticsOf(cloud, labels, 2)[0].mean_colour, Eigen::Vector3d(100, 100. / 3, 100. / 3));
  EXPECT_THROW(StatisticsOf(cloud, labels, 2, {1, 0}), Error);
}

}  // namespace
}  // namespace graticule
