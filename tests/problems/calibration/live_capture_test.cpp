#include "graticule/problems/calibration/live_capture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/calibration/simulated_person.hpp"

namespace graticule {
namespace {

constexpr double kRate = 30;

LiveFrame FrameAt(std::size_t number, double x, double sharpness = 10) {
  return {
      number, static_cast<double>(number) / kRate, {{1, {}, {x, 0}}, {2, {}, {x, 9}}}, sharpness};
}
Match Off(double cells) {
  Match match;
  match.distance_cells = cells;
  return match;
}

TEST(LiveCapture, TakesTheSharpestOfTheFramesThatWereHeldStill) {
  LiveCapture capture(640);
  capture.Begin(0);
  std::optional<LiveFrame> taken;
  for (std::size_t i = 1; i < 60 && !taken; ++i)
    taken =
        capture.Offer(FrameAt(i, 100 + 0.01 * static_cast<double>(i), i == 9 ? 12 : 10), Off(.5));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->number, 9u);
}

TEST(LiveCapture, PrefersSteadyToSharp) {
  LiveCapture capture(640);
  capture.Begin(0);
  std::optional<LiveFrame> taken;
  double x = 0;
  for (std::size_t i = 1; i < 60 && !taken; ++i) {
    x += i == 7 ? 0.1 : 1;  // px a frame: both are steady
    taken = capture.Offer(FrameAt(i, x, i == 7 ? 8 : 10), Off(.5));
  }
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->number, 7u);
}

TEST(LiveCapture, WaitsWhileTheTargetMovesOrIsElsewhere) {
  LiveCapture capture(640);
  capture.Begin(0);
  for (std::size_t i = 1; i < 60; ++i) {
    EXPECT_FALSE(capture.Offer(FrameAt(i, 5 * static_cast<double>(i)), Off(.5)));
    EXPECT_TRUE(capture.State().is_matched);
    EXPECT_FALSE(capture.State().is_steady);
  }
  capture.Begin(2);
  for (std::size_t i = 60; i < 100; ++i) EXPECT_FALSE(capture.Offer(FrameAt(i, 0), Off(4)));
  EXPECT_FALSE(capture.State().is_matched);
  EXPECT_FALSE(capture.Offer(FrameAt(101, 0), Match()));  // not seen
}

TEST(LiveCapture, GetsPatient) {
  LiveCapture capture(640);
  capture.Begin(0);
  std::optional<LiveFrame> taken;
  std::size_t i = 1;
  for (; i < 2000 && !taken; ++i) taken = capture.Offer(FrameAt(i, 0), Off(2));
  ASSERT_TRUE(taken);
  EXPECT_NEAR(static_cast<double>(i) / kRate, 10.5, .2);  // one cell more after ten seconds
}

TEST(LiveCapture, KeepsWhatAMomentGaveButNotAnAccident) {
  LiveCapture capture(640);
  capture.Begin(0);
  for (std::size_t i = 1; i <= 6; ++i) EXPECT_FALSE(capture.Offer(FrameAt(i, 0), Off(.5)));
  EXPECT_TRUE(capture.Offer(FrameAt(7, 0), Off(9)));
  EXPECT_FALSE(capture.Offer(FrameAt(8, 0), Off(.5)));
  EXPECT_FALSE(capture.Offer(FrameAt(9, 0), Off(9)));
}

TEST(LiveCapture, MeasuresSharpnessWhereTheTargetIs) {
  GreyImage image;
  image.width = image.height = 40;
  image.shades.assign(1600, 100);
  for (std::size_t y = 10; y < 30; ++y)
    for (std::size_t x = 10; x < 30; x += 2) image.shades[40 * y + x] = 160;
  const std::vector<DetectedCorner> on = {{0, {}, {10, 10}}, {1, {}, {28, 29}}};
  const std::vector<DetectedCorner> off = {{0, {}, {0, 0}}, {1, {}, {8, 39}}};
  EXPECT_NEAR(SharpnessOf(image, on), 60, 1e-9);
  EXPECT_EQ(SharpnessOf(image, off), 0);
  EXPECT_EQ(SharpnessOf(image, {}), 0);
  // Corners may lie outside, by a model that is off.
  EXPECT_GT(SharpnessOf(image, {{0, {}, {-50, -50}}, {1, {}, {900, 900}}}), 0);
}

TEST(SimulatedPerson, BringsTheTargetWhereItIsSuggestedAndHoldsIt) {
  const Camera truth(StudyLenses()[2].camera);
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  SimulatedPerson person(truth, target);
  const auto suggestion = SuggestFirstPose(truth, target, 0, {});
  ASSERT_TRUE(suggestion);
  const SuggestionMatcher matcher(truth, target, *suggestion);
  LiveCapture capture(truth.Width());
  capture.Begin(0);
  double first_px = 0;
  std::size_t i = 0;
  for (; i < 300; ++i) {
    const auto corners = VisibleCorners(truth, target, person.Step(suggestion, 0, 1 / kRate));
    const Match match = matcher.Compare(corners);
    if (i == 0) first_px = match.distance_px;
    if (capture.Offer({i, static_cast<double>(i) / kRate, corners, 0}, match)) break;
  }
  EXPECT_GT(first_px, 20);  // it comes from elsewhere
  EXPECT_GT(i, 15u);        // it takes time
  EXPECT_LT(i, 300u);
}

}  // namespace
}  // namespace graticule
