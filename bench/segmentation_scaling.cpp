// Time of segmentation a point, from 10^4 to 10^7 points: rows of a Markdown table, and a plot
// (docs/segmentation.md).
//
//   graticule_segmentation_scaling [PLOT.svg]
//
// Tiles of one simulated hallway; one thread, CPU time, the shortest of several frames.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "graticule/io/chart.hpp"
#include "graticule/io/file.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "segmentation_scenes.hpp"

namespace graticule {
namespace {

constexpr std::size_t kTile = 100;         // points a side
constexpr std::size_t kPoints = 20000000;  // of all frames of a size

PointCloud Tiles(const PointCloud& tile, std::size_t times) {
  PointCloud cloud;
  cloud.width = cloud.height = kTile * times;
  cloud.in_sensor.reserve(cloud.width * cloud.height);
  cloud.colours.reserve(cloud.width * cloud.height);
  for (std::size_t r = 0; r < cloud.height; ++r)
    for (std::size_t c = 0; c < cloud.width; ++c) {
      const std::size_t i = r % kTile * kTile + c % kTile;
      cloud.in_sensor.push_back(tile.in_sensor[i]);
      cloud.colours.push_back(tile.colours[i]);
    }
  return cloud;
}

// Seconds of a frame.
double TimeOf(const PointCloud& cloud, SegmentMethod method) {
  Segmenter segmenter(DefaultsOf(method));
  segmenter.Segment(cloud);  // memory is there
  const std::size_t frames = std::max<std::size_t>(3, kPoints / cloud.Size() / 4);
  double least = HUGE_VAL;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const Stopwatch watch;
    segmenter.Segment(cloud);
    least = std::min(least, watch.Elapsed().cpu);
  }
  return least;
}

int Main(const std::string& plot) {
  const PointCloud tile = Hallway(kTile, kTile);
  CurveChart chart;
  chart.title = "Time of segmentation a point";
  chart.x_label = "points";
  chart.y_label = "CPU time a point [ns]";
  chart.x_scale = AxisScale::kLogarithmic;
  chart.y_scale = AxisScale::kLinear;
  chart.curves = {{"joint", {}}, {"convex", {}}};
  // A band of no area, for the axis to begin at zero: what is flat shall look flat.
  chart.bands = {{0, {{double{kTile * kTile}, 0, 0}}}};
  fmt::print("| points | joint [ns a point] | convex |\n|---|---|---|\n");
  for (const std::size_t times : {1, 2, 3, 6, 10, 18, 32}) {
    const PointCloud cloud = Tiles(tile, times);
    const double points = static_cast<double>(cloud.Size());
    double ns[2];
    for (const int k : {0, 1}) {
      const auto method = k == 0 ? SegmentMethod::kJoint : SegmentMethod::kConvex;
      ns[k] = 1e9 * TimeOf(cloud, method) / points;
      chart.curves[static_cast<std::size_t>(k)].points.push_back({points, ns[k]});
    }
    fmt::print("| {} | {:.0f} | {:.0f} |\n", cloud.Size(), ns[0], ns[1]);
    std::fflush(stdout);
  }
  if (!plot.empty()) WriteFile(plot, DrawCurves(chart));
  return 0;
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  try {
    return graticule::Main(argc > 1 ? argv[1] : "");
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
