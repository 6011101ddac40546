#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// A sequence of graphs G_1 .. G_n of a team of robots: of each, the poses that are new or moved.
struct PoseSequence {
  struct Pose {
    std::uint32_t node = 0;
    PlanarPose world_from_robot;
  };

  std::uint32_t nodes = 0;           ///< numbered from 0
  std::uint32_t robots = 0;          ///< numbered from 0; each has consecutive nodes
  std::vector<Pose> poses;           ///< of all graphs, one after the other
  std::vector<std::size_t> ends{0};  ///< graph g has poses [ends[g], ends[g + 1])

  std::size_t GraphCount() const { return ends.size() - 1; }
  Span<const Pose> Graph(std::size_t g) const {
    return {poses.data() + ends[g], ends[g + 1] - ends[g]};
  }
  /// Robot r has the nodes from nodes * r / robots.
  std::uint32_t RobotOf(std::uint32_t node) const {
    return static_cast<std::uint32_t>(((std::uint64_t{node} + 1) * robots - 1) / nodes);
  }
};

/// Reads a PGSEQ file, little-endian: "PGSEQ1\0\0", int32 nodes, robots, graphs; a graph is int32
/// nodes present so far, int32 m, m x {int32 node, float32 x, y (m), yaw (rad)}.
/// Throws Error "name: byte N: ...".
PoseSequence ParsePoseSequence(std::string_view bytes, const std::string& name);

}  // namespace graticule
