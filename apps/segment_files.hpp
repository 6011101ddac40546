#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/problems/segmentation/segment_statistics.hpp"

namespace graticule::apps {

/// The scan's grid three times, one below the other: as it is (without colours: nearer is
/// brighter), in false colours, in mean colours.
ColourImage DrawSegments(const PointCloud& cloud, const std::vector<std::uint32_t>& labels,
                         const std::vector<SegmentStatistics>& segments);

/// Shades of 16 bits.  Throws Error (kOther): more than 65535 segments.
std::string FormatLabelImage(const PointCloud& cloud, const std::vector<std::uint32_t>& labels);

nlohmann::ordered_json SegmentsJson(const std::vector<SegmentStatistics>& segments);

}  // namespace graticule::apps
