#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/live_map_options.hpp"
#include "graticule/problems/mapping/occupancy_map.hpp"
#include "graticule/problems/mapping/vote_grid.hpp"
#include "graticule/solver/values.hpp"

namespace graticule {

using NodeId = std::uint32_t;

/// A slice that Update had no time for: the map still has it where it was drawn last.
struct StaleSlice {
  std::size_t slice = 0;
  std::uint32_t robot = 0;
  NodeId first = 0, last = 0;  ///< its nodes; others may lie between
  double error = 0;            ///< cells: no beam of its is farther off
};

/// What an update did.
struct MapUpdate {
  double seconds = 0;  ///< wall time
  std::uint64_t version = 0;
  std::size_t nodes = 0;  ///< added so far
  std::size_t cover = 0;  ///< of these, in the cover
  std::size_t slices = 0;
  std::size_t regenerated_slices = 0, regenerated_nodes = 0;  ///< drawn anew, new nodes not counted
  std::vector<StaleSlice> left_over;  ///< the deadline came first: finished by later updates
  std::vector<NodeId> waiting;        ///< nodes that are not in the map yet, for the same reason
  MapChange change;
};

/// The occupancy map of a team of robots, kept up to date as their pose graph grows and its poses
/// move: COVER_COMPOSITE of the thesis (chapter 2, Algorithm 2.1), and the methods that it is
/// compared with.
///
/// One thread adds and updates.  Any thread may ask for Map() at any time.  With kIncremental the
/// map equals, cell for cell, the one that is made from scratch from the poses that each slice was
/// drawn with last.
class LiveMap {
 public:
  /// Throws Error (kUsage): an option out of range.
  explicit LiveMap(const LiveMapOptions& options = {});
  ~LiveMap();
  LiveMap(const LiveMap&) = delete;
  LiveMap& operator=(const LiveMap&) = delete;

  /// A new pose of a robot (any numbers) with the scan taken there.  Nodes are numbered from 0.
  /// Readings that are no range say nothing (ScanReader).  Throws Error: no readings, or a pose
  /// or geometry that is not finite or too far away.
  NodeId AddNode(std::uint32_t robot, const LaserGeometry& geometry, Span<const float> ranges,
                 const PlanarPose& world_from_robot);

  /// The graph was solved: where nodes are now.  Throws Error, and has then changed nothing: an
  /// unknown node, a pose that is not finite or too far away.
  void UpdatePose(NodeId node, const PlanarPose& world_from_robot);
  /// Of all nodes, in their order.
  void UpdatePoses(Span<const PlanarPose> world_from_robot);
  /// The same from a graph's values: keys[i] is node i's pose (se2/1).  Also throws Error: an
  /// unknown key, or one that is not three numbers.
  void UpdatePoses(const Values& values, const std::vector<Key>& keys);

  /// Brings the map up to date, and publishes it.  kIncremental stops in time for a deadline
  /// (seconds, wall time) where one is given; slices that are left over come first the next time.
  /// One slice or node is done in any case, so that a deadline that is too short ends some time.
  MapUpdate Update(double deadline = std::numeric_limits<double>::infinity());

  /// The same without a deadline, and draws every slice anew that has moved at all: the map is then
  /// that of the cover's nodes where they are.
  MapUpdate UpdateExactly();

  /// The map of the last update.  Thread-safe: waits for nothing but the copy of a pointer.
  std::shared_ptr<const OccupancyMap> Map() const;

  std::size_t NodeCount() const;
  /// The nodes in the cover, in the order in which they joined it.
  const std::vector<NodeId>& Cover() const;
  /// The pose that a node of the cover is in the map with.  Throws Error: not in the cover.
  const PlanarPose& DrawnPose(NodeId node) const;

 private:
  class Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace graticule
