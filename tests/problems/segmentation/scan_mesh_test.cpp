#include "graticule/problems/segmentation/scan_mesh.hpp"

#include <gtest/gtest.h>

#include <set>

#include "clouds.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Edges = std::set<std::pair<std::size_t, std::size_t>>;

Edges EdgesOf(const ScanMesh& mesh) {
  Edges edges;
  for (std::size_t i = 0; i < mesh.Size(); ++i)
    for (int d = 0; d < ScanMesh::kDirections; ++d)
      if ((mesh.Links()[i] >> d & 1) != 0)
        edges.emplace(i, i + static_cast<std::size_t>(mesh.Step(d)));
  for (const auto& [i, j] : mesh.Seam()) edges.emplace(std::min(i, j), std::max(i, j));
  return edges;
}

// Every pair of points whose rows and columns differ by one at most, by the definition.
Edges SlowEdges(const PointCloud& cloud, const MeshOptions& options) {
  Edges edges;
  const int width = static_cast<int>(cloud.width), height = static_cast<int>(cloud.height);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc) {
          int column = c + dc;
          if (options.is_closed) column = (column + width) % width;
          if ((dr == 0 && dc == 0) || r + dr < 0 || r + dr >= height || column < 0 ||
              column >= width)
            continue;
          const std::size_t i = static_cast<std::size_t>(r * width + c);
          const std::size_t j = static_cast<std::size_t>((r + dr) * width + column);
          const Eigen::Vector3d p = cloud.in_sensor[i].cast<double>();
          const Eigen::Vector3d q = cloud.in_sensor[j].cast<double>();
          if (!p.allFinite() || !q.allFinite()) continue;
          if ((p - q).norm() > options.edge_cut_m) continue;
          const double cosine = std::fabs((p - q).normalized().dot((p + q).normalized()));
          if (options.grazing_rad > 0 && cosine > std::cos(options.grazing_rad)) continue;
          edges.emplace(std::min(i, j), std::max(i, j));
        }
  return edges;
}

class MeshOfRandomClouds : public testing::TestWithParam<int> {};

TEST_P(MeshOfRandomClouds, HasTheEdgesOfTheDefinition) {
  const int seed = GetParam();
  const PointCloud cloud = test::RandomCloud(3 + static_cast<std::size_t>(seed * 7 % 40),
                                             2 + static_cast<std::size_t>(seed * 5 % 20),
                                             static_cast<std::uint64_t>(seed));
  MeshOptions options;
  options.edge_cut_m = 0.02 + 0.03 * (seed % 4);
  options.grazing_rad = seed % 3 * 0.1;
  options.is_closed = seed % 2 == 1;
  ScanMesh mesh;
  mesh.Build(cloud, options);
  const Edges edges = EdgesOf(mesh);
  EXPECT_EQ(edges, SlowEdges(cloud, options));
  EXPECT_EQ(mesh.EdgeCount(), edges.size());
}

INSTANTIATE_TEST_SUITE_P(Seeds, MeshOfRandomClouds, testing::Range(1, 13));

TEST(ScanMesh, RefusesWhatHasNoRows) {
  ScanMesh mesh;
  PointCloud cloud;
  EXPECT_THROW(mesh.Build(cloud, {}), Error);
  cloud.width = 3;
  cloud.in_sensor.assign(3, Eigen::Vector3f(1, 0, 0));
  EXPECT_THROW(mesh.Build(cloud, {}), Error);
  cloud.height = 2;  // and three points
  EXPECT_THROW(mesh.Build(cloud, {}), Error);
}

TEST(ScanMesh, OfNoReturnAtAllHasNoEdge) {
  PointCloud cloud;
  cloud.width = cloud.height = 4;
  cloud.in_sensor.assign(16, kNoReturn);
  ScanMesh mesh;
  mesh.Build(cloud, {});
  EXPECT_EQ(mesh.EdgeCount(), 0u);
}

TEST(ScanMesh, OfAPictureLinksAllNeighbours) {
  ScanMesh mesh;
  mesh.Begin(4, {});
  for (int row = 0; row < 3; ++row) mesh.AddGridRow();
  EXPECT_EQ(mesh.EdgeCount(), 3u * 3 + 2 * 4 + 2 * 2 * 3);
}

}  // namespace
}  // namespace graticule
