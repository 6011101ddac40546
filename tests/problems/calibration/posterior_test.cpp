#include "graticule/problems/calibration/posterior.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/first_guess.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/marginals.hpp"
#include "lenses.hpp"

namespace graticule {
namespace {

struct Problem {
  Detections detections;
  CalibrationState state;
};

Problem OneCamera(const CameraIntrinsics& lens, Person person = Person::kRosRules,
                  std::size_t frames = 11) {
  CalibrationSimulation simulation;
  simulation.camera = lens;
  simulation.target = LayoutOf(AprilCalMosaic(4, 3, .08));
  auto simulated = SimulateDetections(simulation, person, frames);
  return {std::move(simulated.detections), std::move(simulated.truth)};
}

// Two cameras side by side that see the target at the same time.
Problem Rig() {
  Problem problem = OneCamera(testing::Lenses()[9]);
  const Se3Array second_from_rig =
      PoseOf(Eigen::Translation3d(-.1, .01, .02) *
             Eigen::Isometry3d(Eigen::AngleAxisd(.2, Eigen::Vector3d(.2, 1, .1).normalized())));
  CameraIntrinsics lens = testing::Lenses()[6];
  lens.name = "right";
  const Camera camera(lens);
  problem.state.cameras.push_back(lens);
  problem.state.camera_from_rig.push_back(second_from_rig);
  problem.detections.cameras.push_back({"right", lens.width, lens.height});
  for (std::size_t e = 0; e < problem.detections.exposures; ++e)
    problem.detections.views.push_back(
        {"right", 1, e,
         VisibleCorners(
             camera, LayoutOf(AprilCalMosaic(4, 3, .08)),
             PoseOf(IsometryOf(second_from_rig) * IsometryOf(*problem.state.rig_from_target[e])))});
  return problem;
}

void ExpectTheGraphsMarginals(const Problem& problem, const PosteriorOptions& options,
                              const CornerUse& use = {}) {
  const Registry types = Builtins();
  CornerUse every = use;
  if (every.empty())
    for (const TargetView& view : problem.detections.views)
      every.emplace_back(view.corners.size(), 1);
  CalibrationOptions calibration;
  calibration.board = options.board;
  calibration.corner_sigma_m = options.corner_sigma_m;
  calibration.camera_priors = options.camera_priors;
  const Graph graph = BuildCalibration(types, problem.detections, problem.state, every, calibration,
                                       options.sigma_px);
  const Posterior posterior = ComputePosterior(problem.detections, problem.state, use, options);
  ASSERT_TRUE(posterior.Constrained()) << DescribeUnconstrained(posterior);
  std::vector<Key> keys;
  for (const PosteriorBlock& block : posterior.blocks) keys.push_back(Key(block.key));
  const auto result = ComputeMarginals(graph, graph.InitialValues(), keys, true);
  ASSERT_TRUE(std::holds_alternative<Marginals>(result));
  // These views hardly tell six or more terms apart, and both ways lose digits: 1.6e-8 seen.
  const double tolerance = problem.state.cameras[0].parameters.size() >= 10 ? 1e-7 : 1e-8;
  const Marginals& marginals = std::get<Marginals>(result);
  for (const PosteriorBlock& a : posterior.blocks)
    for (const PosteriorBlock& b : posterior.blocks) {
      const auto& expected = marginals.Covariance(Key(a.key), Key(b.key));
      const Eigen::MatrixXd found = posterior.Covariance(a.key, b.key);
      const auto by_row = posterior.Deviations(a.key), by_column = posterior.Deviations(b.key);
      ASSERT_EQ(expected.size(), static_cast<std::size_t>(found.size()));
      for (int i = 0; i < found.rows(); ++i)
        for (int j = 0; j < found.cols(); ++j)
          EXPECT_NEAR(expected[i * found.cols() + j], found(i, j),
                      tolerance * by_row[i] * by_column[j])
              << a.key << " " << b.key;
    }
}

TEST(Posterior, EqualsTheGraphsMarginalsForEveryLens) {
  for (const CameraIntrinsics& lens : testing::Lenses()) {
    SCOPED_TRACE(lens.model);
    const Problem problem = OneCamera(lens);
    if (lens.model == "brown8") {
      // Its numerator and denominator cancel: k1 has a standard deviation of 200.
      EXPECT_EQ(
          DescribeUnconstrained(ComputePosterior(problem.detections, problem.state, {}, {})),
          "k1 of cam0, k2 of cam0, k4 of cam0 and k5 of cam0 are not constrained by these views");
      continue;
    }
    PosteriorOptions options;
    options.loose = 10;  // some models have terms that these views hardly tell apart
    ExpectTheGraphsMarginals(problem, options);
  }
}

TEST(Posterior, EqualsTheGraphsMarginalsForBentAndFreeBoards) {
  PosteriorOptions options;
  options.board = BoardShape::kWarped;
  Problem problem = OneCamera(testing::Lenses()[9]);
  problem.state.warp = {.1, -.2, .05};
  ExpectTheGraphsMarginals(problem, options);
  problem.state.warp = {};
  options.board = BoardShape::kFree;
  options.corner_sigma_m = .001;
  for (const TargetCorner& corner : LayoutOf(AprilCalMosaic(4, 3, .08)).corners)
    problem.state.corners[corner.id] = {corner.in_target[0], corner.in_target[1] + 1e-4, 2e-4};
  ExpectTheGraphsMarginals(problem, options);
}

TEST(Posterior, EqualsTheGraphsMarginalsForRigs) {
  PosteriorOptions options;
  options.board = BoardShape::kWarped;
  const Problem rig = Rig();
  ExpectTheGraphsMarginals(rig, options);
  const Posterior posterior = ComputePosterior(rig.detections, rig.state, {}, options);
  EXPECT_EQ(posterior.OfExtrinsics(1).rows(), 6);
  EXPECT_EQ(posterior.OfCamera(1).rows(), 5);
  EXPECT_THROW(posterior.OfExtrinsics(0), Error);
}

TEST(Posterior, CountsWhatWasKnownBefore) {
  Problem problem = OneCamera(testing::Lenses()[9], Person::kNovice, 1);
  PosteriorOptions options;
  options.camera_priors = {FirstPrior(problem.state.cameras[0], 1)};
  ExpectTheGraphsMarginals(problem, options);
}

TEST(Posterior, LeavesOutCornersThatDoNotCountAndViewsWithoutPose) {
  Problem problem = OneCamera(testing::Lenses()[9]);
  problem.state.rig_from_target[3].reset();
  CornerUse use;
  for (const TargetView& view : problem.detections.views) {
    use.emplace_back(view.corners.size(), 1);
    for (std::size_t i = 0; i < view.corners.size(); i += 3) use.back()[i] = 0;
  }
  ExpectTheGraphsMarginals(problem, {}, use);
}

TEST(Posterior, NamesWhatFrontParallelViewsDoNotConstrain) {
  // Straight views of a pinhole camera: focal lengths and distance are one.
  Problem problem = OneCamera(testing::Lenses()[0]);
  problem.detections.views.clear();
  const Camera camera(problem.state.cameras[0]);
  for (std::size_t i = 0; i < 5; ++i) {
    Se3Array pose = kIdentityPose;
    pose[0] = -.16 + .02 * static_cast<double>(i);
    pose[1] = -.12;
    pose[2] = .5 + .1 * static_cast<double>(i);
    problem.state.rig_from_target[i] = pose;
    problem.detections.views.push_back(
        {"", 0, i, VisibleCorners(camera, LayoutOf(AprilCalMosaic(4, 3, .08)), pose)});
  }
  const Posterior posterior = ComputePosterior(problem.detections, problem.state, {}, {});
  EXPECT_FALSE(posterior.Constrained());
  EXPECT_TRUE(posterior.covariance.allFinite());
  const auto has = [&](const char* name) {
    return std::count(posterior.unconstrained.begin(), posterior.unconstrained.end(), name) > 0;
  };
  EXPECT_TRUE(has("fx of cam0") || has("fy of cam0")) << DescribeUnconstrained(posterior);
}

TEST(Posterior, SaysThatNothingIsKnownWithoutViews) {
  Problem problem = OneCamera(testing::Lenses()[9]);
  problem.detections.views.clear();
  const Posterior posterior = ComputePosterior(problem.detections, problem.state, {}, {});
  EXPECT_EQ(posterior.unconstrained.size(), 8u);
  EXPECT_TRUE(posterior.covariance.allFinite());
}

TEST(Posterior, ShrinksWithTheNoiseSquared) {
  const Problem problem = OneCamera(testing::Lenses()[9]);
  PosteriorOptions options;
  const Eigen::MatrixXd one =
      ComputePosterior(problem.detections, problem.state, {}, options).covariance;
  options.sigma_px = .05;
  const Eigen::MatrixXd half =
      ComputePosterior(problem.detections, problem.state, {}, options).covariance;
  EXPECT_LT((4 * half - one).norm(), 1e-9 * one.norm());
}

TEST(Posterior, RefusesWhatDoesNotFit) {
  Problem problem = OneCamera(testing::Lenses()[9]);
  PosteriorOptions options;
  options.sigma_px = 0;
  EXPECT_THROW(ComputePosterior(problem.detections, problem.state, {}, options), Error);
  options.sigma_px = 1;
  options.board = BoardShape::kFree;
  EXPECT_THROW(ComputePosterior(problem.detections, problem.state, {}, options), Error);
  problem.state.rig_from_target.pop_back();
  EXPECT_THROW(ComputePosterior(problem.detections, problem.state, {}, {}), Error);
}

}  // namespace
}  // namespace graticule
