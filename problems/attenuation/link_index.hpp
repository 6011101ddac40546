#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <unordered_map>
#include <utility>
#include <vector>

#include "graticule/problems/attenuation/pair_kernel.hpp"

namespace graticule {

/// Finds the links nearest to a link by LinkDistance without looking at all of them: links lie in
/// square cells of their receiver's place, which are searched in rings about either end.
class LinkIndex {
 public:
  /// `slack_m`: links may move this far in x and y after they were added.
  explicit LinkIndex(double cell_m = 0.5, double slack_m = 0)
      : cell_m_(cell_m), slack_m_(slack_m) {}

  /// Adds the link numbered `number`, a number not added before.
  void Add(std::uint32_t number, const SignalLink& link);

  /// Replaces `nearest` by the `count` nearest of those added for which `is_wanted(number)`, ties
  /// by number, as (distance, number), in no order; fewer if there are fewer.  `link_of(number)` is
  /// where a link is now.
  template <class LinkOf, class IsWanted>
  void Nearest(const SignalLink& link, std::size_t count, const LinkOf& link_of,
               const IsWanted& is_wanted,
               std::vector<std::pair<double, std::uint32_t>>* nearest) const;

 private:
  using Cell = std::vector<std::uint32_t>;

  std::int64_t CellOf(double x_m) const;
  static std::uint64_t Key(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(x) << 32 ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
  }

  double cell_m_, slack_m_;
  std::unordered_map<std::uint64_t, Cell> cells_;
};

template <class LinkOf, class IsWanted>
void LinkIndex::Nearest(const SignalLink& link, std::size_t count, const LinkOf& link_of,
                        const IsWanted& is_wanted,
                        std::vector<std::pair<double, std::uint32_t>>* nearest) const {
  auto& heap = *nearest;  // the furthest of the nearest on top
  heap.clear();
  if (count == 0) return;
  // `turned`: around the other end, where only links are taken that lie nearer that way round, so
  // that none is taken twice.
  const auto look_at = [&](const Cell& cell, bool turned) {
    const Eigen::Vector3d& here = turned ? link.transmitter_m : link.receiver_m;
    const Eigen::Vector3d& there = turned ? link.receiver_m : link.transmitter_m;
    for (const std::uint32_t number : cell) {
      const SignalLink& other = link_of(number);
      double distance = (other.transmitter_m - there).norm();
      if (heap.size() == count && distance > heap.front().first) continue;
      distance += (other.receiver_m - here).norm();
      const std::pair<double, std::uint32_t> found(distance, number);
      if (heap.size() == count && !(found < heap.front())) continue;
      const double round = (other.receiver_m - there).norm() + (other.transmitter_m - here).norm();
      if ((turned ? round <= distance : round < distance) || !is_wanted(number)) continue;
      if (heap.size() == count) {
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
      }
      heap.push_back(found);
      std::push_heap(heap.begin(), heap.end());
    }
  };
  for (const bool turned : {false, true}) {
    const Eigen::Vector3d& here = turned ? link.transmitter_m : link.receiver_m;
    const std::int64_t x = CellOf(here.x()), y = CellOf(here.y());
    const auto reach = [&](std::int64_t ring) {  // nothing in it is nearer than this
      return static_cast<double>(ring - 1) * cell_m_ - slack_m_;
    };
    const auto look_in = [&](std::int64_t i, std::int64_t j) {
      const auto cell = cells_.find(Key(i, j));
      if (cell != cells_.end()) look_at(cell->second, turned);
    };
    std::int64_t ring = 0;
    const auto is_done = [&] { return heap.size() == count && reach(ring) > heap.front().first; };
    // Rings of more cells together than hold links at all: look at what is left, whole.
    const auto cells = static_cast<std::int64_t>(cells_.size());
    for (; !is_done() && (2 * ring + 1) * (2 * ring + 1) <= cells; ++ring) {
      for (std::int64_t i = x - ring; i <= x + ring; ++i)
        if (std::abs(i - x) == ring)
          for (std::int64_t j = y - ring; j <= y + ring; ++j) look_in(i, j);
        else
          for (const std::int64_t j : {y - ring, y + ring}) look_in(i, j);
    }
    if (is_done()) continue;
    for (const auto& [key, cell] : cells_) {
      const auto i = static_cast<std::int32_t>(key >> 32), j = static_cast<std::int32_t>(key);
      if (std::max(std::abs(i - x), std::abs(j - y)) >= ring) look_at(cell, turned);
    }
  }
}

}  // namespace graticule
