#include "graticule/problems/calibration/bootstrap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/first_guess.hpp"
#include "graticule/problems/calibration/select_model.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

SimulatedDetections Frames(const CameraIntrinsics& camera, std::size_t frames,
                           double sigma_px = 0.1, std::uint64_t seed = 3) {
  CalibrationSimulation simulation;
  simulation.camera = camera;
  simulation.sigma_px = sigma_px;
  simulation.seed = seed;
  return SimulateDetections(simulation, Person::kRosRules, frames);
}

// Views in which the simulated target is too far off to be found.
std::vector<std::size_t> Empty(const Detections& detections) {
  std::vector<std::size_t> empty;
  for (std::size_t v = 0; v < detections.views.size(); ++v)
    if (detections.views[v].corners.empty()) empty.push_back(v);
  return empty;
}

CameraIntrinsics Lens(std::size_t i) { return StudyLenses()[i].camera; }

// Largest distance over the image between where two cameras see the same rays.
double Farthest(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  const Camera from(a), to(b);
  double farthest = 0;
  for (int v = 0; v <= 8; ++v)
    for (int u = 0; u <= 8; ++u) {
      const auto ray = from.Unproject({u * a.width / 8.0, v * a.height / 8.0});
      if (!ray) continue;
      const auto there = to.Project(*ray);
      if (!there) return HUGE_VAL;
      farthest = std::max(farthest,
                          (*there - Eigen::Vector2d(u * a.width / 8.0, v * a.height / 8.0)).norm());
    }
  return farthest;
}

class EveryStudyLens : public ::testing::TestWithParam<std::size_t> {};

TEST_P(EveryStudyLens, IsFoundFromCornersAlone) {
  const SimulatedDetections frames = Frames(Lens(GetParam()), 12, 0.05);
  CalibrationOptions options;
  options.model = frames.truth.cameras[0].model;
  const Calibration found = BootstrapCalibration(Builtins(), frames.detections, options);
  EXPECT_EQ(found.report.termination, Termination::kConverged);
  EXPECT_NEAR(found.sigma_px, 0.05, 0.005);
  EXPECT_EQ(found.left_out, Empty(frames.detections));
  // Corners of the image that no frame reached may be off by more.
  EXPECT_LT(Farthest(frames.truth.cameras[0], found.state.cameras[0]), 3);
}
INSTANTIATE_TEST_SUITE_P(Six, EveryStudyLens, ::testing::Range<std::size_t>(0, 6));

TEST(Bootstrap, IsExactWithoutNoise) {
  const SimulatedDetections frames = Frames(Lens(2), 8, 0);
  CalibrationOptions options;
  options.model = frames.truth.cameras[0].model;
  const Calibration found = BootstrapCalibration(Builtins(), frames.detections, options);
  EXPECT_LT(found.rms_px, 1e-6);
  EXPECT_LT(Farthest(frames.truth.cameras[0], found.state.cameras[0]), 1e-3);
}

TEST(Bootstrap, DoesNotDependOnTheOrderOfViewsAndCorners) {
  SimulatedDetections frames = Frames(Lens(1), 10);
  CalibrationOptions options;
  const Calibration first = BootstrapCalibration(Builtins(), frames.detections, options);
  std::mt19937 random(5);
  for (int i = 0; i < 3; ++i) {
    Detections& d = frames.detections;
    std::shuffle(d.views.begin(), d.views.end(), random);
    for (std::size_t v = 0; v < d.views.size(); ++v) {
      d.views[v].exposure = v;
      std::shuffle(d.views[v].corners.begin(), d.views[v].corners.end(), random);
    }
    const Calibration again = BootstrapCalibration(Builtins(), d, options);
    EXPECT_NEAR(again.rms_px, first.rms_px, 1e-6);
    EXPECT_LT(Farthest(first.state.cameras[0], again.state.cameras[0]), 1e-2);
  }
}

TEST(Bootstrap, IsTheSameToTheLastBit) {
  const SimulatedDetections frames = Frames(Lens(3), 6);
  const Calibration a = BootstrapCalibration(Builtins(), frames.detections, {});
  const Calibration b = BootstrapCalibration(Builtins(), frames.detections, {});
  EXPECT_EQ(a.state.cameras[0].parameters, b.state.cameras[0].parameters);
}

TEST(Bootstrap, SetsABadFrameAndBadCornersAside) {
  SimulatedDetections frames = Frames(Lens(2), 12);
  // one view's corners are those of another place; some corners elsewhere are off
  std::mt19937 random(9);
  auto& bad = frames.detections.views[4].corners;
  std::vector<std::array<double, 2>> pixels;
  for (const DetectedCorner& corner : bad) pixels.push_back(corner.pixel);
  std::shuffle(pixels.begin(), pixels.end(), random);
  for (std::size_t i = 0; i < bad.size(); ++i) bad[i].pixel = pixels[i];
  frames.detections.views[1].corners[3].pixel[0] += 17;
  frames.detections.views[7].corners[0].pixel[1] -= 6;
  CalibrationOptions options;
  const Calibration found = BootstrapCalibration(Builtins(), frames.detections, options);
  std::vector<std::size_t> expected = Empty(frames.detections);
  expected.push_back(4);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found.left_out, expected);
  ASSERT_EQ(found.outliers.size(), 2u);
  EXPECT_EQ(found.outliers[0].view, 1u);
  EXPECT_EQ(found.outliers[0].corner, 3u);
  EXPECT_NEAR(found.outliers[0].error_px, 17, 1);
  EXPECT_EQ(found.outliers[1].view, 7u);
  EXPECT_NEAR(found.sigma_px, 0.1, 0.01);
}

TEST(Bootstrap, FindsARig) {
  const CameraIntrinsics left = Lens(2), right = Lens(3);
  CalibrationSimulation simulation;
  simulation.camera = left;
  simulation.sigma_px = 0.05;
  SimulatedDetections frames = SimulateDetections(simulation, Person::kRosRules, 14);
  Eigen::Isometry3d right_from_left = Eigen::Isometry3d::Identity();
  right_from_left.translation() = Eigen::Vector3d(-.12, .01, .02);
  right_from_left.linear() =
      Eigen::AngleAxisd(.15, Eigen::Vector3d(.1, .9, .2).normalized()).toRotationMatrix();
  std::vector<Se3Array> seen_from_right;
  for (const auto& pose : frames.truth.rig_from_target)
    seen_from_right.push_back(PoseOf(right_from_left * IsometryOf(*pose)));
  simulation.camera = right;
  simulation.seed = 8;
  const SimulatedDetections others = SimulateDetections(simulation, seen_from_right);
  Detections both = frames.detections;
  both.cameras.push_back(others.detections.cameras[0]);
  both.cameras.back().camera = "right";
  for (TargetView view : others.detections.views) {
    view.camera = 1;
    both.views.push_back(view);
  }
  const Calibration found = BootstrapCalibration(Builtins(), both, {});
  EXPECT_NEAR(found.sigma_px, 0.05, 0.005);
  const Eigen::Isometry3d off =
      IsometryOf(found.state.camera_from_rig[1]) * right_from_left.inverse();
  EXPECT_LT(off.translation().norm(), 2e-3);
  EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 2e-3);
}

TEST(Bootstrap, RefusesWhatNothingCanBeSaidOf) {
  Detections none;
  none.cameras = {{"cam0", 640, 480}};
  none.exposures = 1;
  none.views = {{"a.png", 0, 0, {}}};
  EXPECT_THROW(BootstrapCalibration(Builtins(), none, {}), Error);
}

TEST(Bootstrap, FindsTheBendOfABoard) {
  CalibrationSimulation simulation;
  simulation.camera = Lens(3);
  simulation.sigma_px = 0.05;
  simulation.warp = {.05, -.03, .02};
  const SimulatedDetections frames = SimulateDetections(simulation, Person::kRosRules, 16);
  CalibrationOptions options;
  options.board = BoardShape::kWarped;
  const Calibration found = BootstrapCalibration(Builtins(), frames.detections, options);
  EXPECT_NEAR(found.sigma_px, 0.05, 0.004);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found.state.warp[i], simulation.warp[i], 3e-3);
}

TEST(Bootstrap, GraphOfACalibrationIsSolvedWhereItWasSolved) {
  const SimulatedDetections frames = Frames(Lens(2), 6);
  const Registry types = Builtins();
  for (const BoardShape board : {BoardShape::kFlat, BoardShape::kFree}) {
    CalibrationOptions options;
    options.board = board;
    const Calibration found = BootstrapCalibration(types, frames.detections, options);
    const Graph graph = BuildCalibration(types, frames.detections, found.state, found.use, options,
                                         found.weight_sigma_px);
    const Solution solution = Solve(graph);
    EXPECT_NEAR(solution.report.final_cost, solution.report.initial_cost,
                1e-6 * solution.report.initial_cost);
    // Every coordinate weighs as its deviation says: chi2 is about the degrees of freedom.  A free
    // board's corners are where they are described here: their prior costs nothing.
    EXPECT_NEAR(solution.report.ReducedChi2(), board == BoardShape::kFlat ? 1 : .85, 0.1);
  }
}

TEST(CrossValidate, CountsWhatItCouldNotPredictAsFarOff) {
  SimulatedDetections frames = Frames(Lens(2), 8, 0.05);
  const Calibration found = BootstrapCalibration(Builtins(), frames.detections, {});
  // Of two cameras' views of an exposure the last one must not speak for both.
  TargetView lost = frames.detections.views[1];
  lost.corners.resize(2);  // too few for a pose
  frames.detections.views.push_back(lost);
  frames.detections.views[3].corners.resize(2);
  std::vector<ReprojectionError> by_exposure;
  CrossValidate(Builtins(), frames.detections, found, {}, 4, &by_exposure);
  ASSERT_EQ(by_exposure.size(), 8u);
  EXPECT_EQ(by_exposure[1].corners, frames.detections.views[1].corners.size());
  EXPECT_EQ(by_exposure[1].unseen, 2u);
  EXPECT_LT(by_exposure[1].mean_px, 1);
  EXPECT_EQ(by_exposure[3].corners, 0u);
  EXPECT_EQ(HeldOutError_px(by_exposure[3]), 10);
}

TEST(SelectModel, TakesTheModelThatTheImagesWereMadeWith) {
  CameraIntrinsics camera{"", "brown4", 640, 480, {520, 522, 318, 241, -.22, .06, .004, -.003}};
  const SimulatedDetections frames = Frames(camera, 25, 0.05);
  const ModelSelection selection =
      SelectModel(Builtins(), frames.detections, {}, {}, {BoardShape::kFlat, BoardShape::kFree});
  EXPECT_EQ(selection.trials[selection.chosen].model, "brown4");
  EXPECT_EQ(selection.options.board, BoardShape::kFlat);
  EXPECT_LT(Farthest(camera, selection.calibration.state.cameras[0]), 1.5);
}

}  // namespace
}  // namespace graticule
