#include "graticule/problems/calibration/max_ere.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "graticule/problems/calibration/posterior.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Known {
  Camera camera;
  SimulatedDetections simulated;
  Eigen::MatrixXd covariance;
};

Known Lens(std::size_t lens, Person person = Person::kRosRules, std::size_t frames = 11) {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[lens].camera;
  auto simulated = SimulateDetections(simulation, person, frames);
  const Posterior posterior =
      ComputePosterior(simulated.detections, simulated.truth, {}, PosteriorOptions());
  EXPECT_TRUE(posterior.Constrained());
  return {Camera(simulation.camera), std::move(simulated), posterior.OfCamera(0)};
}

TEST(ExpectedLength, IsTheMeanOfManyDraws) {
  RandomNumbers random(3);
  for (const double b : {0., .01, .3, 1.}) {
    Eigen::Matrix2d root;
    const double c = std::cos(.7), s = std::sin(.7);
    root << 2 * c, -2 * b * s, 2 * s, 2 * b * c;
    double sum = 0;
    constexpr int kDraws = 200000;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector2d draw(random.Normal(), random.Normal());
      sum += (root * draw).norm();
    }
    const double expected = ExpectedLength(root * root.transpose());
    EXPECT_NEAR(sum / kDraws, expected, 4 * 1.3 / std::sqrt(double{kDraws})) << b;
  }
}

TEST(ExpectedLength, HasItsLimits) {
  EXPECT_NEAR(ExpectedLength(Eigen::Matrix2d::Identity()), std::sqrt(M_PI / 2), 1e-14);
  EXPECT_NEAR(ExpectedLength(Eigen::Vector2d(4, 0).asDiagonal()), 2 * std::sqrt(2 / M_PI), 1e-14);
  EXPECT_EQ(ExpectedLength(Eigen::Matrix2d::Zero()), 0);
  // As the standard library has the integral.
  for (const double r : {1e-6, 1e-3, .1, .5, .9, .999})
    EXPECT_NEAR(ExpectedLength(Eigen::Vector2d(1, r * r).asDiagonal()),
                std::sqrt(2 / M_PI) * std::comp_ellint_2(std::sqrt(1 - r * r)), 1e-12)
        << r;
}

TEST(MaxEre, InClosedFormIsWhatSamplesSay) {
  for (std::size_t lens = 0; lens < 6; ++lens) {
    const Known known = Lens(lens);
    for (const EreGauge gauge :
         {EreGauge::kRaw, EreGauge::kRotationCompensated, EreGauge::kMotionCompensated}) {
      EreOptions options;
      options.gauge = gauge;
      if (gauge == EreGauge::kMotionCompensated) options.range_m = .7;
      // A translation bends the images of the widest lens: there only small changes are linear.
      const Eigen::MatrixXd covariance =
          known.covariance * (gauge == EreGauge::kMotionCompensated ? .01 : 1.);
      const EreMap linear = EreGrid(known.camera, options).Map(covariance);
      const EreMap sampled = SampledEre(known.camera, covariance, options, 2000, 5);
      // The mean of 2000 distances is known to 1.7 % at worst.
      EXPECT_NEAR(sampled.MaxPx(), linear.MaxPx(), .05 * linear.MaxPx()) << lens << NameOf(gauge);
      for (std::size_t i = 0; i < linear.points.size(); ++i)
        EXPECT_NEAR(sampled.points[i].ere_px, linear.points[i].ere_px,
                    .06 * linear.points[i].ere_px + 1e-6)
            << lens << " " << i << " " << NameOf(gauge);
    }
  }
}

TEST(MaxEre, SamplesHaveTheSameDigitsAgain) {
  const Known known = Lens(2);
  EXPECT_EQ(SampledEre(known.camera, known.covariance, {}, 50, 9).MaxPx(),
            SampledEre(known.camera, known.covariance, {}, 50, 9).MaxPx());
}

TEST(MaxEre, IsTheLargestOfItsMapAndEqualAtAPixel) {
  const Known known = Lens(2);
  const EreGrid grid(known.camera);
  const EreMap map = grid.Map(known.covariance);
  ASSERT_EQ(map.points.size(), 25u);
  double most = 0;
  for (const ErePoint& point : map.points) most = std::max(most, point.ere_px);
  EXPECT_EQ(map.Worst()->ere_px, most);
  EXPECT_DOUBLE_EQ(grid.MaxPx(known.covariance), most);
  EXPECT_NEAR(*EreAt(known.camera, known.covariance, map.Worst()->pixel), most, 1e-12);
  EXPECT_EQ(map.points.back().pixel, Eigen::Vector2d(647, 481));
}

TEST(MaxEre, WithTheRotationTakenOutIsSmaller) {
  // Views of one kind leave the centre, hence the frame's direction, poorly known.
  const Known known = Lens(3, Person::kNovice);
  EreOptions raw;
  raw.gauge = EreGauge::kRaw;
  const double centre_raw = *EreAt(known.camera, known.covariance, {375, 240}, raw);
  const double centre = *EreAt(known.camera, known.covariance, {375, 240});
  EXPECT_LT(centre, .5 * centre_raw);
}

TEST(Gauge, TakesOutARotationOfTheFrameWhole) {
  const Camera camera(StudyLenses()[0].camera);
  const std::vector<MovingPixel> pixels = MovingPixels(camera, 9, 7);
  // Parameters whose effect is a rotation: pretend that the six motions are parameters.
  std::vector<MovingPixel> turned = pixels;
  for (MovingPixel& pixel : turned) pixel.by_parameters = pixel.by_motion;
  const Eigen::MatrixXd rotation = ImpliedMotion(turned, EreGauge::kRotationCompensated);
  EXPECT_LT((rotation.topLeftCorner<3, 3>() - Eigen::Matrix3d::Identity()).norm(), 1e-10);
  EXPECT_EQ(rotation.bottomRows(3).norm(), 0);
  const Eigen::MatrixXd motion = ImpliedMotion(turned, EreGauge::kMotionCompensated);
  EXPECT_LT((motion - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-8);
}

TEST(Gauge, HasNames) {
  for (const EreGauge gauge :
       {EreGauge::kRaw, EreGauge::kRotationCompensated, EreGauge::kMotionCompensated})
    EXPECT_EQ(EreGaugeOf(NameOf(gauge)), gauge);
  EXPECT_THROW(EreGaugeOf("none"), Error);
}

TEST(MaxEre, MasksTheCornersOfACircularImage) {
  // An image circle of 200 px in 640 x 480: r = theta - 0.08 theta^3 turns back at 2.04 rad.
  const Camera camera({"", "angular1", 640, 480, {150, 150, 320, 240, -.08}});
  const EreMap map = EreGrid(camera).Map(Eigen::MatrixXd::Identity(5, 5));
  EXPECT_FALSE(map.points[0].has_ray);
  EXPECT_TRUE(map.points[12].has_ray);
  EXPECT_FALSE(EreAt(camera, Eigen::MatrixXd::Identity(5, 5), {0, 0}));
  EXPECT_TRUE(std::isfinite(map.MaxPx()));
}

TEST(MaxEre, FlagsWhatNoFrameReached) {
  const Known known = Lens(2, Person::kNovice);
  EreMap map = EreGrid(known.camera).Map(known.covariance);
  MarkReached(known.simulated.detections, 0, {}, &map);
  EXPECT_FALSE(map.points[0].is_reached);
  EXPECT_TRUE(map.points[12].is_reached);
  EXPECT_FALSE(map.Worst()->is_reached);
}

}  // namespace
}  // namespace graticule
