#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace graticule {

/// Which readings count, and how far.
struct RangeUse {
  /// m; a longer beam passes what lies nearer, and hits nothing.
  double max_range = 25;
  /// Whether a beam that did not return passes the cells up to max_range.  Off: dark and slanting
  /// surfaces and glass do not return either, and would be cleared away.
  bool clear_no_return = false;
};

/// How a cell's hits and passes become a label (thesis section 2.5): every scan that ends a beam in
/// the cell, or passes it, is a vote of fixed log odds, as integers.
///   score = hit_votes * hits - pass_votes * passes + bias
/// structure where score >= structure_from; free where the cell was seen and score <= free_to;
/// unknown elsewhere.
struct VoteRule {
  int hit_votes = 3;   ///< 1 .. 15
  int pass_votes = 1;  ///< 1 .. 15
  /// The designer's bias: above 0 resists misalignment (walls stay), below 0 clears doorways
  /// sooner.
  int bias = 0;
  int structure_from = 1;
  int free_to = 0;  ///< below structure_from
  /// Hits, and passes, beyond this many of a cell are not counted when it is labelled; the counts
  /// themselves stay exact.  2^n - 1; 0: no limit.
  int saturation = 0;
};

/// Which nodes' scans the map is made of (thesis section 2.4).
struct CoverOptions {
  bool on = true;
  /// The dial.  A node is left out if no more than this share of the cells that it sees are news:
  /// have been seen by fewer than `views` nodes of the cover.  0: what adds a cell stays.
  double news = 0.004;
  /// That each cell is to be seen by, 1 .. 7: transients are voted out by several views.
  int views = 2;
  /// Whether what other robots have seen counts too, which goes beyond Algorithm 2.1.
  bool across_robots = false;
};

/// How a map is made from the graph's nodes.  All draw, vote and label alike (thesis Table 2.1).
enum class MapMethod {
  kNaive,           ///< all nodes, at every update
  kNaiveCover,      ///< the cover's nodes, at every update
  kCoverComposite,  ///< Algorithm 2.1: slices drawn when they moved, all composited at every update
  kIncremental,     ///< slices that moved are taken out of the map and put back in: nothing else
};

/// "naive", "naive-cover", "cover-composite", "incremental".
const std::vector<std::pair<std::string, MapMethod>>& MapMethodNames();
/// Throws Error (kUsage): none of these names.
MapMethod MapMethodOf(std::string_view name);

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

/// Throws Error (kUsage): an option out of range.
void CheckLiveMapOptions(const LiveMapOptions& options);
void CheckVoteRule(const VoteRule& rule);

}  // namespace graticule
