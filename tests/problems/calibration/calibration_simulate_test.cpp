#include "graticule/problems/calibration/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "lenses.hpp"

namespace graticule {
namespace {

CalibrationSimulation Simulation() {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[2].camera;
  return simulation;
}

TEST(CalibrationSimulate, HasTheSameDigitsAgain) {
  const auto a = SimulateDetections(Simulation(), Person::kRosRules, 11);
  const auto b = SimulateDetections(Simulation(), Person::kRosRules, 11);
  ASSERT_EQ(a.detections.views.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    ASSERT_EQ(a.detections.views[i].corners.size(), b.detections.views[i].corners.size());
    for (std::size_t j = 0; j < a.detections.views[i].corners.size(); ++j)
      EXPECT_EQ(a.detections.views[i].corners[j].pixel, b.detections.views[i].corners[j].pixel);
  }
}

TEST(CalibrationSimulate, LensesSeeTheirWholeImageWithTheirFieldOfView) {
  const auto lenses = StudyLenses();
  ASSERT_EQ(lenses.size(), 6u);
  for (const StudyLens& lens : lenses) {
    const Camera camera(lens.camera);
    EXPECT_GT(camera.MaxAngle() * 180 / M_PI, lens.diagonal_deg / 2 + 2) << lens.name;
    const auto first = camera.Unproject({0, 0});
    const auto last = camera.Unproject({camera.Width() - 1., camera.Height() - 1.});
    ASSERT_TRUE(first && last) << lens.name;
    // The centre is off the image's middle, which costs a degree.
    EXPECT_NEAR(std::acos(first->dot(*last)) * 180 / M_PI, lens.diagonal_deg, 1) << lens.name;
  }
}

TEST(CalibrationSimulate, NoiseIsAsLargeAsItSays) {
  CalibrationSimulation simulation = Simulation();
  simulation.sigma_px = 0.3;
  simulation.warp = {.1, -.2, .05};
  const auto simulated = SimulateDetections(simulation, Person::kNovice, 30);
  const Camera camera(simulation.camera);
  double squares = 0;
  int count = 0;
  for (const TargetView& view : simulated.detections.views) {
    const Eigen::Isometry3d pose = IsometryOf(*simulated.truth.rig_from_target[view.exposure]);
    for (const DetectedCorner& corner : view.corners) {
      const auto pixel = camera.Project(pose * PlaceOf(simulated.truth, corner));
      ASSERT_TRUE(pixel);
      squares += (*pixel - Eigen::Vector2d(corner.pixel.data())).squaredNorm();
      count += 2;
    }
  }
  EXPECT_GT(count, 30 * 192 * 2 * 0.9);
  EXPECT_NEAR(squares / count, .09, 4.5 * .09 * std::sqrt(2. / count));
}

TEST(CalibrationSimulate, PlacesATargetWhereAndAsLargeAsItWasAsked) {
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  for (const CameraIntrinsics& lens : testing::Lenses()) {
    const Camera camera(lens);
    Placement placement;
    placement.across = .3;
    placement.down = .6;
    placement.size = .3;
    const auto pose = PlaceTarget(camera, target, placement);
    ASSERT_TRUE(pose);
    const auto centre = camera.Project(IsometryOf(*pose) * target.Centre());
    ASSERT_TRUE(centre);
    EXPECT_NEAR(centre->x(), .3 * 640 - .5, 1e-6);
    EXPECT_NEAR(centre->y(), .6 * 480 - .5, 1e-6);
    const auto seen = VisibleCorners(camera, target, *pose);
    ASSERT_EQ(seen.size(), target.corners.size()) << lens.model;
    double left = 1e9, right = -1e9;
    for (const DetectedCorner& corner : seen) {
      left = std::min(left, corner.pixel[0]);
      right = std::max(right, corner.pixel[0]);
    }
    // Off the axis, pixels are not as wide as high.
    EXPECT_NEAR(right - left, .3 * 640, .15 * .3 * 640) << lens.model;
  }
}

TEST(CalibrationSimulate, SeesTagsWholeOrNotAtAllAndNeverFromBehind) {
  const TargetLayout target = LayoutOf(AprilCalMosaic());
  const Camera camera(StudyLenses()[0].camera);
  Placement placement;
  placement.across = .05;
  placement.size = .8;
  const auto pose = PlaceTarget(camera, target, placement);
  ASSERT_TRUE(pose);
  const auto seen = VisibleCorners(camera, target, *pose);
  EXPECT_GT(seen.size(), 0u);
  EXPECT_LT(seen.size(), target.corners.size());
  EXPECT_EQ(seen.size() % 4, 0u);
  placement.tilt_sideways = M_PI;
  EXPECT_TRUE(VisibleCorners(camera, target, *PlaceTarget(camera, target, placement)).empty());
}

TEST(CalibrationSimulate, FollowersOfTheRulesReachFartherThanNovices) {
  const auto spread = [&](Person person) {
    double squares = 0;
    int count = 0;
    for (const TargetView& view : SimulateDetections(Simulation(), person, 33).detections.views)
      for (const DetectedCorner& corner : view.corners) {
        squares += std::pow(corner.pixel[0] - 324, 2);
        ++count;
      }
    return std::sqrt(squares / count);
  };
  EXPECT_GT(spread(Person::kRosRules), 1.1 * spread(Person::kNovice));
}

}  // namespace
}  // namespace graticule
