#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segment_statistics.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "problem.hpp"
#include "segment_files.hpp"

namespace graticule::apps {
namespace {

constexpr double kDegree = M_PI / 180;

SegmentOptions OptionsOf(const SegmentCommand& command) {
  SegmentOptions options = DefaultsOf(SegmentMethodOf(command.method));
  // A LIDAR that turns sees the ground far ahead, flatly, and its beams are far apart there.
  const std::string& name = command.cloud;
  const bool is_spinning = name.size() > 4 && name.compare(name.size() - 4, 4, ".bin") == 0;
  if (is_spinning) options.mesh = {2, 2 * kDegree, true};
  options.mesh.is_closed |= command.is_closed;
  if (command.edge_cut_m >= 0) options.mesh.edge_cut_m = command.edge_cut_m;
  if (command.grazing_deg >= 0) options.mesh.grazing_rad = command.grazing_deg * kDegree;
  if (command.normal_radius >= 0) options.normal_radius = command.normal_radius;
  if (command.k_colour >= 0) options.graph.k_colour = command.k_colour;
  if (command.k_normal >= 0) options.graph.k_normal = command.k_normal;
  if (command.concave_deg >= 0) options.convex.concave_angle_rad = command.concave_deg * kDegree;
  if (command.min_size >= 0)
    options.graph.min_size = options.convex.min_size = static_cast<std::size_t>(command.min_size);
  return options;
}

// Every so many rows and columns (thesis section 4.2: finer scans are noisier normals).
PointCloud Thinned(const PointCloud& cloud, std::size_t stride) {
  if (stride == 1) return cloud;
  PointCloud thin;
  thin.width = (cloud.width + stride - 1) / stride;
  thin.height = (cloud.height + stride - 1) / stride;
  const auto take = [&](const auto& from, auto* to) {
    for (std::size_t r = 0; r < cloud.height && !from.empty(); r += stride)
      for (std::size_t c = 0; c < cloud.width; c += stride)
        to->push_back(from[r * cloud.width + c]);
  };
  take(cloud.in_sensor, &thin.in_sensor);
  take(cloud.colours, &thin.colours);
  take(cloud.intensities, &thin.intensities);
  take(cloud.labels, &thin.labels);
  return thin;
}

PointCloud ColouredByImage(const SegmentCommand& command, const PointCloud& cloud,
                           CloudColours* colours) {
  LidarRig rig = ReadRig(command.rig);
  const ColourImage image = ReadColourPhoto(command.image);
  if (rig.camera.width == 0 && rig.camera.height == 0) {
    rig.camera.width = static_cast<int>(image.width);
    rig.camera.height = static_cast<int>(image.height);
  }
  *colours = ColoursOf(cloud, image, Camera(rig.camera), rig.camera_from_lidar);
  if (colours->seen == 0)
    throw Error(command.image + ": shows none of the cloud's points: is " + command.rig +
                    " of this camera and LIDAR?",
                ErrorKind::kInput);
  return Coloured(cloud, *colours, command.keep_unseen);
}

void CheckWords(const SegmentCommand& command) {
  if (command.image.empty() != command.rig.empty())
    throw Error("--image and --rig go together", ErrorKind::kUsage);
  if (!command.output.empty()) ExpectEnding(command.output, "--output", {".ply", ".pcd"});
  if (!command.picture.empty()) ExpectEnding(command.picture, "--picture", {".png"});
  if (!command.label_image.empty()) ExpectEnding(command.label_image, "--label-image", {".png"});
}

void PrintLargest(const std::vector<SegmentStatistics>& segments) {
  std::vector<const SegmentStatistics*> by_size;
  for (const SegmentStatistics& segment : segments) by_size.push_back(&segment);
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto* a, const auto* b) { return a->points > b->points; });
  if (by_size.size() > 10) by_size.resize(10);
  fmt::print("{:>7} {:>9}  {:<24} {:<20} {}\n", "segment", "points", "centre [m]", "extent [m]",
             "off its plane [m]");
  for (const SegmentStatistics* s : by_size) {
    const Eigen::Vector3d extent = s->most - s->least;
    fmt::print("{:>7} {:>9}  {:<24} {:<20} {:.3f}\n", s->label, s->points,
               fmt::format("{:.2f} {:.2f} {:.2f}", s->centre.x(), s->centre.y(), s->centre.z()),
               fmt::format("{:.2f} {:.2f} {:.2f}", extent.x(), extent.y(), extent.z()),
               s->spread.z());
  }
  if (by_size.size() < segments.size())
    fmt::print("... and {} smaller ones\n", segments.size() - by_size.size());
}

}  // namespace

int Run(const SegmentCommand& command, const Console& console) {
  CheckWords(command);
  PointCloud cloud = Thinned(ReadCloud(command.cloud), static_cast<std::size_t>(command.stride));
  CloudColours colours;
  if (!command.image.empty()) cloud = ColouredByImage(command, cloud, &colours);
  Segmenter segmenter(OptionsOf(command));
  std::vector<std::uint32_t> labels;
  const Stopwatch watch;
  try {
    labels = segmenter.Segment(cloud);
  } catch (const Error& error) {
    throw Error(command.cloud + ": " + error.what(), error.Kind());
  }
  const double seconds = watch.Elapsed().wall;
  const auto segments = StatisticsOf(cloud, labels, segmenter.SegmentCount());
  if (!command.picture.empty())
    WriteFile(command.picture, FormatSegmentPicture(cloud, labels, segments));
  if (!command.label_image.empty()) WriteFile(command.label_image, FormatLabelImage(cloud, labels));
  if (!command.output.empty()) {
    PointCloud out = cloud;
    out.labels = labels;
    if (command.colours == "false") out.colours = FalseColours(labels);
    if (command.colours == "mean" && !cloud.colours.empty())
      out.colours = MeanColours(labels, segments);
    WriteCloud(command.output, out);
  }
  std::size_t points = 0;
  for (const std::uint32_t label : labels) points += label > 0;
  if (command.json) {
    nlohmann::ordered_json out = {{"cloud", command.cloud},
                                  {"method", command.method},
                                  {"grid", {cloud.width, cloud.height}},
                                  {"points", points},
                                  {"seconds", seconds}};
    if (!command.image.empty())
      out["colours"] = {
          {"seen", colours.seen}, {"hidden", colours.hidden}, {"outside", colours.outside}};
    out["segments"] = SegmentsJson(segments);
    fmt::print("{}\n", out.dump(2));
    return kDone;
  }
  fmt::print("{}: {} x {} points, {} in {} segments ({}, {})\n", command.cloud, cloud.width,
             cloud.height, points, segments.size(), command.method, Seconds(seconds));
  if (!command.image.empty())
    fmt::print(
        "{} points have a colour, {} are hidden from the camera, {} outside of its picture\n",
        colours.seen, colours.hidden, colours.outside);
  PrintLargest(segments);
  if (segments.empty()) console.Note("no segment: no two points are linked");
  return kDone;
}

}  // namespace graticule::apps
