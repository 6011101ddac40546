#include "graticule/problems/calibration/difference.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/solver/error.hpp"
#include "lenses.hpp"

namespace graticule {
namespace {

Camera Pinhole(double fx, double cx, double cy) {
  return Camera({"cam0", "pinhole", 641, 481, {fx, fx, cx, cy}});
}

TEST(CalibrationDifference, IsNoneOfACameraToItself) {
  for (const CameraIntrinsics& lens : testing::Lenses()) {
    const CalibrationDifference difference = Difference(Camera(lens), Camera(lens));
    EXPECT_LT(difference.max_px, 1e-6) << lens.model;
    EXPECT_GT(difference.nodes, 1000u) << lens.model;
    EXPECT_EQ(difference.unseen, 0u) << lens.model;
  }
}

TEST(CalibrationDifference, IsWhatAFocalLengthChanges) {
  DifferenceOptions options;
  options.gauge = EreGauge::kRaw;
  const CalibrationDifference raw =
      Difference(Pinhole(500, 320, 240), Pinhole(505, 320, 240), options);
  // One part in a hundred of the distance from the centre.
  EXPECT_NEAR(raw.max_px, 4, 1e-9);
  EXPECT_NEAR(raw.shift.front().x(), -3.2, 1e-9);
  EXPECT_NEAR(raw.shift.front().y(), -2.4, 1e-9);
  EXPECT_EQ(raw.second_from_first.matrix(), Eigen::Matrix4d::Identity());
  // No rotation takes it out: it is even about the centre.
  const CalibrationDifference turned = Difference(Pinhole(500, 320, 240), Pinhole(505, 320, 240));
  EXPECT_NEAR(turned.max_px, 4, 1e-6);
}

TEST(CalibrationDifference, VanishesWhereTheFrameIsTurned) {
  // A long lens whose centre moves by 5 px turns by 5 / 5000, but for terms of second order: 5 px
  // (400 / 5000)^2 = 0.03 px.
  const CalibrationDifference difference =
      Difference(Pinhole(5000, 320, 240), Pinhole(5000, 325, 240));
  EXPECT_LT(difference.max_px, 0.04);
  const Eigen::AngleAxisd turn(difference.second_from_first.linear());
  EXPECT_NEAR(turn.angle(), 1e-3, 1e-3 * 0.08 * 0.08);
  EXPECT_NEAR(std::fabs(turn.axis().y()), 1, 1e-3);
  DifferenceOptions raw;
  raw.gauge = EreGauge::kRaw;
  EXPECT_NEAR(Difference(Pinhole(5000, 320, 240), Pinhole(5000, 325, 240), raw).mean_px, 5, 1e-9);
}

TEST(CalibrationDifference, TakesOutAShiftAtAFiniteRange) {
  // At one range, in a narrow view, another focal length is another distance.
  DifferenceOptions options;
  options.gauge = EreGauge::kMotionCompensated;
  options.range_m = 2;
  const CalibrationDifference difference =
      Difference(Pinhole(5000, 320, 240), Pinhole(5050, 320, 240), options);
  EXPECT_LT(difference.max_px, 0.02);
  EXPECT_NEAR(difference.second_from_first.translation().z(), 0.02, 2e-3);
  options.range_m = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Difference(Pinhole(500, 320, 240), Pinhole(500, 320, 240), options), Error);
}

TEST(CalibrationDifference, FitsTheMotionWhereItIsToldTo) {
  // Where the motion is fitted the difference is small, elsewhere it is not hidden.
  CameraIntrinsics lens = testing::Lenses()[9], other = lens;
  other.parameters[7] += 2e-3;  // k4: the rim
  DifferenceOptions options;
  const std::vector<double>& p = lens.parameters;
  for (double x = -80; x <= 80; x += 10)
    for (double y = -80; y <= 80; y += 10) options.fitted_on.emplace_back(p[2] + x, p[3] + y);
  const CalibrationDifference middle = Difference(Camera(lens), Camera(other), options);
  const CalibrationDifference all = Difference(Camera(lens), Camera(other));
  const auto at_centre = [&](const CalibrationDifference& difference) {
    return difference.field.Value(difference.field.columns / 2, difference.field.rows / 2);
  };
  EXPECT_LT(at_centre(middle), 0.01);
  EXPECT_LT(at_centre(middle), at_centre(all));
  EXPECT_GT(middle.max_px, all.rms_px);
  EXPECT_LE(all.rms_px, middle.rms_px);
}

// What a small change of the parameters does, as Max ERE has it: to first order, the rotation
// taken out over the same pixels.
TEST(CalibrationDifference, IsWhatMaxErePredictsOfASmallChange) {
  const CameraIntrinsics lens = testing::Lenses()[8];
  CameraIntrinsics other = lens;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lens.parameters.size()));
  change[0] = 1e-4 * lens.parameters[0];
  change[2] = 0.05;
  for (std::size_t i = 0; i < lens.parameters.size(); ++i)
    other.parameters[i] += change[static_cast<Eigen::Index>(i)];
  EreOptions grid;
  grid.columns = grid.gauge_columns = 33;
  grid.rows = grid.gauge_rows = 25;
  DifferenceOptions options;
  options.nodes = 33;
  const Camera camera(lens);
  const Eigen::VectorXd moved = EreGrid(camera, grid).ByParameters() * change;
  const CalibrationDifference difference = Difference(camera, Camera(other), options);
  ASSERT_EQ(static_cast<std::size_t>(moved.size()), 2 * difference.nodes);
  Eigen::Index row = 0;
  for (const double value : difference.field.values) {
    if (!std::isfinite(value)) continue;
    EXPECT_NEAR(value, moved.segment<2>(row).norm(), 1e-3 * difference.max_px);
    row += 2;
  }
}

TEST(CalibrationDifference, RefusesImagesOfOtherSizes) {
  const Camera other({"cam0", "pinhole", 640, 480, {500, 500, 320, 240}});
  EXPECT_THROW(Difference(Pinhole(500, 320, 240), other), Error);
}

}  // namespace
}  // namespace graticule
