// What a file's numbers mean: pixels as OpenCV projects them, from files that OpenCV reads and
// writes.

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "graticule/io/camera_file.hpp"
#include "graticule/problems/calibration/camera.hpp"

namespace graticule {
namespace {

constexpr double kSamePixel = 1e-9;

std::string TextOf(const CameraIntrinsics& camera, CameraFormat format) {
  CameraRig rig;
  rig.cameras.push_back({camera, {0, 0, 0, 0, 0, 0, 1}, {}});
  return FormatCameras(rig, format);
}

/// K and D as OpenCV itself reads them from our file.
std::pair<cv::Mat, cv::Mat> AsOpenCvReads(const CameraIntrinsics& camera) {
  cv::FileStorage storage(TextOf(camera, CameraFormat::kOpenCv),
                          cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat k, d;
  storage["camera_matrix"] >> k;
  storage["distortion_coefficients"] >> d;
  EXPECT_EQ(static_cast<int>(storage["image_width"]), camera.width);
  return {k, d};
}

std::vector<cv::Point3d> Points(double furthest_angle) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 500; ++i) {
    const double angle = furthest_angle * any(random), turn = 2 * M_PI * any(random);
    const double range = 0.2 + 3 * any(random);
    points.emplace_back(range * std::sin(angle) * std::cos(turn),
                        range * std::sin(angle) * std::sin(turn), range * std::cos(angle));
  }
  return points;
}

CameraIntrinsics Intrinsics(const std::string& model, const std::vector<double>& terms) {
  CameraIntrinsics camera{"left", model, 640, 480, {535.9, 536.1, 342.28, 235.57 / 3}};
  camera.parameters.insert(camera.parameters.end(), terms.begin(), terms.end());
  return camera;
}

void ExpectSamePixels(const CameraIntrinsics& camera, const std::vector<cv::Point3d>& points,
                      const std::vector<cv::Point2d>& pixels) {
  const CameraModel& model = CameraModelOf(camera.model);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double point[3] = {points[i].x, points[i].y, points[i].z};
    double pixel[2];
    ASSERT_TRUE(model.project(camera.parameters.data(), point, pixel, nullptr, nullptr));
    EXPECT_NEAR(pixel[0], pixels[i].x, kSamePixel);
    EXPECT_NEAR(pixel[1], pixels[i].y, kSamePixel);
  }
}

TEST(CameraFormats, MeanWhatOpenCvsProjectPointsDoes) {
  const std::vector<cv::Point3d> points = Points(0.7);
  for (const CameraIntrinsics& camera :
       {Intrinsics("pinhole", {}), Intrinsics("radial2", {-.26, .04}),
        Intrinsics("radial3", {-.26, .04, -.01}), Intrinsics("brown4", {-.26, .04, .002, -.001}),
        Intrinsics("brown5", {-.26, .04, .002, -.001, .03}),
        Intrinsics("brown8", {.479, .0266, 4.4e-4, -1.2e-4, 9e-3, .7667, .0963, .0014})}) {
    SCOPED_TRACE(camera.model);
    const auto [k, d] = AsOpenCvReads(camera);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), k, d, pixels);
    ExpectSamePixels(camera, points, pixels);
  }
}

TEST(CameraFormats, MeanWhatOpenCvsFisheyeDoes) {
  const std::vector<cv::Point3d> points = Points(1.5);
  for (const CameraIntrinsics& camera :
       {Intrinsics("angular1", {.01}), Intrinsics("angular4", {.01, -.0108, .0059, -.00166})}) {
    const auto [k, d] = AsOpenCvReads(camera);
    std::vector<cv::Point2d> pixels;
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), k, d);
    ExpectSamePixels(camera, points, pixels);
  }
}

// Mei and Rives 2007, as OpenCV's omnidir::projectPoints has it without distortion.
TEST(CameraFormats, MeanWhatTheOmnidirectionalModelDoes) {
  const std::vector<cv::Point3d> points = Points(1.8);
  for (const double alpha : {0.2, 0.5, 0.62}) {
    const CameraIntrinsics camera = Intrinsics("unified", {alpha});
    cv::FileStorage storage(TextOf(camera, CameraFormat::kOpenCv),
                            cv::FileStorage::READ | cv::FileStorage::MEMORY);
    cv::Matx33d k;
    cv::Mat read;
    storage["camera_matrix"] >> read;
    read.copyTo(k);
    const double xi = storage["xi"];
    std::vector<cv::Point3d> seen;
    std::vector<cv::Point2d> pixels;
    for (const cv::Point3d& point : points) {
      const cv::Point3d on_sphere = point / cv::norm(point);
      if (on_sphere.z + std::min(xi, 1 / std::max(xi, 1e-9)) < 0.05) continue;
      seen.push_back(point);
      pixels.emplace_back(k(0, 0) * on_sphere.x / (on_sphere.z + xi) + k(0, 2),
                          k(1, 1) * on_sphere.y / (on_sphere.z + xi) + k(1, 2));
    }
    EXPECT_GT(seen.size(), 200u);
    ExpectSamePixels(camera, seen, pixels);
    // And back, through Kalibr's file.
    ExpectSamePixels(
        ParseCameras(TextOf(camera, CameraFormat::kKalibr), "a.yaml").cameras[0].intrinsics, seen,
        pixels);
  }
}

TEST(CameraFormats, ReadWhatOpenCvWrites) {
  for (const char* ending : {".yml", ".xml"}) {
    cv::FileStorage storage(ending, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    const cv::Matx33d k(500.1, 0, 320.5, 0, 501.3, 241. / 7, 0, 0, 1);
    const cv::Mat d = (cv::Mat_<double>(5, 1) << -.1, .02 / 3, 1e-5, -2e-17, .3);
    storage << "image_width" << 640 << "image_height" << 480;
    storage << "camera_matrix" << cv::Mat(k) << "distortion_coefficients" << d;
    const CameraIntrinsics camera =
        ParseCameras(storage.releaseAndGetString(), std::string("a") + ending)
            .cameras[0]
            .intrinsics;
    EXPECT_EQ(camera.model, "brown5");
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.parameters,
              (std::vector<double>{500.1, 501.3, 320.5, 241. / 7, -.1, .02 / 3, 1e-5, -2e-17, .3}));
  }
}

}  // namespace
}  // namespace graticule
