// Targets that are printed, and found again in the picture: every corner, its number and its place.

#include "graticule/problems/calibration/detect.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <thread>

#include "graticule/io/photo.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/guess_target.hpp"
#include "graticule/problems/calibration/print_target.hpp"
#include "targets.hpp"

namespace graticule {
namespace {

constexpr PaperSize kPage = {297, 210};
constexpr int kWidth = 1188;  // px: 4 a millimetre

GreyImage FromMat(const cv::Mat& mat) {
  GreyImage image;
  image.width = static_cast<std::size_t>(mat.cols);
  image.height = static_cast<std::size_t>(mat.rows);
  for (int row = 0; row < mat.rows; ++row)
    image.shades.insert(image.shades.end(), mat.ptr(row), mat.ptr(row) + mat.cols);
  return image;
}

cv::Mat Printed(const Target& target) {
  const GreyImage page =
      ParseGreyPhoto(PngFromSvg(PrintTargetSvg(target, kPage), kWidth), "page.png");
  return cv::Mat(static_cast<int>(page.height), static_cast<int>(page.width), CV_8UC1,
                 const_cast<std::uint8_t*>(page.shades.data()))
      .clone();
}

/// The affine map from places [m] to pixels, and how far the corners are from it.
struct Laid {
  Eigen::Matrix<double, 3, 2> map;
  double rms = 0, worst = 0;
};

Laid LayOver(const std::vector<DetectedCorner>& corners) {
  Eigen::MatrixXd places(static_cast<Eigen::Index>(corners.size()), 3),
      pixels(static_cast<Eigen::Index>(corners.size()), 2);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    places.row(row) << corners[i].in_target[0], corners[i].in_target[1], 1;
    pixels.row(row) << corners[i].pixel[0], corners[i].pixel[1];
  }
  Laid laid;
  laid.map = places.colPivHouseholderQr().solve(pixels);
  const Eigen::VectorXd off = (places * laid.map - pixels).rowwise().norm();
  laid.rms = std::sqrt(off.squaredNorm() / static_cast<double>(corners.size()));
  laid.worst = off.maxCoeff();
  return laid;
}

class EveryTarget : public ::testing::TestWithParam<std::size_t> {
 protected:
  Target target_ = test::OneOfEachKind()[GetParam()];
  bool IsMosaic() const { return target_.kind == TargetKind::kTagMosaic; }
};

TEST_P(EveryTarget, IsFoundWhereItWasPrintedAtExactScale) {
  const TargetDetector detector(target_);
  const std::vector<DetectedCorner> corners = detector.Detect(FromMat(Printed(target_)));
  EXPECT_EQ(corners.size(), CornersOf(target_).size());
  ASSERT_GE(corners.size(), 8u);
  const Laid laid = LayOver(corners);
  EXPECT_LT(laid.worst, IsMosaic() ? 0.5 : 0.2);
  const double dots_per_m = 1e3 * kWidth / kPage.width_mm, up = HasYUp(target_) ? -1 : 1;
  // Edges of a tag are found a little inside it, by libapriltag.
  const double off = (IsMosaic() ? 4e-3 : 1e-3) * dots_per_m;
  EXPECT_NEAR(laid.map(0, 0), dots_per_m, off);
  EXPECT_NEAR(laid.map(1, 1), up * dots_per_m, off);
  EXPECT_NEAR(laid.map(0, 1), 0, off);
  EXPECT_NEAR(laid.map(1, 0), 0, off);
  // The middle of the target is that of the page without its footer; the first pixel's centre is
  // (0, 0).
  const std::array<double, 4> box = ExtentOf(target_);
  const Eigen::Vector2d middle =
      laid.map.transpose() * Eigen::Vector3d((box[0] + box[2]) / 2, (box[1] + box[3]) / 2, 1);
  EXPECT_NEAR(middle.x(), 4 * kPage.width_mm / 2 - 0.5, 0.1);
  EXPECT_NEAR(middle.y(), 4 * (kPage.height_mm - 12) / 2 - 0.5, 0.1);
  for (const DetectedCorner& corner : corners) {
    const std::vector<TargetCorner> all = CornersOf(target_);
    const auto own = std::find_if(all.begin(), all.end(),
                                  [&](const TargetCorner& c) { return c.id == corner.id; });
    ASSERT_NE(own, all.end());
    EXPECT_EQ(own->in_target, corner.in_target);
  }
}

TEST_P(EveryTarget, IsFoundHoweverThePictureIsTurned) {
  const TargetDetector detector(target_);
  const cv::Mat page = Printed(target_);
  const Laid upright = LayOver(detector.Detect(FromMat(page)));
  for (const int turn : {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE}) {
    cv::Mat turned;
    cv::rotate(page, turned, turn);
    const std::vector<DetectedCorner> corners = detector.Detect(FromMat(turned));
    ASSERT_EQ(corners.size(), CornersOf(target_).size()) << turn;
    const Laid laid = LayOver(corners);
    EXPECT_LT(laid.worst, IsMosaic() ? 0.5 : 0.2);
    // The same corner has the same number: x on the target turns with the picture.
    const Eigen::Vector2d x = upright.map.row(0).normalized(), now = laid.map.row(0).normalized();
    const double cosine = turn == cv::ROTATE_180 ? -1 : 0;
    EXPECT_NEAR(x.dot(now), cosine, 1e-2);
    if (cosine == 0) {
      EXPECT_NEAR(x.x() * now.y() - x.y() * now.x(), turn == cv::ROTATE_90_CLOCKWISE ? 1 : -1,
                  1e-2);
    }
  }
}

TEST_P(EveryTarget, IsFoundTiltedBlurredAndNoisy) {
  const cv::Mat page = Printed(target_);
  const auto w = static_cast<float>(page.cols), h = static_cast<float>(page.rows);
  const std::vector<cv::Point2f> from = {{0, 0}, {w, 0}, {w, h}, {0, h}},
                                 to = {{80, 60}, {880, 140}, {820, 600}, {20, 680}};
  const cv::Mat homography = cv::getPerspectiveTransform(from, to);
  cv::Mat seen;
  // Four times as large, then the mean of each pixel, as a sensor has it.
  const cv::Mat four = (cv::Mat_<double>(3, 3) << 4, 0, 1.5, 0, 4, 1.5, 0, 0, 1);
  cv::warpPerspective(page, seen, four * homography, {3840, 2880}, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 128);
  cv::resize(seen, seen, {960, 720}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(seen, seen, {}, 0.8);
  cv::Mat noise(seen.size(), CV_16SC1);
  cv::RNG(5).fill(noise, cv::RNG::NORMAL, 0, 4);
  cv::add(seen, noise, seen, cv::noArray(), CV_8U);

  // Where the corners are: the upright page's, through the homography.
  const Laid laid = LayOver(TargetDetector(target_).Detect(FromMat(page)));
  for (const double decimate : {1.0, 2.0}) {
    const std::vector<DetectedCorner> corners =
        TargetDetector(target_, {decimate}).Detect(FromMat(seen));
    const auto all = static_cast<double>(CornersOf(target_).size());
    EXPECT_GE(static_cast<double>(corners.size()), (decimate > 1 ? 0.7 : 0.95) * all);
    double squared = 0;
    for (const DetectedCorner& corner : corners) {
      const Eigen::Vector2d flat =
          laid.map.transpose() * Eigen::Vector3d(corner.in_target[0], corner.in_target[1], 1);
      std::vector<cv::Point2d> point = {{flat.x(), flat.y()}};
      cv::perspectiveTransform(point, point, homography);
      const double off = std::hypot(point[0].x - corner.pixel[0], point[0].y - corner.pixel[1]);
      EXPECT_LT(off, 1) << corner.id;
      squared += off * off;
    }
    // Measured: saddles 0.034 to 0.043 px, tags' corners 0.087.
    EXPECT_LT(std::sqrt(squared / static_cast<double>(corners.size())), IsMosaic() ? 0.2 : 0.08);
  }
}

TEST_P(EveryTarget, IsGuessedFromItsPicture) {
  const auto guess = GuessTarget({FromMat(Printed(target_))});
  ASSERT_TRUE(guess);
  EXPECT_EQ(guess->kind, target_.kind);
  EXPECT_EQ(guess->columns, target_.columns);
  EXPECT_EQ(guess->rows, target_.rows);
  EXPECT_EQ(guess->family, target_.family);
  EXPECT_EQ(guess->is_legacy, target_.is_legacy);
  EXPECT_EQ(guess->border_cells, target_.border_cells);
  EXPECT_EQ(guess->pitch_m, kNominalPitch_m);
  if (target_.kind == TargetKind::kTagMosaic) {
    EXPECT_EQ(guess->stride, 24);
  }
  if (target_.kind == TargetKind::kAprilGrid) {
    EXPECT_NEAR(guess->spacing, target_.spacing, 1e-12);
  }
  if (target_.kind == TargetKind::kCharuco) {
    EXPECT_NEAR(guess->marker_m / guess->pitch_m, target_.marker_m / target_.pitch_m, 0.03);
  }
}

TEST_P(EveryTarget, IsNotFoundInNoiseOrNothing) {
  const TargetDetector detector(target_);
  GreyImage image;
  EXPECT_TRUE(detector.Detect(image).empty());
  image = {200, 150, std::vector<std::uint8_t>(200 * 150, 128)};
  EXPECT_TRUE(detector.Detect(image).empty());
  std::mt19937 random(3);
  for (std::uint8_t& shade : image.shades) shade = static_cast<std::uint8_t>(random());
  EXPECT_TRUE(detector.Detect(image).empty());
  EXPECT_FALSE(GuessTarget({image}));
}

TEST_P(EveryTarget, IsFoundByManyThreadsAlike) {
  const TargetDetector detector(target_, {2});
  const GreyImage image = FromMat(Printed(target_));
  std::vector<std::vector<DetectedCorner>> found(4);
  std::vector<std::thread> threads;
  for (auto& own : found) threads.emplace_back([&] { own = detector.Detect(image); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : found) {
    ASSERT_EQ(own.size(), found[0].size());
    for (std::size_t i = 0; i < own.size(); ++i) EXPECT_EQ(own[i].pixel, found[0][i].pixel);
  }
}

INSTANTIATE_TEST_SUITE_P(Detect, EveryTarget, ::testing::Range<std::size_t>(0, 5),
                         [](const auto& info) {
                           return std::string(std::array{"Mosaic", "Grid", "Charuco", "Legacy",
                                                         "Chessboard"}[info.param]);
                         });

}  // namespace
}  // namespace graticule
