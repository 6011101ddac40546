#include "graticule/problems/calibration/match_advice.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "graticule/problems/calibration/simulate.hpp"

namespace graticule {
namespace {

using Moves = std::vector<TargetMove>;

// A suggestion in front of a known camera, and what is said of a target that is held otherwise.
struct Asked {
  Camera camera{StudyLenses()[2].camera};
  TargetLayout target = LayoutOf(AprilCalMosaic());
  Placement placement;
  Suggestion suggestion;

  explicit Asked(const Placement& where = {}) : placement(where) {
    placement.size = 0.45;
    suggestion.camera_from_target = *PlaceTarget(camera, target, placement);
    suggestion.corners = VisibleCorners(camera, target, suggestion.camera_from_target);
  }
  Match At(const Se3Array& pose) const {
    return SuggestionMatcher(camera, target, suggestion)
        .Compare(VisibleCorners(camera, target, pose));
  }
  Match At(const Placement& live) const { return At(*PlaceTarget(camera, target, live)); }
  TargetMove First(const Placement& live) const {
    const Match match = At(live);
    EXPECT_FALSE(match.moves.empty());
    return match.moves.empty() ? TargetMove::kRight : match.moves.front();
  }
};

TEST(MatchAdvice, HasNothingToSayOfWhatIsThere) {
  const Asked asked;
  const Match match = asked.At(asked.placement);
  EXPECT_EQ(match.shared, 48u);
  EXPECT_NEAR(match.distance_px, 0, 1e-9);
  EXPECT_TRUE(match.moves.empty());
  ASSERT_TRUE(match.camera_from_target);
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR((*match.camera_from_target)[i], asked.suggestion.camera_from_target[i], 1e-6);
}

TEST(MatchAdvice, MeasuresInCellsOfTheSuggestedTags) {
  const Asked asked;
  const SuggestionMatcher matcher(asked.camera, asked.target, asked.suggestion);
  // Eight tags on about 0.45 image widths, ten cells from one to the next.
  EXPECT_NEAR(matcher.CellPx(), 0.45 * asked.camera.Width() / 78, 0.5);
  auto corners = asked.suggestion.corners;
  for (DetectedCorner& corner : corners) corner.pixel[0] += 3 * matcher.CellPx();
  EXPECT_NEAR(matcher.Compare(corners).distance_cells, 3, 1e-9);
}

TEST(MatchAdvice, SaysWhereTo) {
  const Asked asked;
  Placement live = asked.placement;
  live.across = 0.4;
  EXPECT_EQ(asked.First(live), TargetMove::kRight);
  live.across = 0.6;
  EXPECT_EQ(asked.First(live), TargetMove::kLeft);
  live = asked.placement;
  live.down = 0.4;
  EXPECT_EQ(asked.First(live), TargetMove::kDown);
  live.down = 0.6;
  EXPECT_EQ(asked.First(live), TargetMove::kUp);
  live = asked.placement;
  live.size = 0.3;
  EXPECT_EQ(asked.First(live), TargetMove::kCloser);
  live.size = 0.65;
  EXPECT_EQ(asked.First(live), TargetMove::kFarther);
}

TEST(MatchAdvice, SaysHowToTurn) {
  const Asked asked;
  Placement live = asked.placement;
  live.roll = -0.3;  // a positive one takes the right edge down
  EXPECT_EQ(asked.First(live), TargetMove::kTurnClockwise);
  live.roll = 0.3;
  EXPECT_EQ(asked.First(live), TargetMove::kTurnAnticlockwise);

  // The suggestion's right edge nearer: its face looks to the left of the picture.
  Placement tilted;
  tilted.tilt_sideways = 0.6;
  const Asked left(tilted);
  const Eigen::Isometry3d pose = IsometryOf(left.suggestion.camera_from_target);
  EXPECT_LT((pose * Eigen::Vector3d(.3, .1, 0)).z(), (pose * Eigen::Vector3d(0, .1, 0)).z());
  EXPECT_EQ(left.First(asked.placement), TargetMove::kTiltLeft);
  tilted.tilt_sideways = -0.6;
  EXPECT_EQ(Asked(tilted).First(asked.placement), TargetMove::kTiltRight);

  // The lower edge nearer: its face looks up.
  Placement back;
  back.tilt_up = -0.6;
  const Asked up(back);
  const Eigen::Isometry3d leaning = IsometryOf(up.suggestion.camera_from_target);
  EXPECT_LT((leaning * Eigen::Vector3d(.1, .2, 0)).z(), (leaning * Eigen::Vector3d(.1, 0, 0)).z());
  EXPECT_EQ(up.First(asked.placement), TargetMove::kTiltUp);
  back.tilt_up = 0.6;
  EXPECT_EQ(Asked(back).First(asked.placement), TargetMove::kTiltDown);
}

TEST(MatchAdvice, LeadsThereFromAnywhere) {
  // Whoever does a part of what is said first, again and again, arrives.
  const Asked asked;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomNumbers random(seed);
    const HandNoise clumsy{0.08, 0.2, 0.4};
    Eigen::Isometry3d pose = IsometryOf(
        HeldAt(asked.suggestion.camera_from_target, asked.camera, asked.target, clumsy, random));
    Match match = asked.At(PoseOf(pose));
    for (int step = 0; step < 600 && !match.moves.empty(); ++step) {
      const Eigen::Vector3d centre = asked.target.Centre(), place = pose * centre;
      const auto move = static_cast<int>(match.moves.front());
      const int axis = move / 2 % 3;
      const double sign = move % 2 == 0 ? 1 : -1;
      Eigen::Vector3d by = Eigen::Vector3d::Zero();
      by[axis] = sign;
      if (move < 6) {
        pose.translation() += 0.004 * place.norm() * by;
      } else {
        pose.linear() = Eigen::AngleAxisd(0.02, by).toRotationMatrix() * pose.linear();
        pose.translation() = place - pose.linear() * centre;
      }
      match = asked.At(PoseOf(pose));
    }
    EXPECT_LT(match.distance_cells, 1.5) << seed;
  }
}

TEST(MatchAdvice, HasNoDistanceWhereTooLittleIsShared) {
  const Asked asked;
  auto corners = asked.suggestion.corners;
  corners.resize(4 * 7);
  const SuggestionMatcher matcher(asked.camera, asked.target, asked.suggestion);
  const Match few = matcher.Compare(corners);
  EXPECT_EQ(few.shared, 7u);
  EXPECT_FALSE(std::isfinite(few.distance_px));
  EXPECT_TRUE(few.camera_from_target);  // but it is known where to
  const Match none = matcher.Compare({});
  EXPECT_EQ(none.shared, 0u);
  EXPECT_FALSE(none.camera_from_target);
  EXPECT_TRUE(none.moves.empty());
  // Ids of another target.
  for (DetectedCorner& corner : corners) corner.id += 10000;
  EXPECT_EQ(matcher.Compare(corners).shared, 0u);
}

}  // namespace
}  // namespace graticule
