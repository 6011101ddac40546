#pragma once

#include <algorithm>
#include <cstddef>

namespace graticule {

/// What an update's steps have taken lately, to tell before a step whether it will be done in time.
class WorkEstimate {
 public:
  void Drew(std::size_t nodes, double seconds, std::size_t dirty_tiles) {
    if (nodes == 0) return;
    const auto count = static_cast<double>(nodes);
    Learn(seconds / count, &draw_);
    Learn(static_cast<double>(dirty_tiles) / count, &dirty_);
  }
  void Took(double seconds, std::size_t dirty_tiles) {
    Learn(seconds, &take_);
    Learn(static_cast<double>(dirty_tiles), &dirty_);
  }
  void Published(double seconds, std::size_t dirty_tiles) {
    // Of few tiles the fixed part would be taken for theirs.
    if (dirty_tiles >= 64) Learn(seconds / static_cast<double>(dirty_tiles), &publish_);
  }

  /// Whether `draw` nodes can be drawn anew, then `take` new ones taken in, `name` nodes that are
  /// left over named, and all published.
  bool Fits(double elapsed, double deadline, std::size_t draw, std::size_t take, std::size_t name,
            std::size_t dirty_tiles) const {
    const auto drawn = static_cast<double>(draw), taken = static_cast<double>(take);
    const double left = drawn * draw_ + taken * take_ + static_cast<double>(name) * kName +
                        publish_ * (static_cast<double>(dirty_tiles) + (drawn + taken) * dirty_);
    return elapsed + kCaution * (left + kFixed) <= kUsable * deadline;
  }
  bool FitsNew(double elapsed, double deadline, std::size_t dirty_tiles) const {
    return Fits(elapsed, deadline, 0, 1, 0, dirty_tiles);
  }

 private:
  static constexpr double kCaution = 1.5;
  static constexpr double kUsable = 0.9;
  static constexpr double kName = 0.1e-6;  // s a node
  static constexpr double kFixed = 50e-6;  // s: to copy the directory of pages and the report
  // Follows what is slower quickly, and what is quicker slowly; but one step that was interrupted
  // says little about the next.
  static void Learn(double value, double* average) {
    value = std::min(value, 2 * *average);
    *average = value > *average ? 0.5 * (value + *average) : 0.9 * *average + 0.1 * value;
  }

  // s a node drawn anew, a new node, a dirty tile; dirty tiles a node.
  double draw_ = 20e-6, take_ = 30e-6, publish_ = 0.2e-6, dirty_ = 10;
};

}  // namespace graticule
