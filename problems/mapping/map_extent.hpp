#pragma once

#include <cstddef>

#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// The box that all scans of a map are in, which bounds how far the map has to grow.
class MapExtent {
 public:
  explicit MapExtent(double resolution) : resolution_(resolution) {}

  /// A node that sees as far as `reach` m is at a pose.  Throws Error, and has then changed
  /// nothing: the pose is not finite, or the map would have more cells than it can.
  void Include(std::size_t node, const PlanarPose& world_from_robot, double reach);

 private:
  double resolution_;
  double left_ = 0, right_ = 0, bottom_ = 0, top_ = 0;  // m
  bool any_ = false;
};

}  // namespace graticule
