#include "graticule/problems/segmentation/surface_normals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <Eigen/SVD>

#include "clouds.hpp"

namespace graticule {
namespace {

bool HasLink(const ScanMesh& mesh, std::size_t i, int direction) {
  return (mesh.Links()[i] >> direction & 1) != 0;
}

// Points of the window by its definition: along the column first, then along the row.
std::vector<Eigen::Vector3d> Window(const ScanMesh& mesh, const PointCloud& cloud, std::size_t row,
                                    std::size_t column, int radius) {
  std::vector<Eigen::Vector3d> points;
  const std::size_t width = mesh.Width();
  const auto take_row = [&](std::size_t r) {
    const auto take = [&](std::size_t c) {
      points.push_back(cloud.in_sensor[r * width + c].cast<double>());
    };
    take(column);
    for (std::size_t c = column, k = 0; k < static_cast<std::size_t>(radius) && c + 1 < width &&
                                        HasLink(mesh, r * width + c, ScanMesh::kRight);
         ++k)
      take(++c);
    for (std::size_t c = column, k = 0; k < static_cast<std::size_t>(radius) && c > 0 &&
                                        HasLink(mesh, r * width + c - 1, ScanMesh::kRight);
         ++k)
      take(--c);
  };
  take_row(row);
  for (std::size_t r = row, k = 0; k < static_cast<std::size_t>(radius) && r + 1 < mesh.Height() &&
                                   HasLink(mesh, r * width + column, ScanMesh::kDown);
       ++k)
    take_row(++r);
  for (std::size_t r = row, k = 0; k < static_cast<std::size_t>(radius) && r > 0 &&
                                   HasLink(mesh, (r - 1) * width + column, ScanMesh::kDown);
       ++k)
    take_row(--r);
  return points;
}

class NormalsOfRandomClouds : public testing::TestWithParam<int> {};

TEST_P(NormalsOfRandomClouds, AreThoseOfTheWindowsSvd) {
  const int seed = GetParam(), radius = 1 + seed % 4;
  const PointCloud cloud = test::RandomCloud(37, 23, static_cast<std::uint64_t>(seed));
  ScanMesh mesh;
  mesh.Build(cloud, {0.05, 0.1, false});
  SurfaceNormals normals;
  normals.Compute(mesh, radius);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < mesh.Size(); ++i) {
    const Eigen::Vector3d normal(normals.X()[i], normals.Y()[i], normals.Z()[i]);
    if (!cloud.in_sensor[i].allFinite()) {
      EXPECT_EQ(normal, Eigen::Vector3d::Zero());
      continue;
    }
    const auto points = Window(mesh, cloud, i / mesh.Width(), i % mesh.Width(), radius);
    if (points.size() < 3) {
      EXPECT_EQ(normal, Eigen::Vector3d::Zero());
      continue;
    }
    Eigen::MatrixXd matrix(points.size(), 3);
    for (std::size_t k = 0; k < points.size(); ++k)
      matrix.row(static_cast<Eigen::Index>(k)) = points[k].transpose();
    matrix.rowwise() -= matrix.colwise().mean().eval();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinV);
    const Eigen::Vector3d values = svd.singularValues();
    // Where a line or a ball of points has no direction of least spread, there is nothing to hold.
    if (values[1] < 0.05 * values[0] || values[2] > 0.8 * values[1]) continue;
    ++compared;
    ASSERT_NEAR(normal.norm(), 1, 1e-5);
    EXPECT_LE(normal.dot(cloud.in_sensor[i].cast<double>()), 1e-6);
    const double tolerance = values[2] > 0.5 * values[1] ? 0.02 : 0.003;
    EXPECT_LT(normal.cross(Eigen::Vector3d(svd.matrixV().col(2))).norm(), tolerance) << i;
    EXPECT_NEAR(normals.Roughness()[i], values[2] / std::sqrt(static_cast<double>(points.size())),
                0.02 * values[1]);
  }
  EXPECT_GT(compared, 400u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, NormalsOfRandomClouds, testing::Range(1, 9));

TEST(SurfaceNormals, OfAPlaneAreItsNormalFarFromTheSensorToo) {
  PointCloud cloud;
  cloud.width = 60;
  cloud.height = 40;
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.8, 0.3, 0.52).normalized();
  for (std::size_t r = 0; r < cloud.height; ++r)
    for (std::size_t c = 0; c < cloud.width; ++c) {
      const Eigen::Vector3d ray(1, 0.005 * static_cast<double>(c) - 0.15,
                                0.005 * static_cast<double>(r) - 0.1);
      cloud.in_sensor.push_back((ray * (normal.x() * 40 / normal.dot(ray))).cast<float>());
    }
  ScanMesh mesh;
  mesh.Build(cloud, {1, 0, false});
  SurfaceNormals normals;
  normals.Compute(mesh, 2);
  for (std::size_t i = 0; i < mesh.Size(); ++i)
    EXPECT_GT(normal.dot(Eigen::Vector3d(normals.X()[i], normals.Y()[i], normals.Z()[i])), 0.9999);
}

}  // namespace
}  // namespace graticule
