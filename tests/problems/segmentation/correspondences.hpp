#pragma once

// Recorded and simulated correspondences.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/problems/segmentation/coregister.hpp"

namespace graticule::test {

inline std::string SegmentData(const std::string& name) {
  return std::string(GRATICULE_DATA_DIR) + "/segment/" + name;
}

#define GRATICULE_NEEDS_SEGMENT_DATA()                                               \
  if (!std::filesystem::is_directory(::graticule::test::SegmentData(""))) {          \
    const char* ci = std::getenv("CI");                                              \
    if (ci && std::string(ci) == "true") FAIL() << "no data in " GRATICULE_DATA_DIR; \
    GTEST_SKIP() << "no data in " GRATICULE_DATA_DIR;                                \
  }                                                                                  \
  static_assert(true, "")

/// The doubles of a NumPy file, version 1, in C order.
inline std::vector<double> ReadNpy(const std::string& path) {
  const std::string bytes = ReadFile(path);
  EXPECT_EQ(bytes.substr(1, 5), "NUMPY");
  EXPECT_NE(bytes.find("'<f8', 'fortran_order': False"), std::string::npos);
  const std::size_t header = 10 + static_cast<unsigned char>(bytes[8]) +
                             256 * static_cast<std::size_t>(static_cast<unsigned char>(bytes[9]));
  std::vector<double> values((bytes.size() - header) / 8);
  std::memcpy(values.data(), bytes.data() + header, 8 * values.size());
  return values;
}

inline std::vector<Correspondence> HeetheshPoints() {
  const std::vector<double> points = ReadNpy(SegmentData("heethesh_corr/pcl_corners.npy"));
  const std::vector<double> pixels = ReadNpy(SegmentData("heethesh_corr/img_corners.npy"));
  std::vector<Correspondence> result;
  for (std::size_t i = 0; i < pixels.size() / 2; ++i)
    result.push_back({{points[3 * i], points[3 * i + 1], points[3 * i + 2]},
                      {pixels[2 * i], pixels[2 * i + 1]},
                      std::to_string(i + 1)});
  return result;
}

/// A KITTI frame: its camera, the true extrinsics (P2 R0 Tr), and points that the camera sees.
struct KittiFrame {
  CameraIntrinsics camera;
  Eigen::Isometry3d camera_from_lidar;
  std::vector<Eigen::Vector3d> visible;
};

inline KittiFrame ReadKitti(const std::string& number) {
  std::ifstream in(SegmentData("kitti3/calib/" + number + ".txt"));
  std::string word;
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> p2, tr;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> r0;
  while (in >> word) {
    double* to = nullptr;
    int count = word == "R0_rect:" ? 9 : 12;
    if (word == "P2:") to = p2.data();
    if (word == "R0_rect:") to = r0.data();
    if (word == "Tr_velo_to_cam:") to = tr.data();
    for (double skipped; count-- > 0;) in >> (to ? *to++ : skipped);
  }
  KittiFrame frame;
  frame.camera = {"cam2", "pinhole", 1242, 375, {p2(0, 0), p2(1, 1), p2(0, 2), p2(1, 2)}};
  const Eigen::Matrix3d k = p2.leftCols<3>();
  frame.camera_from_lidar = Eigen::Isometry3d::Identity();
  frame.camera_from_lidar.linear() =
      Eigen::Quaterniond(Eigen::Matrix3d(r0 * tr.leftCols<3>())).normalized().toRotationMatrix();
  frame.camera_from_lidar.translation() = r0 * tr.col(3) + k.inverse() * p2.col(3);
  const Camera camera(frame.camera);
  const std::string path = SegmentData("kitti3/velodyne/" + number + ".bin");
  for (const Eigen::Vector3f& point : ParseKittiScan(ReadFile(path), path).in_sensor) {
    const Eigen::Vector3d in_camera = frame.camera_from_lidar * point.cast<double>();
    const auto pixel = in_camera.z() > 1 ? camera.Project(in_camera) : std::nullopt;
    if (pixel && pixel->x() > 0 && pixel->y() > 0 && pixel->x() < camera.Width() - 1 &&
        pixel->y() < camera.Height() - 1)
      frame.visible.push_back(point.cast<double>());
  }
  return frame;
}

struct Simulated {
  std::vector<Correspondence> points;
  std::vector<std::uint8_t> is_wrong;
};

/// A share of correspondences whose pixel has nothing to do with the point, or is some pixels off.
struct Wrong {
  double share = 0;
  double least_px = 0, most_px = 0;  ///< how far off; 0: anywhere in the image
};

/// Correspondences of a frame.
inline Simulated Simulate(const KittiFrame& frame, std::size_t count, const Wrong& wrong_ones,
                          std::uint64_t seed, double sigma_px = 1.5, double sigma_m = 0.02) {
  RandomNumbers random(seed);
  Simulated simulated;
  const Camera camera(frame.camera);
  const auto wrong =
      static_cast<std::size_t>(std::lround(wrong_ones.share * static_cast<double>(count)));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& point = frame.visible[random.Below(frame.visible.size())];
    Eigen::Vector2d pixel = *camera.Project(frame.camera_from_lidar * point);
    for (int k = 0; k < 2; ++k) pixel[k] += sigma_px * random.Normal();
    const Eigen::Vector3d noise(random.Normal(), random.Normal(), random.Normal());
    const Eigen::Vector3d measured = point + sigma_m * noise;
    if (i < wrong && wrong_ones.most_px > 0) {
      const double angle = random.Uniform(0, 2 * M_PI);
      pixel += random.Uniform(wrong_ones.least_px, wrong_ones.most_px) *
               Eigen::Vector2d(std::cos(angle), std::sin(angle));
    } else if (i < wrong)
      pixel = {random.Uniform(0, camera.Width() - 1), random.Uniform(0, camera.Height() - 1)};
    simulated.points.push_back({{measured.x(), measured.y(), measured.z()},
                                {pixel.x(), pixel.y()},
                                std::to_string(i + 1)});
    simulated.is_wrong.push_back(i < wrong);
  }
  return simulated;
}

/// Tangent from the truth to an estimate: translation, rotation, in the LIDAR's frame.
inline Eigen::Matrix<double, 6, 1> ErrorOf(const Se3Array& estimate,
                                           const Eigen::Isometry3d& truth) {
  const Eigen::Isometry3d between = IsometryOf(estimate).inverse() * truth;
  const Eigen::AngleAxisd turn(between.linear());
  Eigen::Matrix<double, 6, 1> error;
  error << between.translation(), turn.angle() * turn.axis();
  return error;
}

}  // namespace graticule::test
