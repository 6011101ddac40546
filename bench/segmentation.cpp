// Time of segmentation on one core: the thesis' scene at full resolution (151,200 points), twice
// that, its down-sampled one, flatness of the time per point, and the recorded table scenes.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <set>

#include "graticule/io/cloud_files.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"

namespace graticule {
namespace {

// The hallway, coloured; points that the picture does not show stay, without a colour.
PointCloud Hallway(std::size_t scans, std::size_t bearings) {
  SceneOptions options;
  options.scans = scans;
  options.bearings = bearings;
  options.bearing_step_rad = 720 * 0.00436332 / static_cast<double>(bearings);
  const SimulatedScene scene = SimulateScene("hallway", options);
  return Coloured(
      scene.cloud,
      ColoursOf(scene.cloud, scene.image, Camera(scene.camera), scene.camera_from_lidar), true);
}

void Run(benchmark::State& state, const PointCloud& cloud, SegmentMethod method) {
  Segmenter segmenter(DefaultsOf(method));
  segmenter.Segment(cloud);
  for (auto _ : state) benchmark::DoNotOptimize(segmenter.Segment(cloud).data());
  std::size_t points = 0;
  for (const Eigen::Vector3f& point : cloud.in_sensor) points += point.allFinite();
  state.counters["points"] = static_cast<double>(points);
  state.counters["ns_a_point"] = benchmark::Counter(
      static_cast<double>(points) * 1e-9,
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["segments"] = static_cast<double>(segmenter.SegmentCount());
}

// Arguments: scans, bearings.
void Joint(benchmark::State& state) {
  Run(state,
      Hallway(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1))),
      SegmentMethod::kJoint);
}
void Convex(benchmark::State& state) {
  Run(state,
      Hallway(static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1))),
      SegmentMethod::kConvex);
}
BENCHMARK(Joint)->Args({210, 720})->Args({420, 720})->Args({44, 90})->Unit(benchmark::kMillisecond);
BENCHMARK(Convex)
    ->Args({210, 720})
    ->Args({420, 720})
    ->Args({44, 90})
    ->Unit(benchmark::kMillisecond);

// 10^4 to 10^7 points: tiles of one scene.
void Flat(benchmark::State& state) {
  const PointCloud tile = Hallway(100, 100);
  const std::size_t times = static_cast<std::size_t>(state.range(0));
  PointCloud cloud;
  cloud.width = 100 * times;
  cloud.height = 100 * times;
  for (std::size_t r = 0; r < cloud.height; ++r)
    for (std::size_t c = 0; c < cloud.width; ++c) {
      const std::size_t i = r % 100 * 100 + c % 100;
      cloud.in_sensor.push_back(tile.in_sensor[i]);
      cloud.colours.push_back(tile.colours[i]);
    }
  Run(state, cloud, state.range(1) == 0 ? SegmentMethod::kJoint : SegmentMethod::kConvex);
}
BENCHMARK(Flat)
    ->ArgsProduct({{1, 3, 10, 32}, {0, 1}})
    ->ArgNames({"tiles", "convex"})
    ->Unit(benchmark::kMillisecond);

void RecordedTable(benchmark::State& state) {
  const std::string path = GRATICULE_DATA_DIR "/segment/mosd/test/test59.pcd";
  if (!std::filesystem::exists(path)) {
    state.SkipWithError("no recorded clouds");
    return;
  }
  Run(state, ReadCloud(path), state.range(0) == 0 ? SegmentMethod::kJoint : SegmentMethod::kConvex);
}
BENCHMARK(RecordedTable)->Arg(0)->Arg(1)->ArgName("convex")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graticule

BENCHMARK_MAIN();
