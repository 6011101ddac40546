#include "graticule/problems/segmentation/graph_segmentation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

#include "clouds.hpp"

namespace graticule {
namespace {

std::pair<std::size_t, std::size_t> EndsOf(const ScanMesh& mesh, const WeighedEdge& edge) {
  const std::size_t inner = ScanMesh::kDirections * mesh.Size();
  if (edge.code >= inner) return mesh.Seam()[edge.code - inner];
  const std::size_t i = edge.code / 4;
  return {i, i + static_cast<std::size_t>(mesh.Step(static_cast<int>(edge.code % 4)))};
}

double ColourDistance(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(sum);
}

// Algorithm 4.1 with a list of members for each segment: O(n^2).
std::vector<std::uint32_t> SlowSegments(const ScanMesh& mesh, const std::vector<WeighedEdge>& edges,
                                        const GraphSegmentationOptions& options) {
  struct Segment {
    std::vector<std::size_t> members;
    double colour, angle;
  };
  const double colour_k = options.k_colour * EdgeWeights::kColourSteps;
  const double angle_k = options.k_normal * EdgeWeights::kAngleSteps / M_PI;
  std::vector<Segment> segments(mesh.Size());
  std::vector<std::size_t> segment_of(mesh.Size());
  std::iota(segment_of.begin(), segment_of.end(), 0);
  for (std::size_t i = 0; i < mesh.Size(); ++i) segments[i] = {{i}, colour_k, angle_k};
  const auto join = [&](std::size_t a, std::size_t b) {
    for (const std::size_t i : segments[b].members) segment_of[i] = a;
    segments[a].members.insert(segments[a].members.end(), segments[b].members.begin(),
                               segments[b].members.end());
    segments[b].members.clear();
  };
  for (const WeighedEdge& edge : edges) {
    const auto [i, j] = EndsOf(mesh, edge);
    const std::size_t a = segment_of[i], b = segment_of[j];
    if (a == b || edge.colour >= segments[a].colour || edge.colour >= segments[b].colour ||
        edge.angle >= segments[a].angle || edge.angle >= segments[b].angle)
      continue;
    join(a, b);
    const double size = static_cast<double>(segments[a].members.size());
    segments[a].colour = edge.colour + colour_k / size;
    segments[a].angle = edge.angle + angle_k / size;
  }
  for (const WeighedEdge& edge : edges) {
    const auto [i, j] = EndsOf(mesh, edge);
    const std::size_t a = segment_of[i], b = segment_of[j];
    if (a != b &&
        std::min(segments[a].members.size(), segments[b].members.size()) < options.min_size)
      join(a, b);
  }
  std::vector<std::uint32_t> labels(mesh.Size());
  for (std::size_t i = 0; i < mesh.Size(); ++i)
    labels[i] = segments[segment_of[i]].members.size() == 1
                    ? 0
                    : static_cast<std::uint32_t>(segment_of[i] + 1);
  return labels;
}

class SegmentsOfRandomClouds : public testing::TestWithParam<int> {};

TEST_P(SegmentsOfRandomClouds, AreThoseOfTheSlowAlgorithm) {
  const int seed = GetParam();
  const PointCloud cloud = test::RandomCloud(41, 29, static_cast<std::uint64_t>(seed));
  ScanMesh mesh;
  mesh.Build(cloud, {0.06, 0.1, seed % 2 == 0});
  SurfaceNormals normals;
  normals.Compute(mesh, 1 + seed % 3);
  EdgeWeights weights;
  weights.Compute(mesh, seed % 5 == 0 ? nullptr : cloud.colours.data(),
                  seed % 5 == 1 ? nullptr : &normals,
                  seed % 2 == 0 ? EdgeOrder::kColour : EdgeOrder::kAngle);
  GraphSegmentationOptions options;
  options.k_colour = 200.0 * (1 + seed % 7);
  options.k_normal = 2.0 * (1 + seed % 3);
  options.min_size = static_cast<std::size_t>(seed % 4 * 10);
  GraphSegmentation segmentation;
  segmentation.Segment(mesh, weights.Sorted(), options);
  const auto slow = SlowSegments(mesh, weights.Sorted(), options);
  EXPECT_TRUE(test::IsSamePartition(segmentation.Labels(), slow));
  EXPECT_EQ(segmentation.Count(),
            *std::max_element(segmentation.Labels().begin(), segmentation.Labels().end()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, SegmentsOfRandomClouds, testing::Range(1, 21));

TEST(EdgeWeights, AreThoseOfTheEquationsInOrder) {
  const PointCloud cloud = test::RandomCloud(50, 31, 5);
  ScanMesh mesh;
  mesh.Build(cloud, {0.05, 0.1, true});
  SurfaceNormals normals;
  normals.Compute(mesh, 2);
  for (const EdgeOrder order : {EdgeOrder::kColour, EdgeOrder::kAngle}) {
    EdgeWeights weights;
    weights.Compute(mesh, cloud.colours.data(), &normals, order);
    ASSERT_EQ(weights.Sorted().size(), mesh.EdgeCount());
    const WeighedEdge* before = nullptr;
    for (const WeighedEdge& edge : weights.Sorted()) {
      const auto key = [order](const WeighedEdge& e) {
        return order == EdgeOrder::kColour ? e.colour : e.angle;
      };
      if (before) {
        EXPECT_LE(key(*before), key(edge));
        EXPECT_TRUE(key(*before) < key(edge) || before->code < edge.code);  // stable
      }
      before = &edge;
      const auto [i, j] = EndsOf(mesh, edge);
      EXPECT_EQ(edge.colour, std::floor(16 * ColourDistance(cloud.colours[i], cloud.colours[j])));
      const Eigen::Vector3d a(normals.X()[i], normals.Y()[i], normals.Z()[i]);
      const Eigen::Vector3d b(normals.X()[j], normals.Y()[j], normals.Z()[j]);
      if (a.isZero() || b.isZero()) {
        EXPECT_EQ(edge.angle, 0);
        continue;
      }
      const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
      EXPECT_NEAR(edge.angle * M_PI / EdgeWeights::kAngleSteps, angle, 1e-3);
    }
  }
}

// Exactly: their product is that of a point without a normal.
TEST(EdgeWeights, ArePiHalfBetweenFloorAndWall) {
  PointCloud cloud;
  cloud.width = cloud.height = 20;
  // They meet in one diagonal edge, so that no normal is of both.
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column) {
      const float across = 0.02f * static_cast<float>(column);
      const float along = 0.02f * static_cast<float>(row - 10);
      if ((row < 10) != (column < 10))
        cloud.in_sensor.push_back(kNoReturn);
      else
        cloud.in_sensor.push_back(row < 10 ? Eigen::Vector3f(2, across, -1 - along)
                                           : Eigen::Vector3f(2 - along, across, -1));
    }
  ScanMesh mesh;
  mesh.Build(cloud, {0.1, 0, false});
  SurfaceNormals normals;
  normals.Compute(mesh, 1);
  EdgeWeights weights;
  weights.Compute(mesh, nullptr, &normals, EdgeOrder::kAngle);
  std::size_t right_angles = 0;
  for (const WeighedEdge& edge : weights.Sorted()) {
    const auto [i, j] = EndsOf(mesh, edge);
    const Eigen::Vector3f a(normals.X()[i], normals.Y()[i], normals.Z()[i]);
    const Eigen::Vector3f b(normals.X()[j], normals.Y()[j], normals.Z()[j]);
    if (a.isZero() || b.isZero() || a.dot(b) != 0) continue;
    ++right_angles;
    EXPECT_EQ(edge.angle, EdgeWeights::kAngleSteps / 2);
  }
  EXPECT_EQ(right_angles, 1u);
}

TEST(GraphSegmentation, PartsAFieldOfTwoColours) {
  PointCloud cloud;
  cloud.width = 40;
  cloud.height = 20;
  for (std::size_t i = 0; i < 800; ++i) {
    const double u = static_cast<double>(i % 40), v = static_cast<double>(i / 40);
    cloud.in_sensor.push_back(Eigen::Vector3d(0.01 * u, 0.01 * v, 1).cast<float>());
    cloud.colours.push_back(i % 40 < 15 ? Rgb{200, 30, 30} : Rgb{30, 30, 200});
  }
  ScanMesh mesh;
  mesh.Build(cloud, {});
  EdgeWeights weights;
  weights.Compute(mesh, cloud.colours.data(), nullptr, EdgeOrder::kColour);
  GraphSegmentation segmentation;
  segmentation.Segment(mesh, weights.Sorted(), {1000, 10, 20});
  EXPECT_EQ(segmentation.Count(), 2u);
  for (std::size_t i = 0; i < 800; ++i) EXPECT_EQ(segmentation.Labels()[i], i % 40 < 15 ? 1u : 2u);
}

}  // namespace
}  // namespace graticule
