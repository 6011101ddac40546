#include "segment_files.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

// Adds a grid to the picture, each of its rows `times` times.
void Append(const std::vector<Rgb>& colours, std::size_t times, ColourImage* image) {
  for (std::size_t first = 0; first < colours.size(); first += image->width)
    for (std::size_t k = 0; k < times; ++k)
      for (std::size_t c = 0; c < image->width; ++c)
        image->rgb.insert(image->rgb.end(), colours[first + c].begin(), colours[first + c].end());
}

// Nearer is brighter, from the 2nd to the 98th percentile.
std::vector<Rgb> DepthShades(const PointCloud& cloud) {
  std::vector<float> ranges, sorted;
  for (const Eigen::Vector3f& point : cloud.in_sensor) {
    ranges.push_back(point.norm());
    if (std::isfinite(ranges.back())) sorted.push_back(ranges.back());
  }
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](std::size_t percent) { return sorted[sorted.size() * percent / 100]; };
  const float near = sorted.empty() ? 0 : at(2), far = sorted.empty() ? 1 : at(98);
  std::vector<Rgb> shades;
  for (const float range : ranges) {
    std::uint8_t shade = 0;
    if (std::isfinite(range)) {
      const float share = std::clamp((range - near) / std::max(far - near, 1e-6f), 0.0f, 1.0f);
      shade = static_cast<std::uint8_t>(std::lround(250 - 210 * share));
    }
    shades.push_back({shade, shade, shade});
  }
  return shades;
}

nlohmann::ordered_json Triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

ColourImage DrawSegments(const PointCloud& cloud, const std::vector<std::uint32_t>& labels,
                         const std::vector<SegmentStatistics>& segments) {
  const bool has_colours = !cloud.colours.empty();
  ColourImage image;
  image.width = cloud.width;
  // The few beams of a LIDAR that turns are drawn higher.
  const std::size_t times = std::max<std::size_t>(1, cloud.width / (4 * cloud.height));
  Append(has_colours ? cloud.colours : DepthShades(cloud), times, &image);
  Append(FalseColours(labels), times, &image);
  if (has_colours) Append(MeanColours(labels, segments), times, &image);
  image.height = image.rgb.size() / 3 / image.width;
  return image;
}

std::string FormatLabelImage(const PointCloud& cloud, const std::vector<std::uint32_t>& labels) {
  std::vector<std::uint16_t> shades;
  shades.reserve(labels.size());
  for (const std::uint32_t label : labels) {
    if (label > 65535)
      throw Error("more segments than a picture of 16 bits has shades", ErrorKind::kOther);
    shades.push_back(static_cast<std::uint16_t>(label));
  }
  return FormatPng16(shades, cloud.width);
}

nlohmann::ordered_json SegmentsJson(const std::vector<SegmentStatistics>& segments) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SegmentStatistics& segment : segments) {
    nlohmann::ordered_json entry = {{"label", segment.label},
                                    {"points", segment.points},
                                    {"centre_m", Triple(segment.centre)},
                                    {"box_m", {Triple(segment.least), Triple(segment.most)}},
                                    {"spread_m", Triple(segment.spread)},
                                    {"plane",
                                     {{"normal", Triple(segment.normal)},
                                      {"offset_m", segment.offset_m},
                                      {"rms_m", segment.spread.z()}}}};
    if (segment.has_colour) entry["mean_colour"] = Triple(segment.mean_colour);
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace graticule::apps
