#pragma once

#include <cstdint>
#include <vector>

namespace graticule {

/// How well a segmentation finds labelled objects; every share is from 0 to 1.
struct SegmentScore {
  double weighted_overlap = 0;  ///< of the best segment (intersection over union), by objects' size
  double achievable = 0;        ///< points right if each segment had its best label
  double under_segmentation = 0;  ///< points that spill over objects' borders: min(in, out) of each
                                  ///< segment that an object meets, by all points
  double boundary_recall = 0;     ///< borders between labels that a border of segments is near
  double mean_f = 0;              ///< of objects, each by its best segment
  double found = 0;               ///< share of objects with an overlap above one half
  std::size_t objects = 0;        ///< labelled things that count for mean_f and found
  std::size_t segments = 0;       ///< that labelled points are in
};

struct ScoreOptions {
  std::uint32_t least_object = 1;  ///< smaller labels are background: not counted as objects
  std::size_t width = 0;  ///< of the grid, for boundary_recall; 0: not organised, and left at 0
  std::size_t border_points = 2;  ///< this near, in rows and columns
};

/// Holds segments against labels, over the points with a label that is not zero.
///
/// Weighted overlap as in Hoiem et al. 2011; achievable accuracy, under-segmentation error and
/// boundary recall as in Neubert and Protzel 2012.  A point without a segment (0) is a segment of
/// its own, which `segments` does not count.  Throws Error (kUsage): lists of unequal lengths.
SegmentScore ScoreOf(const std::vector<std::uint32_t>& labels,
                     const std::vector<std::uint32_t>& segments, const ScoreOptions& options = {});

/// Of several scans: means over scans; mean_f and found over all of their objects; objects and
/// segments of all together.
SegmentScore MeanOf(const std::vector<SegmentScore>& scores);

}  // namespace graticule
