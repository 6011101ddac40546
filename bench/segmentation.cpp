// Time of segmentation on one core: the thesis' scene at full resolution (151,200 points), twice
// that, its down-sampled one, the end of a sweep, and the recorded table scenes.

#include <benchmark/benchmark.h>

#include <filesystem>

#include "graticule/io/cloud_files.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "segmentation_scenes.hpp"

namespace graticule {
namespace {

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

// What is left to do when the last scan of the hallway has come in: Algorithm 4.1 itself.
void LastScan(benchmark::State& state) {
  const PointCloud cloud = Hallway(210, 720);
  Segmenter segmenter(
      DefaultsOf(state.range(0) == 0 ? SegmentMethod::kJoint : SegmentMethod::kConvex));
  const auto add = [&](std::size_t i) {
    segmenter.AddScan({&cloud.in_sensor[i], cloud.width}, {&cloud.colours[i], cloud.width});
  };
  for (auto _ : state) {
    state.PauseTiming();
    segmenter.Begin(cloud.width);
    for (std::size_t i = 0; i + cloud.width < cloud.Size(); i += cloud.width) add(i);
    state.ResumeTiming();
    add(cloud.Size() - cloud.width);
    benchmark::DoNotOptimize(segmenter.Finish().data());
  }
}
BENCHMARK(LastScan)->Arg(0)->Arg(1)->ArgName("convex")->Unit(benchmark::kMillisecond);

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
