#include "graticule/io/contours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

// The field with a ring of nodes without value around it, at the image's edge.
class Framed {
 public:
  Framed(const ImageField& field, double level, bool logarithmic)
      : field_(field), level_(level), logarithmic_(logarithmic) {}

  std::size_t Columns() const { return field_.columns + 2; }
  std::size_t Rows() const { return field_.rows + 2; }
  bool InRing(std::size_t c, std::size_t r) const {
    return c == 0 || r == 0 || c + 1 == Columns() || r + 1 == Rows();
  }
  double Value(std::size_t c, std::size_t r) const {
    return InRing(c, r) ? std::numeric_limits<double>::quiet_NaN() : field_.Value(c - 1, r - 1);
  }
  bool Inside(std::size_t c, std::size_t r) const { return Value(c, r) >= level_; }
  ImagePoint At(std::size_t c, std::size_t r) const {
    const auto place = [](std::size_t i, std::size_t count, int size) {
      if (i == 0) return -0.5;
      if (i == count + 1) return size - 0.5;
      return static_cast<double>(i - 1) * (size - 1) / static_cast<double>(count - 1);
    };
    return {place(c, field_.columns, field_.width), place(r, field_.rows, field_.height)};
  }

  // Where the outline crosses the edge from a node inside to one outside.
  FieldRegion::Point Cross(std::size_t c0, std::size_t r0, std::size_t c1, std::size_t r1) const {
    if (!Inside(c0, r0)) return Cross(c1, r1, c0, r0);
    const ImagePoint a = At(c0, r0), b = At(c1, r1);
    double part = InRing(c1, r1) ? 1 : 0.5;
    const double inside = Value(c0, r0), outside = Value(c1, r1);
    const bool border = std::isnan(outside);
    if (!border) {
      part = logarithmic_ ? std::log(inside / level_) / std::log(inside / outside)
                          : (inside - level_) / (inside - outside);
      if (!(part >= 0 && part <= 1)) part = 0.5;
    }
    return {{a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)}, border};
  }

 private:
  const ImageField& field_;
  double level_;
  bool logarithmic_;
};

}  // namespace

FieldRegion RegionAbove(const ImageField& field, double level, bool logarithmic) {
  FieldRegion region;
  if (field.columns < 2 || field.rows < 2) return region;
  const Framed nodes(field, level, logarithmic);
  const std::size_t columns = nodes.Columns(), rows = nodes.Rows();
  // An edge between neighbours: 2 node for the one to the right, 2 node + 1 for the one below.  In
  // every cell outlines run with the inside to their left, so that each edge has one successor.
  std::map<std::size_t, std::size_t> next;
  std::map<std::size_t, FieldRegion::Point> points;
  for (std::size_t r = 0; r + 1 < rows; ++r)
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const bool corner[4] = {nodes.Inside(c, r), nodes.Inside(c + 1, r),
                              nodes.Inside(c + 1, r + 1), nodes.Inside(c, r + 1)};
      // Clockwise from the upper edge; edge i lies between corners i and i + 1.
      const std::size_t edge[4] = {2 * (r * columns + c), 2 * (r * columns + c + 1) + 1,
                                   2 * ((r + 1) * columns + c), 2 * (r * columns + c) + 1};
      const std::size_t at[4][2] = {{c, r}, {c + 1, r}, {c + 1, r + 1}, {c, r + 1}};
      std::vector<std::size_t> enters, leaves;  // going clockwise, into the inside and out of it
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        if (corner[i] == corner[j]) continue;
        (corner[j] ? enters : leaves).push_back(i);
        points.emplace(edge[i], nodes.Cross(at[i][0], at[i][1], at[j][0], at[j][1]));
      }
      if (enters.size() == 1) next[edge[leaves[0]]] = edge[enters[0]];
      // A saddle: both of the corners that are inside are cut off from each other.
      if (enters.size() == 2)
        for (const std::size_t in : enters) {
          const std::size_t out = (in + 1) % 4;
          next[edge[out]] = edge[in];
        }
    }
  while (!next.empty()) {
    std::vector<FieldRegion::Point> outline;
    std::size_t edge = next.begin()->first;
    for (auto step = next.find(edge); step != next.end(); step = next.find(edge)) {
      outline.push_back(points.at(edge));
      edge = step->second;
      next.erase(step);
    }
    region.outlines.push_back(std::move(outline));
  }
  return region;
}

std::size_t ContourLevels::RampStep(std::size_t level) const {
  return values.empty() ? 0 : level * (plot::kRampSteps - 1) / values.size();
}

ContourLevels ChooseLevels(const ImageField& field) {
  ContourLevels levels;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : field.values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (low > high) return levels;
  levels.low = low;
  levels.high = high;
  constexpr std::size_t kMost = plot::kRampSteps - 1;
  // A zero in the middle of a difference must not ask for a decade of its own.
  const double least = std::max(low, 1e-4 * high);
  levels.logarithmic = low >= 0 && least > 0 && high > 5 * least;
  if (levels.logarithmic) {
    for (const std::vector<double>& leads :
         {std::vector<double>{1, 2, 5}, std::vector<double>{1, 3}, std::vector<double>{1}}) {
      levels.values.clear();
      for (int e = static_cast<int>(std::floor(std::log10(least))); std::pow(10, e) <= high; ++e)
        for (const double lead : leads) {
          const double value = lead * std::pow(10, e);
          if (value > 1.03 * least && value < 0.97 * high) levels.values.push_back(value);
        }
      if (levels.values.size() <= kMost) break;
    }
    if (levels.values.size() > kMost)
      levels.values.erase(levels.values.begin(), levels.values.end() - kMost);
  } else if (high - low > 1e-9 * std::max(std::fabs(low), std::fabs(high))) {
    double step = plot::RoundDown((high - low) / 5);
    while ((high - low) / step > static_cast<double>(kMost)) step = plot::RoundDown(2.5 * step);
    for (double k = std::floor(low / step) + 1; k * step < high && levels.values.size() < kMost;
         ++k)
      levels.values.push_back(k * step);
  }
  for (const double value : levels.values)
    levels.labels.push_back(ReadableNumber(std::fabs(value) < 1e-12 ? 0 : value, 3));
  return levels;
}

}  // namespace graticule
