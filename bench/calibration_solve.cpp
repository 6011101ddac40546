// Solving calibrations: ours from a good start and from nothing, and OpenCV's on the same corners.

#include <benchmark/benchmark.h>

#include <opencv2/calib3d.hpp>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

// Frames with 150 corners each, all of them seen.
SimulatedDetections Frames(std::size_t frames) {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[3].camera;
  simulation.seed = 4;
  SimulatedDetections all = SimulateDetections(simulation, Person::kRosRules, 3 * frames);
  SimulatedDetections some = all;
  some.detections.views.clear();
  some.truth.rig_from_target.clear();
  for (TargetView& view : all.detections.views) {
    if (view.corners.size() < 150 || some.detections.views.size() == frames) continue;
    view.corners.resize(150);
    some.truth.rig_from_target.push_back(all.truth.rig_from_target[view.exposure]);
    view.exposure = some.detections.views.size();
    some.detections.views.push_back(view);
  }
  some.detections.exposures = some.detections.views.size();
  return some;
}

// The truth, off by what a session's last solve is off before a new frame.
CalibrationState NearBy(CalibrationState state) {
  state.cameras[0].parameters[0] *= 1.01;
  state.cameras[0].parameters[1] *= 1.01;
  state.cameras[0].parameters[2] += 3;
  for (auto& pose : state.rig_from_target) (*pose)[2] += 0.005;
  return state;
}

void SolveFromAGoodStart(benchmark::State& bench) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(bench.range(0)));
  const Registry types = Builtins();
  const CalibrationOptions options;
  const CalibrationState start = NearBy(s.truth);
  CornerUse use;
  for (const TargetView& view : s.detections.views) use.emplace_back(view.corners.size(), 1);
  for (auto _ : bench) {
    const Graph graph = BuildCalibration(types, s.detections, start, use, options, 0.1);
    const Solution solution = Solve(graph);
    benchmark::DoNotOptimize(solution.report.final_cost);
    bench.counters["steps"] = static_cast<double>(solution.report.Steps());
    bench.counters["frames"] = static_cast<double>(s.detections.views.size());
  }
}
BENCHMARK(SolveFromAGoodStart)->Arg(10)->Arg(20)->Arg(60)->Unit(benchmark::kMillisecond);

void FromNothing(benchmark::State& bench) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(bench.range(0)));
  const Registry types = Builtins();
  for (auto _ : bench)
    benchmark::DoNotOptimize(BootstrapCalibration(types, s.detections, {}).rms_px);
}
BENCHMARK(FromNothing)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond);

void OpenCvCalibrateCamera(benchmark::State& bench) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(bench.range(0)));
  std::vector<std::vector<cv::Point3f>> places;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const TargetView& view : s.detections.views) {
    places.emplace_back();
    pixels.emplace_back();
    for (const DetectedCorner& corner : view.corners) {
      places.back().emplace_back(static_cast<float>(corner.in_target[0]),
                                 static_cast<float>(corner.in_target[1]), 0.f);
      pixels.back().emplace_back(static_cast<float>(corner.pixel[0]),
                                 static_cast<float>(corner.pixel[1]));
    }
  }
  const ImageSize& size = s.detections.cameras[0];
  for (auto _ : bench) {
    cv::Mat k, distortion;
    std::vector<cv::Mat> turns, places_of_board;
    benchmark::DoNotOptimize(cv::calibrateCamera(places, pixels, {size.width, size.height}, k,
                                                 distortion, turns, places_of_board));
  }
}
BENCHMARK(OpenCvCalibrateCamera)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
