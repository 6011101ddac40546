#include "graticule/problems/calibration/suggest.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/calibration/simulate.hpp"

namespace graticule {
namespace {

struct Begun {
  CalibrationSimulation simulation;
  SimulatedDetections simulated;
  Camera camera;
  Posterior posterior;
};

Begun Begin(std::size_t lens, std::size_t frames = 4) {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[lens].camera;
  auto simulated = SimulateDetections(simulation, Person::kNovice, frames);
  Posterior posterior = ComputePosterior(simulated.detections, simulated.truth, {}, {});
  return {simulation, std::move(simulated), Camera(simulation.camera), std::move(posterior)};
}

TEST(Suggest, HasAboutSixtyCandidatesAndEveryLensSeesMostOfThem) {
  const std::size_t count = CandidatePlacements().size();
  EXPECT_GE(count, 55u);
  EXPECT_LE(count, 66u);
  for (std::size_t lens = 0; lens < 6; ++lens) {
    const Begun begun = Begin(lens);
    EXPECT_GT(ScoreCandidates(begun.camera, begun.simulation.target, begun.posterior.information,
                              begun.posterior.scales, {})
                  .size(),
              40u)
        << lens;
  }
}

TEST(Suggest, ExpectsWhatAFrameThereBrings) {
  for (std::size_t lens = 0; lens < 6; ++lens) {
    Begun begun = Begin(lens);
    const auto suggestion = SuggestPose(begun.camera, begun.simulation.target,
                                        begun.posterior.information, begun.posterior.scales, {});
    ASSERT_TRUE(suggestion);
    begun.simulated.truth.rig_from_target.push_back(suggestion->camera_from_target);
    begun.simulated.detections.exposures++;
    begun.simulated.detections.views.push_back({"", 0, 4, suggestion->corners});
    const Posterior after =
        ComputePosterior(begun.simulated.detections, begun.simulated.truth, {}, {});
    const EreGrid grid(begun.camera);
    const double before_px = grid.MaxPx(begun.posterior.covariance);
    const double after_px = grid.MaxPx(after.covariance);
    EXPECT_NEAR(suggestion->max_ere_px, after_px, 1e-6 * after_px) << lens;
    EXPECT_LT(after_px, .5 * before_px) << lens;
  }
}

TEST(Suggest, RefinesTheBestCandidate) {
  const Begun begun = Begin(2);
  SuggestOptions options;
  const auto refined = SuggestPose(begun.camera, begun.simulation.target,
                                   begun.posterior.information, begun.posterior.scales, options);
  options.refinements = 0;
  const auto greedy = SuggestPose(begun.camera, begun.simulation.target,
                                  begun.posterior.information, begun.posterior.scales, options);
  ASSERT_TRUE(refined && greedy);
  EXPECT_LT(refined->max_ere_px, greedy->max_ere_px);
  EXPECT_GE(refined->corners.size(), 4 * options.fewest_tags);
  const auto again = SuggestPose(begun.camera, begun.simulation.target, begun.posterior.information,
                                 begun.posterior.scales, {});
  EXPECT_EQ(again->camera_from_target, refined->camera_from_target);
}

TEST(Suggest, KnowsWhatToDoBeforeAnythingIsKnown) {
  const Camera camera(GuessedCamera({"cam0", 640, 480}));
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  const auto first = SuggestFirstPose(camera, target, 0, {});
  const auto second = SuggestFirstPose(camera, target, 1, {});
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->corners.size(), target.corners.size());
  EXPECT_NE(first->camera_from_target, second->camera_from_target);
  // An information of zero: everything is loose, and still a pose comes out.
  const auto greedy = SuggestPose(camera, target, Eigen::MatrixXd::Zero(8, 8),
                                  Eigen::VectorXd::Constant(8, 100), {});
  ASSERT_TRUE(greedy);
  EXPECT_TRUE(std::isfinite(greedy->max_ere_px));
}

TEST(Suggest, MarginalisesWhatIsNotTheCamera) {
  Begun begun = Begin(2, 8);
  PosteriorOptions options;
  options.board = BoardShape::kWarped;
  const Posterior posterior =
      ComputePosterior(begun.simulated.detections, begun.simulated.truth, {}, options);
  const Eigen::MatrixXd information = InformationOfCamera(posterior, 0);
  const Eigen::MatrixXd product = information * posterior.OfCamera(0);
  EXPECT_LT((product - Eigen::MatrixXd::Identity(8, 8)).norm(), 1e-4);
}

TEST(Suggest, WorksForBoardsThatArePrintedOnTheirOtherSide) {
  const Begun begun = Begin(2);
  TargetLayout target = begun.simulation.target;
  target.printed_towards_z = true;
  const auto suggestion =
      SuggestPose(begun.camera, target, begun.posterior.information, begun.posterior.scales, {});
  ASSERT_TRUE(suggestion);
  EXPECT_GE(suggestion->corners.size(), 48u);
}

}  // namespace
}  // namespace graticule
