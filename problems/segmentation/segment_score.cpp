#include "graticule/problems/segmentation/segment_score.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Whether two neighbours in the grid, to the right and below, bear different names.
bool IsBorder(const std::vector<std::uint32_t>& names, std::size_t i, std::size_t width) {
  const bool is_last = (i + 1) % width == 0;
  return (!is_last && names[i + 1] != names[i]) ||
         (i + width < names.size() && names[i + width] != names[i]);
}

double BoundaryRecall(const std::vector<std::uint32_t>& labels,
                      const std::vector<std::uint32_t>& segments, const ScoreOptions& options) {
  const std::size_t width = options.width, height = labels.size() / width;
  const std::size_t reach = options.border_points;
  std::size_t borders = 0, met = 0;
  for (std::size_t row = 0; row < height; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t i = row * width + column;
      if (!IsBorder(labels, i, width)) continue;
      ++borders;
      bool is_met = false;
      for (std::size_t r = row - std::min(row, reach); r <= row + reach && r < height; ++r)
        for (std::size_t c = column - std::min(column, reach); c <= column + reach && c < width;
             ++c)
          is_met |= IsBorder(segments, r * width + c, width);
      met += is_met;
    }
  return borders == 0 ? 1 : static_cast<double>(met) / static_cast<double>(borders);
}

}  // namespace

SegmentScore ScoreOf(const std::vector<std::uint32_t>& labels,
                     const std::vector<std::uint32_t>& segments, const ScoreOptions& options) {
  if (labels.size() != segments.size())
    throw Error("labels and segments of different numbers of points", ErrorKind::kUsage);
  // Numbers of points: of a label, of a segment, of both.
  std::map<std::uint32_t, double> in_label, in_segment, alone;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> in_both;
  double all = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) continue;
    ++all;
    ++in_label[labels[i]];
    if (segments[i] == 0) {
      ++alone[labels[i]];
      continue;
    }
    ++in_segment[segments[i]];
    ++in_both[{segments[i], labels[i]}];
  }
  SegmentScore score;
  score.segments = in_segment.size();
  if (all == 0) return score;
  std::map<std::uint32_t, double> overlap, f, best;  // the first two by label, the last by segment
  for (const auto& [which, count] : in_both) {
    const auto& [segment, label] = which;
    const double both = in_label[label] + in_segment[segment];
    overlap[label] = std::max(overlap[label], count / (both - count));
    f[label] = std::max(f[label], 2 * count / both);
    best[segment] = std::max(best[segment], count);
    score.under_segmentation += std::min(count, in_segment[segment] - count) / all;
  }
  for (const auto& [label, count] : alone) {
    overlap[label] = std::max(overlap[label], 1 / in_label[label]);
    f[label] = std::max(f[label], 2 / (in_label[label] + 1));
    score.achievable += count / all;
  }
  for (const auto& [segment, count] : best) score.achievable += count / all;
  for (const auto& [label, count] : in_label) {
    score.weighted_overlap += overlap[label] * count / all;
    if (label < options.least_object) continue;
    ++score.objects;
    score.mean_f += f[label];
    score.found += overlap[label] > 0.5;
  }
  if (score.objects > 0) {
    score.mean_f /= static_cast<double>(score.objects);
    score.found /= static_cast<double>(score.objects);
  }
  if (options.width > 0) score.boundary_recall = BoundaryRecall(labels, segments, options);
  return score;
}

SegmentScore MeanOf(const std::vector<SegmentScore>& scores) {
  SegmentScore mean;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(scores.size(), 1));
  for (const SegmentScore& score : scores) {
    mean.weighted_overlap += share * score.weighted_overlap;
    mean.achievable += share * score.achievable;
    mean.under_segmentation += share * score.under_segmentation;
    mean.boundary_recall += share * score.boundary_recall;
    mean.mean_f += score.mean_f * static_cast<double>(score.objects);
    mean.found += score.found * static_cast<double>(score.objects);
    mean.objects += score.objects;
    mean.segments += score.segments;
  }
  const double objects = static_cast<double>(std::max<std::size_t>(mean.objects, 1));
  mean.mean_f /= objects;
  mean.found /= objects;
  return mean;
}

}  // namespace graticule
