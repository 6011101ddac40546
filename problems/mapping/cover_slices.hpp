#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "graticule/problems/mapping/dense_slice.hpp"

namespace graticule {

/// Sequential nodes of a robot's cover, which are drawn anew together (thesis section 2.3).
struct CoverSlice {
  std::uint32_t robot = 0;
  std::vector<std::uint32_t> nodes;
  bool waited = false;   ///< a deadline came before it
  bool watched = false;  ///< is to be looked at
  DenseSlice dense;      ///< of kCoverComposite
};

/// The covers of all robots, in slices, and which of these are to be looked at: nodes of theirs
/// have moved, or they wait.
class CoverSlices {
 public:
  /// Of so many nodes each.
  explicit CoverSlices(std::size_t size) : size_(size) {}

  std::size_t Count() const { return slices_.size(); }
  CoverSlice& operator[](std::size_t slice) { return slices_[slice]; }
  const CoverSlice& operator[](std::size_t slice) const { return slices_[slice]; }
  /// In the order in which they joined.
  const std::vector<std::uint32_t>& Nodes() const { return nodes_; }

  /// A node joins the cover of its robot.  The slice that it is in.
  std::size_t Join(std::uint32_t robot, std::uint32_t node) {
    const auto [open, first] = open_.emplace(robot, slices_.size());
    if (first || slices_[open->second].nodes.size() >= size_) {
      open->second = slices_.size();
      slices_.emplace_back();
      slices_.back().robot = robot;
    }
    slices_[open->second].nodes.push_back(node);
    nodes_.push_back(node);
    return open->second;
  }

  void Watch(std::size_t slice) {
    if (slices_[slice].watched) return;
    slices_[slice].watched = true;
    watched_.push_back(slice);
  }
  /// Those that were to be looked at.
  std::vector<std::size_t> TakeWatched() {
    std::vector<std::size_t> watched;
    watched.swap(watched_);
    for (const std::size_t slice : watched) slices_[slice].watched = false;
    return watched;
  }

 private:
  std::size_t size_;
  std::vector<CoverSlice> slices_;
  std::map<std::uint32_t, std::size_t> open_;  // the last slice of a robot
  std::vector<std::uint32_t> nodes_;
  std::vector<std::size_t> watched_;
};

}  // namespace graticule
