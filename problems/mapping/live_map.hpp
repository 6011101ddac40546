#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "graticule/io/laser_log.hpp"
#include "graticule/problems/mapping/cover.hpp"
#include "graticule/problems/mapping/occupancy_map.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/vote_grid.hpp"
#include "graticule/problems/mapping/votes.hpp"

namespace graticule {

/// How a map is made from the graph's nodes.  All draw, vote and label alike (thesis Table 2.1).
enum class MapMethod {
  kNaive,           ///< all nodes, at every update
  kNaiveCover,      ///< the cover's nodes, at every update
  kCoverComposite,  ///< Algorithm 2.1: slices drawn when they moved, all composited at every update
  kIncremental,     ///< slices that moved are taken out of the map and put back in: nothing else
};

struct LiveMapOptions {
  MapMethod method = MapMethod::kIncremental;
  double resolution = 0.1;  ///< m, a cell's side
  RangeUse ranges;
  /// Sequential nodes of a robot that are drawn anew together (section 2.3).
  std::size_t slice_size = 4;
  /// Cells.  A slice is drawn anew when the end of one of its beams, or its laser, is farther than
  /// this from where it was when the slice was drawn last.
  double regenerate_above = 1;
  CoverOptions cover;
  VoteRule votes;
  /// That draw slices, kIncremental only.  The map is the same for any number.
  int threads = 1;
};

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

  /// Brings the map up to date, and publishes it.  kIncremental stops in time for a deadline
  /// (seconds, wall time) where one is given; slices that are left over come first the next time.
  /// One slice or node is done in any case, so that a deadline that is too short ends some time.
  MapUpdate Update(double deadline = std::numeric_limits<double>::infinity());

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
