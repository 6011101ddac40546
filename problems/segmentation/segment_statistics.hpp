#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/io/cloud.hpp"

namespace graticule {

/// What a segment is like.
struct SegmentStatistics {
  std::uint32_t label = 0;
  std::size_t points = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< mean of the points, in the sensor [m]
  Eigen::Vector3d least = Eigen::Vector3d::Zero(), most = Eigen::Vector3d::Zero();  ///< box [m]
  /// Standard deviations along the directions of most, middle, and least spread [m].
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();
  /// The direction of least spread, towards the sensor: of a plane its normal; its distance from
  /// the sensor [m], and how far the points are off it [m, rms] is spread.z().
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset_m = 0;
  bool has_colour = false;                                ///< of one point at least
  Eigen::Vector3d mean_colour = Eigen::Vector3d::Zero();  ///< red, green, blue, 0 to 255
};

/// One entry a segment, labels 1 to `count`; points with the label 0 are left out.  `is_coloured`
/// has one entry a point, 0 where its colour says nothing (CloudColours::is_seen); empty: all
/// count. Throws Error (kUsage): lists of unequal lengths, a label above `count`.
std::vector<SegmentStatistics> StatisticsOf(const PointCloud& cloud,
                                            const std::vector<std::uint32_t>& labels,
                                            std::size_t count,
                                            const std::vector<std::uint8_t>& is_coloured = {});

/// Colours by segment (0: black): each far in hue from the next ones, the same every time; or the
/// mean colours of the segments (thesis Figures 4.4e and 4.4f).
std::vector<Rgb> FalseColours(const std::vector<std::uint32_t>& labels);
std::vector<Rgb> MeanColours(const std::vector<std::uint32_t>& labels,
                             const std::vector<SegmentStatistics>& segments);

}  // namespace graticule
