// Times of what a guided calibration computes between two frames.  Corners are simulated, 192 a
// frame where all of the mosaic is seen.

#include <benchmark/benchmark.h>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/problems/calibration/posterior.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/problems/calibration/suggest.hpp"

namespace graticule {
namespace {

SimulatedDetections Frames(std::size_t frames, std::size_t corners) {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[2].camera;
  SimulatedDetections simulated = SimulateDetections(simulation, Person::kRosRules, frames);
  for (TargetView& view : simulated.detections.views)
    if (view.corners.size() > corners) view.corners.resize(corners);
  return simulated;
}

void CameraFromParameters(benchmark::State& state) {
  const CameraIntrinsics intrinsics = StudyLenses()[2].camera;
  for (auto _ : state) benchmark::DoNotOptimize(Camera(intrinsics).MaxAngle());
}
BENCHMARK(CameraFromParameters)->Unit(benchmark::kMillisecond);

// From detections and a solved state to a number of pixels, the camera's own making included.
void PosteriorAndMaxEre(benchmark::State& state) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(state.range(0)), 150);
  for (auto _ : state) {
    const Posterior posterior = ComputePosterior(s.detections, s.truth, {}, {});
    const Camera camera(s.truth.cameras[0]);
    benchmark::DoNotOptimize(EreGrid(camera).MaxPx(posterior.OfCamera(0)));
  }
}
BENCHMARK(PosteriorAndMaxEre)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond);

void PosteriorAlone(benchmark::State& state) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(state.range(0)), 150);
  for (auto _ : state)
    benchmark::DoNotOptimize(ComputePosterior(s.detections, s.truth, {}, {}).covariance.data());
}
BENCHMARK(PosteriorAlone)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond);

void MaxEreAlone(benchmark::State& state) {
  const SimulatedDetections s = Frames(10, 150);
  const Eigen::MatrixXd covariance = ComputePosterior(s.detections, s.truth, {}, {}).OfCamera(0);
  const Camera camera(s.truth.cameras[0]);
  for (auto _ : state) benchmark::DoNotOptimize(EreGrid(camera).MaxPx(covariance));
}
BENCHMARK(MaxEreAlone)->Unit(benchmark::kMillisecond);

void MaxEreSampled(benchmark::State& state) {
  const SimulatedDetections s = Frames(10, 150);
  const Eigen::MatrixXd covariance = ComputePosterior(s.detections, s.truth, {}, {}).OfCamera(0);
  const Camera camera(s.truth.cameras[0]);
  EreOptions options;
  options.gauge = EreGauge::kRaw;
  for (auto _ : state)
    benchmark::DoNotOptimize(SampledEre(camera, covariance, options, 100, 1).MaxPx());
}
BENCHMARK(MaxEreSampled)->Unit(benchmark::kMillisecond);

void SixtyCandidates(benchmark::State& state) {
  const SimulatedDetections s = Frames(static_cast<std::size_t>(state.range(0)), 150);
  const Posterior posterior = ComputePosterior(s.detections, s.truth, {}, {});
  const Camera camera(s.truth.cameras[0]);
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  std::size_t seen = 0;
  for (auto _ : state)
    seen = ScoreCandidates(camera, target, posterior.information, posterior.scales, {}).size();
  state.counters["candidates"] = static_cast<double>(CandidatePlacements().size());
  state.counters["seen"] = static_cast<double>(seen);
}
BENCHMARK(SixtyCandidates)->Arg(10)->Arg(60)->Unit(benchmark::kMillisecond);

void BestPose(benchmark::State& state) {
  const SimulatedDetections s = Frames(10, 150);
  const Posterior posterior = ComputePosterior(s.detections, s.truth, {}, {});
  const Camera camera(s.truth.cameras[0]);
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  for (auto _ : state)
    benchmark::DoNotOptimize(
        SuggestPose(camera, target, posterior.information, posterior.scales, {})->max_ere_px);
}
BENCHMARK(BestPose)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graticule

BENCHMARK_MAIN();
