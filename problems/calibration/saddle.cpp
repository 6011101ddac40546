#include "graticule/problems/calibration/saddle.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace graticule {
namespace {

constexpr int kLeastWindow = 2, kMostWindow = 11;  // px, half of cornerSubPix' side
constexpr double kWindowOfFree = 0.7;
constexpr double kMostMoved = 0.6;    // of the free distance
constexpr double kFarOff = 0.25;      // of the free distance, from where the neighbours say
constexpr double kLeastFreePx = 2.5;  // nearer than this, squares are not told apart
constexpr double kLeastContrast = 6;  // shades
constexpr std::size_t kMostNeighbours = 12;

// The shortest way in pixels that a step of this length on the target may be.
double ShortestPx(const Eigen::Matrix2d& slope, double metres) {
  const double long_side = std::max(slope.col(0).norm(), slope.col(1).norm());
  return long_side > 0 ? metres * std::abs(slope.determinant()) / long_side : 0;
}

}  // namespace

SaddleFinder::SaddleFinder(const GreyImage& image, const std::vector<TargetCorner>& corners,
                           double free_m)
    : image_(image), corners_(corners), free_m_(free_m) {}

double SaddleFinder::Shade(const Eigen::Vector2d& pixel) const {
  const double x = std::clamp(pixel.x(), 0.0, Width() - 1.001);
  const double y = std::clamp(pixel.y(), 0.0, Height() - 1.001);
  const int i = static_cast<int>(x), k = static_cast<int>(y);
  const double a = x - i, b = y - k;
  const std::uint8_t* upper = image_.shades.data() + static_cast<std::size_t>(k) * image_.width + i;
  const std::uint8_t* lower = upper + image_.width;
  return (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
}

bool SaddleFinder::IsSaddle(std::size_t corner, const Eigen::Vector2d& pixel,
                            const Eigen::Matrix2d& slope) const {
  double shades[2][2];  // [x > 0][y > 0], on the diagonals of the four squares
  for (const int i : {0, 1})
    for (const int k : {0, 1}) {
      double sum = 0;
      for (const double part : {0.35, 0.6}) {
        const Eigen::Vector2d on_target(i ? free_m_ : -free_m_, k ? free_m_ : -free_m_);
        sum += Shade(pixel + slope * (part * on_target));
      }
      shades[i][k] = sum / 2;
    }
  const double sign = corners_[corner].saddle;
  const double black =
      sign > 0 ? std::max(shades[0][0], shades[1][1]) : std::max(shades[0][1], shades[1][0]);
  const double white =
      sign > 0 ? std::min(shades[0][1], shades[1][0]) : std::min(shades[0][0], shades[1][1]);
  const double range = std::abs(shades[0][0] + shades[1][1] - shades[0][1] - shades[1][0]) / 2;
  return white - black > std::max(kLeastContrast, 0.4 * range);
}

std::optional<Eigen::Vector2d> SaddleFinder::Refine(std::size_t corner,
                                                    const LocalMap& expected) const {
  const double free_px = ShortestPx(expected.slope, free_m_);
  const auto inside = [this](const Eigen::Vector2d& p) {
    return p.x() >= 1 && p.y() >= 1 && p.x() <= Width() - 2 && p.y() <= Height() - 2;
  };
  if (!(free_px >= kLeastFreePx) || !inside(expected.pixel)) return std::nullopt;
  const int window =
      std::clamp(static_cast<int>(kWindowOfFree * free_px), kLeastWindow, kMostWindow);
  if (Width() < 2 * window + 5 || Height() < 2 * window + 5) return std::nullopt;
  std::vector<cv::Point2f> point = {
      {static_cast<float>(expected.pixel.x()), static_cast<float>(expected.pixel.y())}};
  const cv::Mat view(Height(), Width(), CV_8UC1, const_cast<std::uint8_t*>(image_.shades.data()));
  cv::cornerSubPix(view, point, {window, window}, {-1, -1},
                   {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-3});
  const Eigen::Vector2d refined(static_cast<double>(point[0].x), static_cast<double>(point[0].y));
  if (!refined.allFinite() || !inside(refined) ||
      (refined - expected.pixel).norm() > std::max(1.5, kMostMoved * free_px) ||
      !IsSaddle(corner, refined, expected.slope))
    return std::nullopt;
  return refined;
}

bool SaddleFinder::Try(std::size_t corner, const LocalMap& expected) {
  if (found_.count(corner)) return true;
  const auto refined = Refine(corner, expected);
  if (refined) found_[corner] = *refined;
  return refined.has_value();
}

std::optional<LocalMap> SaddleFinder::FromNeighbours(std::size_t corner, double reach_m,
                                                     bool with_itself) const {
  struct Neighbour {
    double x, y, distance;
    Eigen::Vector2d pixel;
  };
  std::vector<Neighbour> near;
  const auto& here = corners_[corner].in_target;
  for (const auto& [other, pixel] : found_) {
    if (other == corner && !with_itself) continue;
    const auto& place = corners_[other].in_target;
    const double x = (place[0] - here[0]) / reach_m, y = (place[1] - here[1]) / reach_m;
    const double distance = std::hypot(x, y);
    if (distance < 1) near.push_back({x, y, distance, pixel});
  }
  if (near.size() < 4) return std::nullopt;
  std::stable_sort(near.begin(), near.end(),
                   [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
  near.resize(std::min(near.size(), kMostNeighbours));

  // A paraboloid where the neighbours say one, else a plane.
  for (const Eigen::Index terms : {6, 3}) {
    const auto rows = static_cast<Eigen::Index>(near.size());
    if (rows < terms + 1) continue;
    Eigen::MatrixXd a(rows, terms);
    Eigen::MatrixXd b(rows, 2);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const Neighbour& n = near[static_cast<std::size_t>(row)];
      const double weight = 1 / (0.1 + n.distance);
      const double basis[6] = {1, n.x, n.y, n.x * n.x, n.x * n.y, n.y * n.y};
      for (Eigen::Index i = 0; i < terms; ++i) a(row, i) = weight * basis[i];
      b.row(row) = weight * n.pixel.transpose();
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
    qr.setThreshold(0.02);  // neighbours nearly in a row say nothing across it
    if (qr.rank() < terms) continue;
    const Eigen::MatrixXd c = qr.solve(b);
    LocalMap map;
    map.pixel = c.row(0).transpose();
    map.slope.col(0) = c.row(1).transpose() / reach_m;
    map.slope.col(1) = c.row(2).transpose() / reach_m;
    return map;
  }
  return std::nullopt;
}

void SaddleFinder::Grow(double pitch_m) {
  std::vector<std::size_t> tried_with(corners_.size(), 0);  // how many were known then
  bool has_grown = true;
  while (has_grown) {
    has_grown = false;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (found_.count(i) || tried_with[i] == found_.size()) continue;
      tried_with[i] = found_.size();
      const auto& here = corners_[i].in_target;
      const bool is_near = std::any_of(found_.begin(), found_.end(), [&](const auto& known) {
        const auto& place = corners_[known.first].in_target;
        return std::hypot(place[0] - here[0], place[1] - here[1]) < 1.1 * pitch_m;
      });
      if (!is_near) continue;
      const auto expected = FromNeighbours(i, 2.6 * pitch_m, false);
      if (expected && Try(i, *expected)) has_grown = true;
    }
  }
}

void SaddleFinder::Polish(double pitch_m) {
  std::map<std::size_t, Eigen::Vector2d> polished;
  for (const auto& [corner, pixel] : found_) {
    const auto around = FromNeighbours(corner, 2.6 * pitch_m, true);
    if (!around) {  // too few neighbours to say anything against it
      polished[corner] = pixel;
      continue;
    }
    const auto without = FromNeighbours(corner, 2.6 * pitch_m, false);
    const double far_px = std::max(1.0, kFarOff * ShortestPx(around->slope, free_m_));
    const bool is_far = without && (without->pixel - pixel).norm() > far_px;
    auto refined = Refine(corner, {is_far ? without->pixel : pixel, around->slope});
    if (refined && is_far && (without->pixel - *refined).norm() > 2 * far_px) refined.reset();
    if (refined) polished[corner] = *refined;
  }
  found_ = std::move(polished);
}

}  // namespace graticule
