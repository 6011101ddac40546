#include "graticule/problems/segmentation/segmenter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "clouds.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr SegmentMethod kMethods[] = {SegmentMethod::kConvex, SegmentMethod::kJoint,
                                      SegmentMethod::kColour, SegmentMethod::kNormals,
                                      SegmentMethod::kImage};

TEST(Segmenter, SaysTheSameTwiceWhateverCameBefore) {
  const PointCloud cloud = test::RandomCloud(80, 60, 2), other = test::RandomCloud(30, 90, 3);
  for (const SegmentMethod method : kMethods) {
    Segmenter fresh(DefaultsOf(method)), used(DefaultsOf(method));
    used.Segment(other);
    EXPECT_EQ(fresh.Segment(cloud), used.Segment(cloud));
  }
}

// Each scan in a list of its own, which is gone before the next.
const std::vector<std::uint32_t>& ScanByScan(const PointCloud& cloud, Segmenter* segmenter) {
  segmenter->Begin(cloud.width);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    const auto first = static_cast<std::ptrdiff_t>(row * cloud.width);
    const auto last = first + static_cast<std::ptrdiff_t>(cloud.width);
    const std::vector<Eigen::Vector3f> points(cloud.in_sensor.begin() + first,
                                              cloud.in_sensor.begin() + last);
    const std::vector<Rgb> colours(cloud.colours.begin() + first, cloud.colours.begin() + last);
    segmenter->AddScan(points, colours);
  }
  return segmenter->Finish();
}

// The steps of the batch, each over the whole cloud.
std::vector<std::uint32_t> StepByStep(const PointCloud& cloud, const SegmentOptions& options) {
  ScanMesh mesh;
  mesh.Build(cloud, options.mesh);
  SurfaceNormals normals;
  normals.Compute(mesh, options.normal_radius);
  EdgeWeights weights;
  weights.Compute(mesh, cloud.colours.data(), &normals, EdgeOrder::kColour);
  GraphSegmentation graph;
  graph.Segment(mesh, weights.Sorted(), options.graph);
  return graph.Labels();
}

TEST(Segmenter, ScanByScanSaysWhatTheWholeCloudDoes) {
  SceneOptions small;
  small.scans = 60;
  small.bearings = 180;
  small.bearing_step_rad = M_PI / 180;
  const SimulatedScene scene = SimulateScene("hallway", small);
  const CloudColours colours =
      ColoursOf(scene.cloud, scene.image, Camera(scene.camera), scene.camera_from_lidar);
  for (const PointCloud& cloud :
       {test::RandomCloud(40, 30, 7), Coloured(scene.cloud, colours, true)})
    for (const SegmentMethod method : kMethods)
      for (const bool is_closed : {false, true}) {
        SegmentOptions options = DefaultsOf(method);
        options.mesh.is_closed = is_closed;
        Segmenter whole(options), scans(options);
        ASSERT_EQ(whole.Segment(cloud), ScanByScan(cloud, &scans)) << static_cast<int>(method);
        EXPECT_EQ(whole.SegmentCount(), scans.SegmentCount());
        if (method != SegmentMethod::kJoint) continue;
        EXPECT_EQ(whole.Segment(cloud), StepByStep(cloud, options));
      }
}

// Of a scan that was added, the mesh is there at once, the normals `normal_radius` scans later.
TEST(Segmenter, KnowsLinksAndNormalsWhileTheScansComeIn) {
  const PointCloud cloud = test::RandomCloud(30, 20, 3);
  SegmentOptions options = DefaultsOf(SegmentMethod::kJoint);
  ASSERT_EQ(options.normal_radius, 1);
  Segmenter whole(options), scans(options);
  whole.Segment(cloud);
  scans.Begin(cloud.width);
  for (std::size_t row = 0; row < cloud.height; ++row) {
    scans.AddScan({&cloud.in_sensor[row * cloud.width], cloud.width},
                  {&cloud.colours[row * cloud.width], cloud.width});
    EXPECT_EQ(scans.Mesh().Height(), row + 1);
    ASSERT_EQ(scans.Normals().Rows(), row);
    for (std::size_t i = 0; i < row * cloud.width; ++i) {
      ASSERT_EQ(scans.Mesh().Links()[i], whole.Mesh().Links()[i]) << row << " " << i;
      ASSERT_EQ(scans.Normals().X()[i], whole.Normals().X()[i]) << row << " " << i;
    }
  }
}

TEST(Segmenter, RefusesScansOfAnotherWidthAndTooFew) {
  const PointCloud cloud = test::RandomCloud(30, 20, 3);
  const Span<const Eigen::Vector3f> points(cloud.in_sensor.data(), 30);
  const Span<const Rgb> colours(cloud.colours.data(), 30);
  Segmenter segmenter(DefaultsOf(SegmentMethod::kJoint));
  EXPECT_THROW(segmenter.AddScan(points, colours), Error);  // not begun
  EXPECT_THROW(segmenter.Begin(0), Error);
  segmenter.Begin(30);
  EXPECT_THROW(segmenter.AddScan(points), Error);  // no colours
  EXPECT_THROW(segmenter.AddScan({cloud.in_sensor.data(), 29}, colours), Error);
  segmenter.AddScan(points, colours);
  EXPECT_THROW(segmenter.Finish(), Error);  // one scan
  segmenter.AddScan(points, colours);
  EXPECT_EQ(segmenter.Finish().size(), 60u);
  EXPECT_THROW(segmenter.AddScan(points, colours), Error);  // finished
  EXPECT_THROW(segmenter.Finish(), Error);
}

TEST(Segmenter, RefusesACloudWithoutColoursWhereItNeedsThem) {
  PointCloud cloud = test::RandomCloud(20, 20, 4);
  cloud.colours.clear();
  EXPECT_THROW(Segmenter(DefaultsOf(SegmentMethod::kJoint)).Segment(cloud), Error);
  EXPECT_NO_THROW(Segmenter(DefaultsOf(SegmentMethod::kConvex)).Segment(cloud));
  EXPECT_THROW(SegmentMethodOf("watershed"), Error);
}

TEST(Segmenter, GivesPointsWithoutReturnNoSegment) {
  const PointCloud cloud = test::RandomCloud(50, 40, 5);
  for (const SegmentMethod method : {SegmentMethod::kConvex, SegmentMethod::kJoint}) {
    Segmenter segmenter(DefaultsOf(method));
    const auto& labels = segmenter.Segment(cloud);
    for (std::size_t i = 0; i < cloud.Size(); ++i)
      EXPECT_TRUE(cloud.in_sensor[i].allFinite() || labels[i] == 0) << i;
  }
}

class Scenes : public testing::TestWithParam<const char*> {};

TEST_P(Scenes, AreFoundByConvexity) {
  const SimulatedScene scene = SimulateScene(GetParam());
  Segmenter segmenter(DefaultsOf(SegmentMethod::kConvex));
  ScoreOptions options;
  options.least_object = 20;
  const SegmentScore score = ScoreOf(scene.cloud.labels, segmenter.Segment(scene.cloud), options);
  EXPECT_GT(score.found, 0.99) << score.mean_f;
  EXPECT_GT(score.mean_f, 0.85);
}

INSTANTIATE_TEST_SUITE_P(Both, Scenes, testing::Values("hallway", "hill"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace graticule
