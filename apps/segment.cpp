#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/io/segment_report.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/segment_statistics.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "outputs.hpp"
#include "problem.hpp"
#include "segment_choosing.hpp"
#include "segment_files.hpp"

namespace graticule::apps {
namespace {

// Every so many rows and columns (thesis section 4.2: finer scans are noisier normals).
PointCloud Thinned(const PointCloud& cloud, std::size_t stride) {
  if (stride == 1) return cloud;
  PointCloud thin;
  thin.is_spinning = cloud.is_spinning;
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
  if (!command.report.empty()) ExpectEnding(command.report, "--report", {".html"});
  for (const std::string& path :
       {command.output, command.picture, command.label_image, command.report})
    ExpectWritable(path);
}

std::string Places(const Eigen::Vector3d& v) {
  return fmt::format("{:.2f} {:.2f} {:.2f}", v.x(), v.y(), v.z());
}

SegmentReport ReportOf(const SegmentCommand& command, const SegmentOptions& options,
                       const PointCloud& cloud, const ColourImage& picture,
                       const std::vector<SegmentStatistics>& segments, double seconds) {
  SegmentReport report;
  report.title = fmt::format("{} in {} segments", command.cloud, segments.size());
  report.facts = {{"scan", fmt::format("{} x {}{}", cloud.width, cloud.height,
                                       cloud.is_spinning ? ", all around" : "")},
                  {"method", command.method},
                  {"time", Seconds(seconds)}};
  const auto fact = [&](const char* name, double number) {
    report.facts.emplace_back(name, fmt::format("{:.4g}", number));
  };
  for (const SegmentParameter& parameter : ParametersOf(options.method))
    fact(parameter.label, parameter.value(options));
  report.pictures.push_back(
      {cloud.colours.empty() ? "The scan (nearer is brighter), and its segments in false colours"
                             : "The scan, its segments in false colours, and in mean colours",
       FormatPng(picture), picture.width, picture.height});
  for (const SegmentStatistics& segment : segments) {
    SegmentReport::Segment row;
    row.label = segment.label;
    row.points = segment.points;
    row.centre = Places(segment.centre);
    row.extent = Places(segment.most - segment.least);
    row.off_plane_m = segment.spread.z();
    if (segment.has_colour)
      row.mean_colour =
          fmt::format("#{:02x}{:02x}{:02x}", std::lround(segment.mean_colour.x()),
                      std::lround(segment.mean_colour.y()), std::lround(segment.mean_colour.z()));
    report.segments.push_back(std::move(row));
  }
  return report;
}

SegmentScore ScoreAgainstOwn(const SegmentCommand& command, const PointCloud& cloud,
                             const std::vector<std::uint32_t>& segments) {
  if (cloud.labels.empty())
    throw Error(command.cloud + ": has no labels to score against (--score-from)");
  ScoreOptions options;
  options.least_object = static_cast<std::uint32_t>(command.score_from);
  options.width = cloud.width;
  // What has no point, as it is outside of the picture, was not to be segmented.
  std::vector<std::uint32_t> labels = cloud.labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (!cloud.in_sensor[i].allFinite()) labels[i] = 0;
  return ScoreOf(labels, segments, options);
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
    fmt::print("{:>7} {:>9}  {:<24} {:<20} {:.3f}\n", s->label, s->points, Places(s->centre),
               Places(extent), s->spread.z());
  }
  if (by_size.size() < segments.size())
    fmt::print("... and {} smaller ones\n", segments.size() - by_size.size());
}

}  // namespace

int Run(const SegmentCommand& command, const Console& console) {
  if (command.cloud.empty())
    throw Error("expected a cloud, or evaluate and clouds with labels", ErrorKind::kUsage);
  CheckWords(command);
  PointCloud cloud = Thinned(ReadCloud(command.cloud), static_cast<std::size_t>(command.stride));
  CloudColours colours;
  if (!command.image.empty()) cloud = ColouredByImage(command, cloud, &colours);
  const SegmentOptions options =
      OptionsOf(SegmentMethodOf(command.method), command.choosing, cloud);
  Segmenter segmenter(options);
  std::vector<std::uint32_t> labels;
  const Stopwatch watch;
  About(command.cloud, [&] { return labels = segmenter.Segment(cloud), 0; });
  const double seconds = watch.Elapsed().wall;
  const auto segments = StatisticsOf(cloud, labels, segmenter.SegmentCount(), colours.is_seen);
  Outputs outputs(console);
  if (!command.picture.empty() || !command.report.empty()) {
    const ColourImage picture = DrawSegments(cloud, labels, segments);
    outputs.Try(command.picture, [&] { WriteFile(command.picture, FormatPng(picture)); });
    outputs.Try(command.report, [&] {
      WriteFile(command.report,
                SegmentReportHtml(ReportOf(command, options, cloud, picture, segments, seconds)));
    });
  }
  outputs.Try(command.label_image,
              [&] { WriteFile(command.label_image, FormatLabelImage(cloud, labels)); });
  outputs.Try(command.output, [&] {
    PointCloud out = cloud;
    out.labels = labels;
    if (command.colours == "false") out.colours = FalseColours(labels);
    if (command.colours == "mean" && !cloud.colours.empty())
      out.colours = MeanColours(labels, segments);
    WriteCloud(command.output, out);
  });
  std::size_t points = 0;
  for (const std::uint32_t label : labels) points += label > 0;
  std::optional<SegmentScore> score;
  if (command.score_from > 0) score = ScoreAgainstOwn(command, cloud, labels);
  if (command.json) {
    nlohmann::ordered_json out = {{"cloud", command.cloud},
                                  {"method", command.method},
                                  {"grid", {cloud.width, cloud.height}},
                                  {"points", points},
                                  {"seconds", seconds}};
    if (!command.image.empty())
      out["colours"] = {
          {"seen", colours.seen}, {"hidden", colours.hidden}, {"outside", colours.outside}};
    if (score)
      out["score"] = {{"weighted_overlap", score->weighted_overlap},
                      {"achievable", score->achievable},
                      {"under_segmentation", score->under_segmentation},
                      {"objects", score->objects},
                      {"mean_f", score->mean_f},
                      {"found", score->found}};
    out["segments"] = SegmentsJson(segments);
    fmt::print("{}\n", JsonText(out, 2));
    return outputs.Failure();
  }
  fmt::print("{}: {} x {} points, {} in {} segments ({}, {})\n", command.cloud, cloud.width,
             cloud.height, points, segments.size(), command.method, Seconds(seconds));
  if (!command.image.empty())
    fmt::print(
        "{} points have a colour, {} are hidden from the camera, {} outside of its picture\n",
        colours.seen, colours.hidden, colours.outside);
  if (score)
    fmt::print(
        "against its own labels: weighted overlap {:.3f} (achievable {:.3f}), under-segmentation "
        "{:.3f}; of {} things F {:.3f}, {:.0f} % found\n",
        score->weighted_overlap, score->achievable, score->under_segmentation, score->objects,
        score->mean_f, 100 * score->found);
  PrintLargest(segments);
  if (segments.empty()) console.Note("no segment: no two points are linked");
  return outputs.Failure();
}

}  // namespace graticule::apps
