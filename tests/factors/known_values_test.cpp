// Values worked out by hand, or by another formula: 4x4 matrices for poses, Rodrigues' formula for
// cameras.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "evaluate.hpp"
#include "graticule/factors/lie.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {
namespace {

using testing::Made;
using testing::Random;
using Numbers = std::vector<double>;

constexpr std::uint64_t kSeed = 7;

void ExpectNear(const Numbers& a, const Numbers& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "number " << i;
}

Eigen::Isometry3d Pose(const double* v) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

Numbers ToNumbers(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Numbers RandomPose(Random* random) { return testing::RandomValue(Made::Variable("se3/1"), random); }

// Residual of an error pose, from its matrix.
Numbers Expected(const Eigen::Isometry3d& error, bool full_angle) {
  const Eigen::AngleAxisd turn(error.linear());  // angle in [0, pi]
  const Eigen::Vector3d r = (full_angle ? turn.angle() : std::sin(turn.angle() / 2)) * turn.axis();
  const Eigen::Vector3d t = error.translation();
  return {t.x(), t.y(), t.z(), r.x(), r.y(), r.z()};
}

Numbers Join(Numbers a, const Numbers& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(SignalPath, AddsUpPathLossCellsAndBiases) {
  // At 100 m: -40 - 2 * 20; 3 m of 2 dB/m and 10 m of 0.1 dB/m; biases of 1 and -3 dB.
  const Numbers terms[] = {{-40, 20}, {2}, {0.1}, {1}, {-3}};
  graticule_measurement m = {sizeof(graticule_measurement), 6, nullptr};
  const Numbers measured = {-90, 2, 3, 10, -1, -1};
  m.values = measured.data();
  const FactorType type = *Builtins().FindFactorType("signal_path/1");
  graticule_error error{};
  std::int32_t rows = 0;
  EXPECT_EQ(type.table->create(&m, 4, &rows, &error), nullptr);  // one weight too many
  void* factor = type.table->create(&m, 5, &rows, &error);
  ASSERT_NE(factor, nullptr) << error.message;
  const double* blocks[5];
  for (int i = 0; i < 5; ++i) blocks[i] = terms[i].data();
  double residual = 0;
  EXPECT_TRUE(type.table->evaluate(factor, blocks, &residual, nullptr, &error));
  EXPECT_NEAR(residual, -80 - 6 - 1 + 1 - 3 + 90, 1e-12);
  type.table->destroy(factor);
}

TEST(SignalPathNotHeard, IsTheTailOfTheNormalDistribution) {
  // (floor - predicted) / 2: reference values of -log Phi from a series of 50 digits.
  const auto tail = [](double z) {
    const double r = Made("path_loss_not_heard/1", {-90 + 2 * z, 2, 0})({{-90, 20}})[0];
    return 0.5 * r * r;
  };
  EXPECT_NEAR(tail(0), std::log(2.0), 1e-15);
  EXPECT_NEAR(tail(-1), 1.8410216450092637, 1e-14);
  EXPECT_NEAR(tail(-40), 804.60844201375788, 1e-10);
  EXPECT_NEAR(tail(-29.999999), tail(-30.000001), 1e-4);  // the two forms meet
  EXPECT_NEAR(tail(6), 9.8658764552437e-10, 1e-19);
  EXPECT_EQ(tail(60), 0);
  EXPECT_TRUE(std::isfinite(tail(-1e6)));
}

TEST(BetweenSe2, IsTheErrorInTheFrameOfTheMeasuredB) {
  // a at (1, 2) looks north; b is 3 m ahead and 1 m to its left, and looks west.
  const Numbers a = {1, 2, M_PI / 2}, b = {0, 5, M_PI};
  ExpectNear(Made("between_se2/1", {3, 1, M_PI / 2})({a, b}), {0, 0, 0}, 1e-15);
  // Measured 2.5 m and 0.8 m, and a turn of 90 degrees: the error (0.5, 0.2) in a is (0.2, -0.5)
  // in the measured b.
  ExpectNear(Made("between_se2/1", {2.5, 0.8, M_PI / 2})({a, b}), {0.2, -0.5, 0}, 1e-15);
}

TEST(BetweenSe2, WrapsTheTurnIntoHalfAClosedCircle) {
  const Numbers at_rest = {0, 0, 3.0};
  // From 3 rad to -3 rad is a turn of 2 pi - 6, not of -6.
  ExpectNear(Made("between_se2/1", {0, 0, 0})({at_rest, {0, 0, -3}}), {0, 0, 2 * M_PI - 6}, 1e-15);
  EXPECT_EQ(Made("between_se2/1", {0, 0, 0})({{0, 0, 0}, {0, 0, M_PI}})[2], M_PI);
  EXPECT_EQ(Made("between_se2/1", {0, 0, 0})({{0, 0, M_PI}, {0, 0, 0}})[2], M_PI);
  EXPECT_NEAR(Made("between_se2/1", {0, 0, 20})({{0, 0, 0}, {0, 0, 0.5}})[2], 0.5 - 20 + 6 * M_PI,
              1e-14);
}

TEST(BetweenSe3, IsTheErrorOfTheMatrices) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Numbers a = RandomPose(&random), b = RandomPose(&random), z = RandomPose(&random);
    const Eigen::Isometry3d error =
        Pose(z.data()).inverse() * Pose(a.data()).inverse() * Pose(b.data());
    // 1e-15 for values of order 1, and the matrix's angle loses half the digits near pi.
    ExpectNear(Made("between_se3_quaternion/1", z)({a, b}), Expected(error, false), 1e-7);
    ExpectNear(Made("between_se3/1", z)({a, b}), Expected(error, true), 1e-7);
    const Numbers exact = ToNumbers(Pose(a.data()).inverse() * Pose(b.data()));
    ExpectNear(Made("between_se3_quaternion/1", exact)({a, b}), Numbers(6), 1e-14);
    ExpectNear(Made("between_se3/1", exact)({a, b}), Numbers(6), 1e-14);
  }
}

TEST(BetweenSe3, IsTheHalfAngleOrTheFullAngle) {
  const double angle = 0.2;
  const Numbers a = {0, 0, 0, 0, 0, 0, 1};
  const Numbers b = {1, 2, 3, 0, 0, std::sin(angle / 2), std::cos(angle / 2)};
  ExpectNear(Made("between_se3_quaternion/1", a)({a, b}), {1, 2, 3, 0, 0, std::sin(0.1)}, 1e-15);
  ExpectNear(Made("between_se3/1", a)({a, b}), {1, 2, 3, 0, 0, 0.2}, 1e-15);
}

TEST(BetweenSe3, StaysFiniteAndRightAroundNoTurnAndHalfATurn) {
  const Numbers a = {0, 0, 0, 0, 0, 0, 1};
  for (const double angle : {0.0, 1e-300, 1e-160, 1e-12, 1e-8, 1e-5, 1e-3, 0.031, 0.032, 3.1,
                             M_PI - 1e-6, M_PI - 1e-12, M_PI}) {
    const Numbers b = {0, 0, 0, 0, std::sin(angle / 2), 0, std::cos(angle / 2)};
    for (const char* name : {"between_se3/1", "between_se3_quaternion/1"}) {
      const Made factor(name, a);
      Numbers residual;
      std::vector<Numbers> jacobians;
      ASSERT_TRUE(factor.Evaluate({a, b}, &residual, &jacobians));
      const bool full = std::string(name) == "between_se3/1";
      EXPECT_NEAR(residual[4], full ? angle : std::sin(angle / 2), 1e-15 + 1e-15 * angle) << angle;
      for (const Numbers& jacobian : jacobians)
        for (const double value : jacobian) ASSERT_TRUE(std::isfinite(value)) << angle;
      // A further turn about the same axis adds to the angle, whatever the angle.
      EXPECT_NEAR(jacobians[1][4 * 6 + 4], full ? 1 : std::cos(angle / 2) / 2, 1e-12) << angle;
    }
  }
}

TEST(InverseRightJacobian, HasNoStepWhereItsSeriesBegins) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
  const double edge = std::sqrt(1e-3);
  const auto below = InverseRightJacobian(axis * edge * (1 - 1e-14));
  const auto above = InverseRightJacobian(axis * edge * (1 + 1e-14));
  // angle^6/30240 is the first term left out.
  EXPECT_LT((above - below).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(PriorSe2, IsTheErrorInTheMeasuredFrame) {
  ExpectNear(Made("prior_se2/1", {1, 2, M_PI / 2})({{1, 2, M_PI / 2}}), {0, 0, 0}, 0);
  ExpectNear(Made("prior_se2/1", {1, 2, M_PI / 2})({{1, 3, -M_PI / 2 + 0.1}}), {1, 0, -M_PI + 0.1},
             1e-15);
}

TEST(PriorSe3, IsTheErrorOfTheMatricesWithAndWithoutAnOffset) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Numbers x = RandomPose(&random), m = RandomPose(&random), o = RandomPose(&random);
    const Eigen::Isometry3d plain = Pose(m.data()).inverse() * Pose(x.data());
    const Eigen::Isometry3d with_offset = plain * Pose(o.data());
    ExpectNear(Made("prior_se3_quaternion/1", m)({x}), Expected(plain, false), 1e-7);
    ExpectNear(Made("prior_se3/1", m)({x}), Expected(plain, true), 1e-7);
    ExpectNear(Made("prior_offset_se3_quaternion/1", Join(m, o))({x}), Expected(with_offset, false),
               1e-7);
    ExpectNear(Made("prior_offset_se3/1", Join(m, o))({x}), Expected(with_offset, true), 1e-7);
    const Numbers exact = ToNumbers(Pose(x.data()) * Pose(o.data()));
    ExpectNear(Made("prior_offset_se3/1", Join(exact, o))({x}), Numbers(6), 1e-14);
    ExpectNear(Made("prior_offset_se3_quaternion/1", Join(exact, o))({x}), Numbers(6), 1e-14);
    ExpectNear(Made("prior_se3/1", x)({x}), Numbers(6), 1e-15);
    ExpectNear(Made("prior_se3_quaternion/1", x)({x}), Numbers(6), 1e-15);
  }
}

TEST(PriorPoint, IsTheDifference) {
  ExpectNear(Made("prior_point2/1", {1, 2})({{1.5, 1}}), {0.5, -1}, 0);
  ExpectNear(Made("prior_point3/1", {1, 2, 3})({{1.5, 1, 3}}), {0.5, -1, 0}, 0);
}

TEST(Landmark, IsSeenFromTheBody) {
  // At (1, 1), looking north; the landmark 2 m ahead and 1 m to the right.
  const Numbers pose = {1, 1, M_PI / 2}, landmark = {2, 3};
  ExpectNear(Made("landmark_se2/1", {2, -1})({pose, landmark}), {0, 0}, 1e-15);
  ExpectNear(Made("landmark_se2/1", {0, 0})({pose, landmark}), {2, -1}, 1e-15);
  ExpectNear(Made("bearing_se2/1", {0.1})({pose, landmark}), {std::atan2(-1, 2) - 0.1}, 1e-15);
  ExpectNear(Made("range_se2/1", {2})({pose, landmark}), {std::sqrt(5) - 2}, 1e-15);
  ExpectNear(Made("bearing_range_se2/1", {0.1, 2})({pose, landmark}),
             {std::atan2(-1, 2) - 0.1, std::sqrt(5) - 2}, 1e-15);
}

TEST(Landmark, HasItsBearingWrapped) {
  // Behind the body, a little to the right of straight back; measured a little to the left.
  const Numbers pose = {0, 0, 0}, landmark = {-1, -std::tan(0.1)};
  EXPECT_NEAR(Made("bearing_se2/1", {M_PI - 0.1})({pose, landmark})[0], 0.2, 1e-15);
  EXPECT_NEAR(Made("bearing_range_se2/1", {M_PI - 0.1, 1})({pose, landmark})[0], 0.2, 1e-15);
}

TEST(Landmark, HasNoBearingFromItsOwnPlace) {
  const Numbers pose = {1, 2, 0.3}, landmark = {1, 2};
  Numbers residual;
  std::vector<Numbers> jacobians;
  EXPECT_FALSE(Made("bearing_se2/1", {0}).Evaluate({pose, landmark}, &residual));
  EXPECT_FALSE(Made("bearing_range_se2/1", {0, 1}).Evaluate({pose, landmark}, &residual));
  ASSERT_TRUE(Made("range_se2/1", {1.5}).Evaluate({pose, landmark}, &residual, &jacobians));
  EXPECT_EQ(residual[0], -1.5);
  EXPECT_EQ(jacobians[0], (Numbers{-1, 0, 0}));  // a way out
}

TEST(Landmark, IsSeenInSpaceFromTheBodyAndFromItsSensor) {
  Random random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Numbers x = RandomPose(&random), o = RandomPose(&random), z = {0.1, 0.2, 0.3};
    const Numbers l = testing::RandomValue(Made::Variable("point3/1"), &random);
    const Eigen::Vector3d landmark(l[0], l[1], l[2]), measured(0.1, 0.2, 0.3);
    const Eigen::Vector3d in_body = Pose(x.data()).inverse() * landmark - measured;
    const Eigen::Vector3d in_sensor =
        (Pose(x.data()) * Pose(o.data())).inverse() * landmark - measured;
    ExpectNear(Made("landmark_se3/1", z)({x, l}), {in_body.x(), in_body.y(), in_body.z()}, 1e-14);
    ExpectNear(Made("landmark_offset_se3/1", Join(z, o))({x, l}),
               {in_sensor.x(), in_sensor.y(), in_sensor.z()}, 1e-14);
  }
}

TEST(Position, IsThatOfTheAntenna) {
  ExpectNear(Made("position_se2/1", {1, 2})({{1.5, 1, 2}}), {0.5, -1}, 0);
  // The body at (10, 20, 30), turned by 90 degrees to the left; the antenna 1 m ahead, 2 m up.
  const Numbers pose = {10, 20, 30, 0, 0, std::sqrt(0.5), std::sqrt(0.5)};
  ExpectNear(Made("position_se3/1", {10, 21, 32, 1, 0, 2})({pose}), {0, 0, 0}, 1e-14);
  ExpectNear(Made("position_se3/1", {9, 21, 32, 1, 0, 2})({pose}), {1, 0, 0}, 1e-14);
}

// The antenna is 100 m above and beside the datum; GeographicLib says the same (georeference_test).
TEST(Geodetic, IsEastAndNorthOfTheDatum) {
  constexpr double kRadius = 6378137, kFlattening = 1 / 298.257223563;
  const double e2 = kFlattening * (2 - kFlattening);
  // On the equator: degrees to the east are those of a circle, to the north of its curvature.
  const double east = (kRadius + 100) * std::sin(1e-3 * M_PI / 180);
  const double north = (kRadius * (1 - e2) + 100) * 1e-3 * M_PI / 180;
  ExpectNear(Made("geodetic_se2/1", {0, 1e-3, 100, 0, 0, 0, 0, 0})({{0, 0, 0}}), {-east, 0}, 1e-9);
  ExpectNear(Made("geodetic_se2/1", {1e-3, 0, 100, 0, 0, 0, 0, 0})({{0, 0, 0}}), {0, -north}, 1e-7);
  // The body at (10, 20), turned by 90 degrees to the left; the antenna 1 m ahead, 2 m to the left.
  ExpectNear(Made("geodetic_se2/1", {42, -83, 7, 42, -83, 7, 1, 2})({{10, 20, M_PI / 2}}), {8, 21},
             1e-14);
}

TEST(BalReprojection, IsThePublishedModel) {
  // Unturned, 5 m away along -z: p = (0.2, 0.4), |p|^2 = 0.2, distortion 1 + 0.02 + 0.0004.
  const Numbers camera = {0, 0, 0, 0, 0, -5, 500, 0.1, 0.01};
  ExpectNear(Made("bal_reprojection/1", {0, 0})({camera, {1, 2, 0}}),
             {500 * 1.0204 * 0.2, 500 * 1.0204 * 0.4}, 1e-12);
  ExpectNear(Made("bal_reprojection/1", {102.04, 204.08})({camera, {1, 2, 0}}), {0, 0}, 1e-12);

  Random random(kSeed);
  for (const double scale : {1.0, 1e-2, 1e-3, 1e-8, 0.0}) {
    for (int i = 0; i < 50; ++i) {
      Numbers c = testing::RandomValue(Made::Variable("bal_camera/1"), &random);
      const Numbers x = testing::RandomValue(Made::Variable("point3/1"), &random);
      Eigen::Vector3d w(c[0], c[1], c[2]);
      w *= scale;
      for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = w[k];
      const Eigen::Matrix3d r = w.norm() > 0
                                    ? Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix()
                                    : Eigen::Matrix3d::Identity();
      const Eigen::Vector3d p =
          r * Eigen::Vector3d(x[0], x[1], x[2]) + Eigen::Vector3d(c[3], c[4], c[5]);
      const Eigen::Vector2d q = -p.head<2>() / p.z();
      const Eigen::Vector2d pixel =
          c[6] * (1 + c[7] * q.squaredNorm() + c[8] * std::pow(q.squaredNorm(), 2)) * q;
      ExpectNear(Made("bal_reprojection/1", {3, 4})({c, x}), {pixel.x() - 3, pixel.y() - 4}, 1e-11);
    }
  }
}

TEST(BalReprojection, KeepsItsJacobianWhereTheSeriesBegins) {
  const Numbers point = {0.3, -0.2, 0.1};
  std::vector<Numbers> below, above;
  Numbers residual;
  const Made factor("bal_reprojection/1", {0, 0});
  factor.Evaluate({{0, 0, 0.01 * (1 - 1e-13), 0, 0, -5, 500, 0, 0}, point}, &residual, &below);
  factor.Evaluate({{0, 0, 0.01 * (1 + 1e-13), 0, 0, -5, 500, 0, 0}, point}, &residual, &above);
  ExpectNear(below[0], above[0], 1e-10);
  ExpectNear(below[1], above[1], 1e-10);
}

TEST(BalReprojection, CannotBeEvaluatedInThePlaneOfTheCamera) {
  Numbers residual;
  const Numbers camera = {0, 0, 0, 0, 0, -5, 500, 0.1, 0.01};
  EXPECT_FALSE(Made("bal_reprojection/1", {0, 0}).Evaluate({camera, {1, 2, 5}}, &residual));
}

TEST(QuaternionMeasurement, IsNormalisedWhenRoundedAndRefusedWhenWrong) {
  const Numbers a = {0, 0, 0, 0, 0, 0, 1};
  for (const char* name :
       {"between_se3/1", "between_se3_quaternion/1", "prior_se3/1", "prior_se3_quaternion/1"}) {
    const bool between = std::string(name).substr(0, 7) == "between";
    const std::vector<Numbers> blocks =
        between ? std::vector<Numbers>{a, a} : std::vector<Numbers>{a};
    ExpectNear(Made(name, {0, 0, 0, 0, 0, 0, 1.0005})(blocks), Numbers(6), 0);
    EXPECT_THROW(Made(name, {0, 0, 0, 0, 0, 0, 0}), std::runtime_error);
    EXPECT_THROW(Made(name, {0, 0, 0, 0, 0, 0, 1.01}), std::runtime_error);
    EXPECT_THROW(Made(name, {0, 0, 0, std::nan(""), 0, 0, 1}), std::runtime_error);
    EXPECT_THROW(Made(name, {0, 0, 0, 0, 0, 0, 1e200}), std::runtime_error);
  }
  const Numbers twice = {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 2};
  EXPECT_THROW(Made("prior_offset_se3/1", twice), std::runtime_error);
  EXPECT_THROW(Made("landmark_offset_se3/1", {0, 0, 0, 0, 0, 0, 0, 0, 0, 2}), std::runtime_error);
}

TEST(Range, BelowZeroIsRefused) {
  EXPECT_THROW(Made("range_se2/1", {-1}), std::runtime_error);
  EXPECT_THROW(Made("bearing_range_se2/1", {0, -1}), std::runtime_error);
  EXPECT_NO_THROW(Made("range_se2/1", {0}));
}

TEST(MakeFactor, GivesFactorsThatAGraphTakes) {
  Graph graph(Builtins());
  const Key p2("pose", 0), q2("pose", 1), l2("point", 0), p3("body", 0), q3("body", 1);
  const Key camera("camera", 0), l3("corner", 0);
  graph.Add(p2, "se2/1", {0, 0, 0});
  graph.Add(q2, "se2/1", {1, 0, 0});
  graph.Add(l2, "point2/1", {1, 1});
  graph.Add(p3, "se3/1", {0, 0, 0, 0, 0, 0, 1});
  graph.Add(q3, "se3/1", {0, 0, 0, 0, 0, 0, 1});
  graph.Add(camera, "bal_camera/1", {0, 0, 0, 0, 0, -5, 500, 0, 0});
  graph.Add(l3, "point3/1", {0, 0, 0});
  const Noise noise = Noise::Sigma(0.1);
  graph.Add(PriorSe2Factor(p2, {0, 0, 0}, noise));
  graph.Add(BetweenSe2Factor(p2, q2, {1, 0, 0}, noise, "odometry"));
  graph.Add(LandmarkSe2Factor(p2, l2, {1, 1}, noise));
  graph.Add(BearingRangeSe2Factor(p2, l2, 0.5, 1, noise));
  graph.Add(PriorSe3Factor(p3, {0, 0, 0, 0, 0, 0, 1}, noise));
  graph.Add(BetweenSe3Factor(p3, q3, {0, 0, 0, 0, 0, 0, 1}, noise));
  graph.Add(PositionSe3Factor(p3, {0, 0, 0}, {0, 0, 1}, noise));
  graph.Add(BalReprojectionFactor(camera, l3, 1, 2, noise));
  EXPECT_EQ(graph.FactorCount(), 8u);
  EXPECT_EQ(graph.FactorAt(1).source, "odometry");
}

}  // namespace
}  // namespace graticule
