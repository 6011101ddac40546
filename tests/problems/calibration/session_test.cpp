#include "graticule/problems/calibration/session.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// A person who holds the target where it is suggested, in front of a known camera.
struct Guided {
  Camera truth;
  TargetLayout target = LayoutOf(AprilCalMosaic());
  CalibrationSession session;
  RandomNumbers random{11};

  explicit Guided(std::size_t lens, const SessionOptions& options = {})
      : truth(StudyLenses()[lens].camera),
        session(Builtins(), target, {"cam0", truth.Width(), truth.Height()}, options) {}

  FrameVerdict Add(const Se3Array& pose) {
    auto corners = VisibleCorners(truth, target, pose);
    AddPixelNoise(.1, random, &corners);
    return session.AddFrame(corners);
  }
  FrameVerdict Follow() {
    return Add(HeldAt(session.Suggest()->camera_from_target, truth, target, {}, random));
  }
};

TEST(Session, CalibratesWhoFollowsItsSuggestions) {
  for (const std::size_t lens : {0u, 2u, 3u}) {
    Guided guided(lens);
    EXPECT_FALSE(guided.session.Solved());
    EXPECT_FALSE(guided.session.AccuracyMet());
    for (int i = 0; i < 6; ++i) EXPECT_EQ(guided.Follow(), FrameVerdict::kUsed) << lens << " " << i;
    EXPECT_TRUE(guided.session.AccuracyMet()) << lens;
    EXPECT_FALSE(guided.session.IsBootstrapping());
    EXPECT_LT(guided.session.MaxEre().MaxPx(), 1);
    EXPECT_NEAR(guided.session.SigmaPx(), .1, .01);
    const Camera found(guided.session.Solved()->state.cameras[0]);
    EXPECT_LT(Difference(guided.truth, found).max_px, 1.5) << lens;
  }
}

TEST(Session, HasTheSameDigitsAgain) {
  Guided a(2), b(2);
  for (int i = 0; i < 4; ++i) {
    a.Follow();
    b.Follow();
  }
  EXPECT_EQ(a.session.Solved()->state.cameras[0].parameters,
            b.session.Solved()->state.cameras[0].parameters);
  EXPECT_EQ(a.session.Suggest()->camera_from_target, b.session.Suggest()->camera_from_target);
}

TEST(Session, SuggestsBeforeItHasSeenAnything) {
  const Guided guided(2);
  const auto suggestion = guided.session.Suggest();
  ASSERT_TRUE(suggestion);
  EXPECT_GT(suggestion->corners.size(), 100u);
  EXPECT_TRUE(guided.session.MaxEre().points.empty());
}

TEST(Session, IsNeverContentWithViewsThatSayTooLittle) {
  // The target straight in front, again and again: the focal length cannot be told.
  Guided guided(3);
  for (int i = 0; i < 6; ++i) {
    Placement placement;
    placement.size = .4 + .02 * i;
    guided.Add(*PlaceTarget(guided.truth, guided.target, placement));
    EXPECT_FALSE(guided.session.AccuracyMet()) << i;
  }
  ASSERT_TRUE(guided.session.Uncertainty());
  // Either it says what is not constrained, or it goes on asking.
  EXPECT_TRUE(guided.session.IsBootstrapping() || guided.session.MaxEre().MaxPx() > 1);
  for (int i = 0; i < 4; ++i) guided.Follow();
  EXPECT_TRUE(guided.session.AccuracyMet());
}

TEST(Session, LeavesAFrameOutThatIsNoViewOfTheTarget) {
  Guided guided(2);
  for (int i = 0; i < 4; ++i) guided.Follow();
  auto corners = guided.session.Suggest()->corners;
  for (DetectedCorner& corner : corners)
    for (double& coordinate : corner.pixel) coordinate += 60 * guided.random.Normal();
  EXPECT_EQ(guided.session.AddFrame(corners), FrameVerdict::kNotExplained);
  EXPECT_EQ(guided.Follow(), FrameVerdict::kUsed);
  corners.resize(3);
  EXPECT_EQ(guided.session.AddFrame(corners), FrameVerdict::kTooFewCorners);
  EXPECT_EQ(guided.session.FrameCount(), 6u);
  EXPECT_LT(Difference(guided.truth, Camera(guided.session.Solved()->state.cameras[0])).max_px,
            1.5);
}

TEST(Session, SolvesOtherModels) {
  for (const char* model : {"double_sphere", "brown5"}) {
    SessionOptions options;
    options.calibration.model = model;
    Guided guided(3, options);
    for (int i = 0; i < 5; ++i) guided.Follow();
    EXPECT_EQ(guided.session.Solved()->state.cameras[0].model, model);
    EXPECT_LT(guided.session.Solved()->rms_px, 1) << model;
  }
}

TEST(Session, TakesABoardAsBent) {
  SessionOptions options;
  options.calibration.board = BoardShape::kWarped;
  Guided guided(2, options);
  for (int i = 0; i < 5; ++i) guided.Follow();
  EXPECT_EQ(guided.session.Uncertainty()->Covariance("warp:0").rows(), 3);
  EXPECT_TRUE(guided.session.Suggest());
}

TEST(Session, TakesABoardAsFree) {
  SessionOptions options;
  options.calibration.board = BoardShape::kFree;
  Guided guided(2, options);
  for (int i = 0; i < 4; ++i) guided.Follow();
  EXPECT_EQ(guided.session.Uncertainty()->Covariance("corner:0").rows(), 3);
  EXPECT_TRUE(guided.session.Suggest());
  EXPECT_LT(guided.session.MaxEre().MaxPx(), 5);
}

TEST(Session, RefusesWhatItCannotWorkWith) {
  EXPECT_THROW(CalibrationSession(Builtins(), {}, {"", 640, 480}), Error);
  EXPECT_THROW(CalibrationSession(Builtins(), LayoutOf(AprilCalMosaic()), {"", 0, 480}), Error);
  SessionOptions options;
  options.calibration.model = "angular9";
  EXPECT_THROW(CalibrationSession(Builtins(), LayoutOf(AprilCalMosaic()), {"", 640, 480}, options),
               Error);
}

}  // namespace
}  // namespace graticule
