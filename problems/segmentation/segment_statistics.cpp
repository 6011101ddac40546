#include "graticule/problems/segmentation/segment_statistics.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Golden-angle steps of hue, in rings of lightness.
Rgb FalseColour(std::uint32_t label) {
  if (label == 0) return {0, 0, 0};
  const double hue = std::fmod(0.61803398875 * label, 1.0) * 6;
  const double value = 0.95 - 0.15 * (label / 7 % 3), low = 0.25 * value;
  const auto channel = [&](double shift) {
    const double at = std::fmod(hue + shift, 6.0);
    const double ramp = std::fmin(std::fmax(std::fabs(at - 3) - 1, 0.0), 1.0);
    return static_cast<std::uint8_t>(std::lround(255 * (low + (value - low) * ramp)));
  };
  return {channel(0), channel(4), channel(2)};
}

}  // namespace

std::vector<SegmentStatistics> StatisticsOf(const PointCloud& cloud,
                                            const std::vector<std::uint32_t>& labels,
                                            std::size_t count,
                                            const std::vector<std::uint8_t>& is_coloured) {
  if (labels.size() != cloud.Size() || (!is_coloured.empty() && is_coloured.size() != cloud.Size()))
    throw Error("labels and cloud of different numbers of points", ErrorKind::kUsage);
  std::vector<SegmentStatistics> segments(count);
  std::vector<double> coloured(count, 0);
  const bool has_colours = cloud.colours.size() == cloud.Size() && cloud.Size() > 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) continue;
    if (labels[i] > count) throw Error("a label above the number of segments", ErrorKind::kUsage);
    SegmentStatistics& segment = segments[labels[i] - 1];
    const Eigen::Vector3d point = cloud.in_sensor[i].cast<double>();
    segment.least = segment.points == 0 ? point : segment.least.cwiseMin(point);
    segment.most = segment.points == 0 ? point : segment.most.cwiseMax(point);
    ++segment.points;
    segment.centre += point;
    if (!has_colours || (!is_coloured.empty() && is_coloured[i] == 0)) continue;
    ++coloured[labels[i] - 1];
    segment.mean_colour +=
        Eigen::Vector3d(cloud.colours[i][0], cloud.colours[i][1], cloud.colours[i][2]);
  }
  for (SegmentStatistics& segment : segments) {
    segment.label = static_cast<std::uint32_t>(&segment - segments.data() + 1);
    const double with_colour = coloured[segment.label - 1];
    segment.has_colour = with_colour > 0;
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(segment.points, 1));
    segment.centre *= share;
    if (with_colour > 0) segment.mean_colour /= with_colour;
  }
  // About the centres: nothing cancels.
  std::vector<Eigen::Matrix3d> spreads(count, Eigen::Matrix3d::Zero());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) continue;
    const Eigen::Vector3d off = cloud.in_sensor[i].cast<double>() - segments[labels[i] - 1].centre;
    spreads[labels[i] - 1] += off * off.transpose();
  }
  for (std::size_t k = 0; k < count; ++k) {
    SegmentStatistics& segment = segments[k];
    if (segment.points == 0) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        spreads[k] / static_cast<double>(segment.points));
    segment.spread = solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
    segment.normal = solver.eigenvectors().col(0);
    segment.offset_m = segment.normal.dot(segment.centre);
    if (segment.offset_m > 0) segment.normal = -segment.normal;
    segment.offset_m = std::fabs(segment.offset_m);
  }
  return segments;
}

std::vector<Rgb> FalseColours(const std::vector<std::uint32_t>& labels) {
  std::vector<Rgb> colours;
  colours.reserve(labels.size());
  for (const std::uint32_t label : labels) colours.push_back(FalseColour(label));
  return colours;
}

std::vector<Rgb> MeanColours(const std::vector<std::uint32_t>& labels,
                             const std::vector<SegmentStatistics>& segments) {
  std::vector<Rgb> colours;
  colours.reserve(labels.size());
  for (const std::uint32_t label : labels) {
    Rgb colour = {0, 0, 0};
    if (label > 0 && label <= segments.size())
      for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<std::uint8_t>(
            std::lround(segments[label - 1].mean_colour[static_cast<Eigen::Index>(c)]));
    colours.push_back(colour);
  }
  return colours;
}

}  // namespace graticule
