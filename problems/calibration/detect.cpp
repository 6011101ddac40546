#include "graticule/problems/calibration/detect.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "graticule/problems/calibration/chessboard.hpp"
#include "graticule/problems/calibration/marker_detector.hpp"
#include "graticule/problems/calibration/saddle.hpp"

namespace graticule {
namespace {

/// How a marker lies in the image: a homography of the target's plane.
class MarkerMap {
 public:
  MarkerMap(const TargetMarker& marker, const SeenMarker& seen) {
    Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
    Eigen::Matrix<double, 8, 1> b;
    origin_ = {marker.corners[0][0], marker.corners[0][1]};
    side_ = std::abs(marker.corners[1][0] - marker.corners[0][0]);
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double x = (marker.corners[k][0] - origin_.x()) / side_;
      const double y = (marker.corners[k][1] - origin_.y()) / side_;
      const Eigen::Vector2d& pixel = seen.corners[k];
      a.row(2 * i) << x, y, 1, 0, 0, 0, -pixel.x() * x, -pixel.x() * y;
      a.row(2 * i + 1) << 0, 0, 0, x, y, 1, -pixel.y() * x, -pixel.y() * y;
      b.segment<2>(2 * i) = pixel;
    }
    const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
    h_ << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  }

  LocalMap At(double x_m, double y_m) const {
    const Eigen::Vector3d place((x_m - origin_.x()) / side_, (y_m - origin_.y()) / side_, 1);
    const Eigen::Vector3d image = h_ * place;
    LocalMap map;
    map.pixel = image.hnormalized();
    map.slope = (h_.topLeftCorner<2, 2>() - map.pixel * h_.block<1, 2>(2, 0)) / (image.z() * side_);
    return map;
  }

 private:
  Eigen::Vector2d origin_;
  double side_ = 1;
  Eigen::Matrix3d h_;
};

/// Markers that agree on where the next ones are: a code that was read wrongly stands alone.
std::vector<SeenMarker> Agreeing(const std::vector<SeenMarker>& seen,
                                 const std::map<int, TargetMarker>& markers) {
  constexpr double kMostOff = 0.4;  // of the way between two markers: lenses bend it
  std::vector<SeenMarker> known;
  for (const SeenMarker& marker : seen)
    if (markers.count(marker.id)) known.push_back(marker);
  std::vector<std::size_t> group(known.size());
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
  const auto root = [&group](std::size_t i) {
    while (group[i] != i) i = group[i];
    return i;
  };
  std::vector<MarkerMap> maps;
  std::vector<Eigen::Vector2d> centres, places;
  for (const SeenMarker& marker : known) {
    const TargetMarker& own = markers.at(marker.id);
    maps.emplace_back(own, marker);
    places.emplace_back((own.corners[0][0] + own.corners[2][0]) / 2,
                        (own.corners[0][1] + own.corners[2][1]) / 2);
    centres.push_back(maps.back().At(places.back().x(), places.back().y()).pixel);
  }
  for (std::size_t i = 0; i < known.size(); ++i) {
    // The nearest few: far ones are beyond what a homography says.
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < known.size(); ++k)
      if (k != i) others.push_back(k);
    std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
      return (places[a] - places[i]).norm() < (places[b] - places[i]).norm();
    });
    others.resize(std::min<std::size_t>(others.size(), 8));
    for (const std::size_t k : others) {
      const auto fits = [&](std::size_t from, std::size_t to) {
        const Eigen::Vector2d predicted = maps[from].At(places[to].x(), places[to].y()).pixel;
        return (predicted - centres[to]).norm() < kMostOff * (centres[to] - centres[from]).norm();
      };
      if (fits(i, k) && fits(k, i)) group[root(i)] = root(k);
    }
  }
  std::map<std::size_t, std::size_t> sizes;
  for (std::size_t i = 0; i < known.size(); ++i) ++sizes[root(i)];
  std::size_t largest = 0;
  for (const auto& [i, size] : sizes)
    if (sizes[largest] < size) largest = i;
  std::vector<SeenMarker> agreeing;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (root(i) == largest) agreeing.push_back(known[i]);
  return agreeing;
}

/// Polished, with what was let go of and can be found again, and polished once more.
std::vector<DetectedCorner> Polished(SaddleFinder* finder, const std::vector<TargetCorner>& all,
                                     double pitch_m) {
  finder->Polish(pitch_m);
  finder->Grow(1.05 * pitch_m);
  finder->Polish(pitch_m);
  std::vector<DetectedCorner> corners;
  for (const auto& [i, pixel] : finder->Found())
    corners.push_back({all[i].id, all[i].in_target, {pixel.x(), pixel.y()}});
  return corners;
}

// Of the way to a ChArUco marker, whose corner only just enters the window.
constexpr double kFreeOfMargin = 1.3;
// The windows of a chessboard's corners end before the next ones' edges.
constexpr double kFreeOfSquare = 0.5;

std::map<int, TargetMarker> MarkersById(const Target& target) {
  std::map<int, TargetMarker> markers;
  for (const TargetMarker& marker : MarkersOf(target)) markers[marker.id] = marker;
  return markers;
}

}  // namespace

class TargetDetector::Finder {
 public:
  virtual ~Finder() = default;
  virtual std::vector<DetectedCorner> Find(const GreyImage& image) const = 0;
};

class TargetDetector::MosaicFinder : public Finder {
 public:
  MosaicFinder(const Target& target, const DetectOptions& options)
      : markers_(MarkersById(target)),
        detector_(MarkerFamilyOf(target.family), {target.border_cells, options.decimate, false}) {}

  std::vector<DetectedCorner> Find(const GreyImage& image) const override {
    std::vector<DetectedCorner> corners;
    for (const SeenMarker& seen : Agreeing(detector_.Detect(image), markers_)) {
      const TargetMarker& marker = markers_.at(seen.id);
      for (std::size_t k = 0; k < 4; ++k)
        corners.push_back({4 * seen.id + static_cast<int>(k),
                           {marker.corners[k][0], marker.corners[k][1], 0},
                           {seen.corners[k].x(), seen.corners[k].y()}});
    }
    return corners;
  }

 private:
  std::map<int, TargetMarker> markers_;
  MarkerDetector detector_;
};

class TargetDetector::SaddleTargetFinder : public Finder {
 public:
  SaddleTargetFinder(const Target& target, const DetectOptions& options)
      : markers_(MarkersById(target)),
        corners_(CornersOf(target)),
        is_grid_(target.kind == TargetKind::kAprilGrid),
        pitch_m_(target.pitch_m),
        free_m_(is_grid_ ? target.spacing * target.pitch_m
                         : kFreeOfMargin * (target.pitch_m - target.marker_m) / 2),
        is_quick_(options.decimate > 1),
        detector_(MarkerFamilyOf(target.family), {target.border_cells, options.decimate, is_grid_}),
        other_(MarkerFamilyOf(target.family), {target.border_cells, options.decimate, !is_grid_}) {}

  std::vector<DetectedCorner> Find(const GreyImage& image) const override {
    std::vector<SeenMarker> seen = detector_.Detect(image);
    // Small tags vanish where black shrinks; blurred ones of a grid touch where it does not.
    if (seen.size() < markers_.size() && (seen.size() < 4 || !is_quick_)) {
      std::set<int> ids;
      for (const SeenMarker& marker : seen) ids.insert(marker.id);
      for (const SeenMarker& marker : other_.Detect(image))
        if (ids.insert(marker.id).second) seen.push_back(marker);
    }
    SaddleFinder finder(image, corners_, free_m_);
    for (const SeenMarker& marker : Agreeing(seen, markers_)) Seed(marker, &finder);
    finder.Grow(1.05 * pitch_m_);
    return Polished(&finder, corners_, pitch_m_);
  }

 private:
  // The corners at or around a marker.
  void Seed(const SeenMarker& seen, SaddleFinder* finder) const {
    const TargetMarker& marker = markers_.at(seen.id);
    const MarkerMap map(marker, seen);
    const double x = (marker.corners[0][0] + marker.corners[2][0]) / 2;
    const double y = (marker.corners[0][1] + marker.corners[2][1]) / 2;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const auto& place = corners_[i].in_target;
      if (std::max(std::abs(place[0] - x), std::abs(place[1] - y)) < 0.51 * pitch_m_)
        finder->Try(i, map.At(place[0], place[1]));
    }
  }

  std::map<int, TargetMarker> markers_;
  std::vector<TargetCorner> corners_;
  bool is_grid_;
  double pitch_m_, free_m_;
  bool is_quick_;
  MarkerDetector detector_, other_;
};

class TargetDetector::ChessboardFinder : public Finder {
 public:
  ChessboardFinder(const Target& target, const DetectOptions& options)
      : target_(target), corners_(CornersOf(target)), is_quick_(options.decimate > 1) {}

  std::vector<DetectedCorner> Find(const GreyImage& image) const override {
    const auto board = FindChessboard(image, target_.columns, target_.rows, !is_quick_);
    if (!board) return {};
    SaddleFinder finder(image, corners_, kFreeOfSquare * target_.pitch_m);
    for (std::size_t i = 0; i < corners_.size(); ++i) finder.Put(i, board->corners[i]);
    return Polished(&finder, corners_, target_.pitch_m);
  }

 private:
  Target target_;
  std::vector<TargetCorner> corners_;
  bool is_quick_;
};

TargetDetector::TargetDetector(const Target& target, const DetectOptions& options)
    : target_(target) {
  CheckTarget(target);
  switch (target.kind) {
    case TargetKind::kTagMosaic:
      finder_ = std::make_unique<MosaicFinder>(target, options);
      break;
    case TargetKind::kAprilGrid:
    case TargetKind::kCharuco:
      finder_ = std::make_unique<SaddleTargetFinder>(target, options);
      break;
    case TargetKind::kChessboard:
      finder_ = std::make_unique<ChessboardFinder>(target, options);
      break;
  }
}

TargetDetector::~TargetDetector() = default;

const Target& TargetDetector::Of() const { return target_; }

std::vector<DetectedCorner> TargetDetector::Detect(const GreyImage& image) const {
  // Smaller pictures than any detector's windows.
  if (image.width < 32 || image.height < 32) return {};
  return finder_->Find(image);
}

}  // namespace graticule
