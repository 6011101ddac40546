#include "graticule/problems/mapping/likely_turns.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace graticule {
namespace {

constexpr std::size_t kBins = 120;  // of 3 degrees
constexpr double kBin = 2 * M_PI / kBins;
constexpr double kDirected = 0.3;  // of the points have a normal, or directions say nothing

using Histogram = std::array<double, kBins>;

// Each bin with half of its neighbours: where a wall falls between two, both see it.
bool Facing(Span<const SurfacePoint> points, Histogram* facing) {
  Histogram counts{};
  std::size_t directed = 0;
  for (const SurfacePoint& point : points) {
    if (point.nx == 0 && point.ny == 0) continue;
    const double angle = std::atan2(static_cast<double>(point.ny), static_cast<double>(point.nx));
    const auto bin = static_cast<std::size_t>((angle + M_PI) / kBin);
    counts[std::min(bin, kBins - 1)] += 1;
    ++directed;
  }
  for (std::size_t i = 0; i < kBins; ++i)
    (*facing)[i] = counts[i] + (counts[(i + 1) % kBins] + counts[(i + kBins - 1) % kBins]) / 2;
  return static_cast<double>(directed) >= kDirected * static_cast<double>(points.size());
}

}  // namespace

std::vector<TurnRange> LikelyTurns(Span<const SurfacePoint> reference,
                                   Span<const SurfacePoint> scan, double share) {
  const std::vector<TurnRange> all = {{0, M_PI}};
  Histogram of_reference{}, of_scan{}, agreement{};
  if (!Facing(reference, &of_reference) || !Facing(scan, &of_scan)) return all;
  for (std::size_t turn = 0; turn < kBins; ++turn)
    for (std::size_t i = 0; i < kBins; ++i)
      agreement[turn] += of_reference[(i + turn) % kBins] * of_scan[i];
  const double least = share * *std::max_element(agreement.begin(), agreement.end());
  const auto is_likely = [&](std::size_t turn) { return agreement[turn % kBins] >= least; };
  std::size_t begin = 0;  // behind a bin that is not likely
  while (begin < kBins && is_likely(begin)) ++begin;
  if (begin == kBins) return all;
  std::vector<TurnRange> ranges;
  for (std::size_t i = begin; i < begin + kBins; ++i) {
    if (!is_likely(i)) continue;
    std::size_t end = i;
    while (is_likely(end + 1)) ++end;
    ranges.push_back({std::remainder(kBin * static_cast<double>(i + end) / 2, 2 * M_PI),
                      kBin * (static_cast<double>(end - i) + 1) / 2});
    i = end;
  }
  return ranges;
}

}  // namespace graticule
