#include "graticule/problems/calibration/marker_layout.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "graticule/problems/calibration/guess_target.hpp"

namespace graticule {
namespace {

constexpr int kMostColumns = 40;

/// Where a pixel is in a marker's own plane: in its sides, from its centre.
Eigen::Vector2d InMarker(const SeenMarker& marker, const Eigen::Vector2d& pixel) {
  Eigen::Matrix<double, 8, 8> a = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<double, 8, 1> b;
  constexpr double kSquare[4][2] = {{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}};
  for (Eigen::Index i = 0; i < 4; ++i) {
    const double x = kSquare[i][0], y = kSquare[i][1];
    const Eigen::Vector2d& p = marker.corners[static_cast<std::size_t>(i)];
    a.row(2 * i) << x, y, 1, 0, 0, 0, -p.x() * x, -p.x() * y;
    a.row(2 * i + 1) << 0, 0, 0, x, y, 1, -p.y() * x, -p.y() * y;
    b.segment<2>(2 * i) = p;
  }
  const Eigen::Matrix<double, 8, 1> h = a.partialPivLu().solve(b);
  Eigen::Matrix3d homography;
  homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
  const Eigen::Vector3d back = homography.inverse() * Eigen::Vector3d(pixel.x(), pixel.y(), 1);
  return {back.x() / back.z(), back.y() / back.z()};
}

Eigen::Vector2d Centre(const SeenMarker& marker) {
  return (marker.corners[0] + marker.corners[1] + marker.corners[2] + marker.corners[3]) / 4;
}

/// From the cross ratio of the four ends of two upper edges, and of the lower ones, which no
/// perspective changes.
double GapBetween(const SeenMarker& left, const SeenMarker& right) {
  double sum = 0;
  for (const auto& [l, r] : {std::pair<std::size_t, std::size_t>(0, 1), {3, 2}}) {
    const Eigen::Vector2d &a = left.corners[l], &b = left.corners[r];
    const Eigen::Vector2d &c = right.corners[l], &d = right.corners[r];
    const double ratio = (c - a).norm() * (d - b).norm() / ((c - b).norm() * (d - a).norm());
    if (!(ratio > 1)) return 0;
    // Of 0, 1, 1 + s and 2 + s it is (1 + s)^2 / (s (2 + s)).
    sum += std::sqrt(ratio / (ratio - 1)) - 1;
  }
  return sum / 2;
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// How far the nearest markers are from each other, in their sides.
double NearestStep(const std::vector<MarkerPair>& pairs) {
  std::map<int, double> nearest;
  for (const MarkerPair& pair : pairs) {
    const double distance = std::hypot(pair.x, pair.y);
    const auto [known, added] = nearest.emplace(pair.from, distance);
    if (!added) known->second = std::min(known->second, distance);
  }
  std::vector<double> steps;
  for (const auto& [id, step] : nearest) steps.push_back(step);
  return Median(std::move(steps));
}

/// The pairs that lie as a layout says.  `place_of` is a marker's place in steps, y down.
template <class PlaceOf>
std::vector<MarkerPair> Fitting(const std::vector<MarkerPair>& pairs, double step,
                                const PlaceOf& place_of) {
  constexpr double kMostOff = 0.3;  // steps
  std::vector<MarkerPair> fitting;
  for (const MarkerPair& pair : pairs) {
    const Eigen::Vector2d expected = place_of(pair.to) - place_of(pair.from);
    if ((expected - Eigen::Vector2d(pair.x, pair.y) / step).norm() < kMostOff)
      fitting.push_back(pair);
  }
  return fitting;
}

/// The gap between markers that are so many steps from each other in a row.
template <class PlaceOf>
double GapAt(const std::vector<MarkerPair>& pairs, double steps, const PlaceOf& place_of) {
  std::vector<double> gaps;
  for (const MarkerPair& pair : pairs) {
    const Eigen::Vector2d apart = place_of(pair.to) - place_of(pair.from);
    if (apart.y() == 0 && apart.x() == steps && pair.gap > 0) gaps.push_back(pair.gap);
  }
  return Median(std::move(gaps));
}

int LargestId(const std::vector<MarkerPair>& pairs) {
  int largest = 0;
  for (const MarkerPair& pair : pairs) largest = std::max({largest, pair.from, pair.to});
  return largest;
}

/// OpenCV's smallest dictionary that has the markers: they share their codes.
std::string SmallestDictionary(const std::string& family, int markers) {
  if (family.compare(0, 5, "DICT_") != 0) return family;
  const std::string beginning = family.substr(0, family.rfind('_') + 1);
  for (const int size : {50, 100})
    if (markers <= size) return beginning + std::to_string(size);
  return family;
}

}  // namespace

std::vector<MarkerPair> PairsOf(const std::vector<SeenMarker>& markers) {
  constexpr double kFarthest = 3.2;  // sides: beyond it a lens bends too much
  constexpr double kMostOff = 0.4;   // of the way
  std::vector<MarkerPair> pairs;
  for (const SeenMarker& from : markers)
    for (const SeenMarker& to : markers) {
      if (from.id == to.id) continue;
      const Eigen::Vector2d at = InMarker(from, Centre(to)), back = InMarker(to, Centre(from));
      if (!at.allFinite() || !back.allFinite() || !(at.norm() < kFarthest) ||
          !((at + back).norm() < kMostOff * at.norm()))
        continue;
      const bool is_beside = at.x() > 0 && std::abs(at.y()) < 0.3 * at.x();
      pairs.push_back({from.id, to.id, at.x(), at.y(), is_beside ? GapBetween(from, to) : 0});
    }
  return pairs;
}

LayoutGuess GuessTagLayout(const std::vector<MarkerPair>& pairs, const MarkerFamily& family,
                           int border_cells) {
  LayoutGuess best;
  const double step = NearestStep(pairs);
  if (!(step > 1.02) || step > 2.1) return best;
  const bool is_grid = border_cells == 2;
  for (int columns = 2; columns <= kMostColumns; ++columns) {
    const auto place_of = [&](int id) {
      const int row = id / columns;
      return Eigen::Vector2d(id % columns, is_grid ? -row : row);
    };
    const std::vector<MarkerPair> fitting = Fitting(pairs, step, place_of);
    if (fitting.size() <= best.fitting) continue;
    const double gap = GapAt(fitting, 1, place_of);
    Target target;
    target.kind = is_grid ? TargetKind::kAprilGrid : TargetKind::kTagMosaic;
    target.family = family.name;
    target.border_cells = border_cells;
    target.columns = columns;
    target.rows = LargestId(fitting) / columns + 1;
    target.pitch_m = kNominalPitch_m;
    if (is_grid) {
      target.spacing = std::round(gap * 20) / 20;  // they are made with round ratios
      if (!(target.spacing > 0)) continue;
    } else {
      const double black = family.cells + 2;
      if (std::abs(gap - 2 / black) > 0.12) continue;  // tags, but not a mosaic
      target.stride = columns;
      int last = 0;
      for (const MarkerPair& pair : fitting)
        last = std::max({last, pair.from % columns, pair.to % columns});
      target.columns = last + 1;
    }
    best = {target, fitting.size()};
  }
  return best;
}

LayoutGuess GuessCharucoLayout(const std::vector<MarkerPair>& pairs, const MarkerFamily& family) {
  LayoutGuess best;
  const double square = NearestStep(pairs) / std::sqrt(2.0);
  if (!(square > 1.05) || square > 2.2) return best;
  const int markers = LargestId(pairs) + 1;
  for (int columns = 3; columns <= kMostColumns; ++columns)
    for (const int first_white : {1, 0}) {
      // The white squares, row by row, as far as there are ids.
      std::vector<Eigen::Vector2d> places;
      for (int row = 0; static_cast<int>(places.size()) < markers; ++row)
        for (int column = (row + first_white) % 2; column < columns; column += 2)
          places.emplace_back(column, row);
      const auto place_of = [&](int id) { return places[static_cast<std::size_t>(id)]; };
      const std::vector<MarkerPair> fitting = Fitting(pairs, square, place_of);
      if (fitting.size() <= best.fitting) continue;
      const double gap = GapAt(fitting, 2, place_of);
      Target target;
      target.kind = TargetKind::kCharuco;
      target.columns = columns;
      target.rows = std::max(static_cast<int>(place_of(LargestId(fitting)).y()) + 1, 2);
      target.pitch_m = kNominalPitch_m;
      target.marker_m = kNominalPitch_m / (gap > 1 ? (1 + gap) / 2 : square);
      // Only legacy boards begin with a white square, and only of an even number of rows.
      target.is_legacy = first_white == 0;
      target.rows += target.is_legacy && target.rows % 2 == 1;
      target.family = SmallestDictionary(family.name, (target.columns * target.rows + 1) / 2);
      best = {target, fitting.size()};
    }
  return best;
}

}  // namespace graticule
