#include "graticule/problems/calibration/study.hpp"

#include <gtest/gtest.h>

#include "graticule/factors/builtins.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

StudyOptions Small(Strategy strategy) {
  StudyOptions options;
  options.lens = StudyLenses()[2];
  options.strategy = strategy;
  options.trials = 4;
  options.frames = 6;
  return options;
}

TEST(Study, SuggestionsBeatPeopleWhoChooseForThemselves) {
  const auto guided = RunStudy(Small(Strategy::kSuggestions));
  const auto novices = RunStudy(Small(Strategy::kNovice));
  ASSERT_EQ(guided.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(guided[i].frames.size(), 6u);
    EXPECT_LT(guided[i].frames.back().true_max_px, 1);
    EXPECT_LT(guided[i].frames.back().test.mean_px, .1);
    EXPECT_LT(guided[i].frames.back().true_max_px, .2 * novices[i].frames.back().true_max_px);
    EXPECT_GT(FramesNeeded(guided[i], 1), 0u);
  }
}

TEST(Study, HasTheSameDigitsWithAnyNumberOfThreads) {
  StudyOptions options = Small(Strategy::kSuggestions);
  options.trials = 2;
  options.frames = 4;
  const auto a = RunStudy(options);
  options.threads = 1;
  const auto b = RunStudy(options);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(a[i].camera.parameters, b[i].camera.parameters);
}

TEST(Study, FindsNoErrorInTheTruth) {
  const CameraIntrinsics truth = StudyLenses()[2].camera;
  const SimulatedDetections test_set = TestSet(truth, LayoutOf(AprilCalMosaic()));
  EXPECT_EQ(test_set.detections.views.size(), 60u);
  const auto error_of = [&](const CameraIntrinsics& camera) {
    CalibrationState state = test_set.truth;
    state.cameras = {camera};
    return EvaluateOn(state, test_set.detections, nullptr, &test_set.truth.rig_from_target);
  };
  EXPECT_LT(error_of(truth).max_px, 1e-6);
  CameraIntrinsics other = truth;
  other.parameters[0] *= 1.01;
  const ReprojectionError error = error_of(other);
  EXPECT_GT(error.max_px, error.percentile_995_px);
  EXPECT_GT(error.percentile_995_px, error.mean_px);
  EXPECT_GT(error.mean_px, .1);
}

TEST(Study, RanksAsSpearmanDoes) {
  EXPECT_DOUBLE_EQ(RankCorrelation({1, 2, 3, 4}, {10, 20, 30, 1000}), 1);
  EXPECT_DOUBLE_EQ(RankCorrelation({1, 2, 3}, {3, 2, 1}), -1);
  EXPECT_DOUBLE_EQ(RankCorrelation({1, 2, 3, 4}, {1, 3, 2, 4}), .8);
  EXPECT_NEAR(RankCorrelation({1, 1, 2}, {1, 2, 2}), .5, 1e-12);
  EXPECT_THROW(RankCorrelation({1}, {1}), Error);
}

TEST(Study, CountsFramesUntilTheErrorStaysSmall) {
  StudyTrial trial;
  for (const double error : {5., .5, 2., .9, .4}) {
    trial.frames.emplace_back();
    trial.frames.back().true_max_px = error;
  }
  EXPECT_EQ(FramesNeeded(trial, 1), 4u);
  EXPECT_EQ(FramesNeeded(trial, 10), 1u);
  EXPECT_EQ(FramesNeeded(trial, .1), 0u);
}

TEST(Study, TheTruthIsWhereThePosteriorSays) {
  CoverageOptions options;
  options.lens = StudyLenses()[2];
  options.trials = 500;
  const Coverage coverage = MeasureCoverage(Builtins(), options);
  // 500 draws of 95 % deviate by 1 %.
  EXPECT_GE(coverage.inside, 465);
  EXPECT_LE(coverage.inside, 485);
  EXPECT_NEAR(coverage.mean_squared, 1, .1);
}

}  // namespace
}  // namespace graticule
