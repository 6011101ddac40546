#include "graticule/problems/pose_graph/trajectory_error.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Pose = std::array<double, 7>;

Pose MakePose(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  return {p[0], p[1], p[2], q.x(), q.y(), q.z(), q.w()};
}

Eigen::Quaterniond Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

Pose Planar(double x, double y, double yaw_deg) {
  return MakePose({x, y, 0}, Turn(yaw_deg * M_PI / 180, Eigen::Vector3d::UnitZ()));
}

TrajectoryPair Pair(std::vector<Pose> truth, std::vector<Pose> estimate,
                    const std::string& family = "pose") {
  return {family, truth.size(), std::move(truth), std::move(estimate)};
}

// A curve in space.
std::vector<Pose> Curve(int count = 50) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double t = 0.2 * i;
    poses.push_back(MakePose({3 * std::cos(t), 2 * std::sin(2 * t), t},
                             Turn(t, {1, 0.5, 2}) * Turn(0.3, {0, 1, 0})));
  }
  return poses;
}

std::vector<Pose> Moved(const std::vector<Pose>& poses, const Eigen::Quaterniond& q,
                        const Eigen::Vector3d& t, double scale = 1) {
  std::vector<Pose> moved;
  for (const Pose& pose : poses)
    moved.push_back(MakePose(scale * (q * Eigen::Vector3d(pose[0], pose[1], pose[2])) + t,
                             q * Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5])));
  return moved;
}

void ExpectNothing(const PoseError& error) {
  EXPECT_LT(error.translation_m.max, 1e-12);
  EXPECT_LT(error.rotation_deg.max, 1e-6);  // an angle of 1e-8 rad lies in the last digit of qw
}

TEST(TrajectoryErrors, AreZeroWhereATrajectoryWasMovedAsAWhole) {
  const auto q = Turn(2, {1, -2, 0.5});
  const Eigen::Vector3d t(10, -20, 5);
  TrajectoryErrorOptions options;
  for (const auto align : {TrajectoryAlignment::kRigid, TrajectoryAlignment::kFirst}) {
    options.align = align;
    const Accuracy accuracy = TrajectoryErrors({Pair(Curve(), Moved(Curve(), q, t))}, options);
    ExpectNothing(accuracy.together.ate);
    ExpectNothing(accuracy.together.rpe_step);
    ExpectNothing(accuracy.together.rpe_distance);
    EXPECT_EQ(accuracy.together.ate.translation_m.count, 50u);
    EXPECT_EQ(accuracy.together.rpe_step.translation_m.count, 49u);
    EXPECT_TRUE(accuracy.families.empty());
  }
  options.align = TrajectoryAlignment::kNone;
  const Accuracy raw = TrajectoryErrors({Pair(Curve(), Moved(Curve(), q, t))}, options);
  EXPECT_GT(raw.together.ate.translation_m.rmse, 20);
  EXPECT_NEAR(raw.together.ate.rotation_deg.mean, 2 * 180 / M_PI, 1e-9);
  ExpectNothing(raw.together.rpe_step);
  EXPECT_EQ(raw.together.alignment, "none");
}

TEST(TrajectoryErrors, FindAScaleWhereAskedTo) {
  TrajectoryErrorOptions options;
  options.align = TrajectoryAlignment::kSimilarity;
  const auto pair = Pair(Curve(), Moved(Curve(), Turn(2, {1, -2, 0.5}), {1, 2, 3}, 0.25));
  const Accuracy accuracy = TrajectoryErrors({pair}, options);
  EXPECT_NEAR(accuracy.together.scale, 4, 1e-12);
  EXPECT_EQ(accuracy.together.alignment, "sim3 (Umeyama, with scale)");
  ExpectNothing(accuracy.together.ate);
  ExpectNothing(accuracy.together.rpe_step);
  options.align = TrajectoryAlignment::kRigid;
  EXPECT_GT(TrajectoryErrors({pair}, options).together.ate.translation_m.rmse, 1);
}

// By hand.  The truth drives 4 m along x in steps of 1; the estimate is off sideways by 0, 3, 0, 0
// and 4 cm, and turned by 2 degrees at the last pose.
TEST(TrajectoryErrors, HaveTheNumbersOfACalculationByHand) {
  std::vector<Pose> truth, estimate;
  const double off[] = {0, 0.03, 0, 0, 0.04};
  for (int i = 0; i < 5; ++i) {
    truth.push_back(Planar(i, 0, 0));
    estimate.push_back(Planar(i, off[i], i == 4 ? 2 : 0));
  }
  TrajectoryErrorOptions options;
  options.align = TrajectoryAlignment::kNone;
  options.rpe_distance_m = 2;
  const FamilyAccuracy errors = TrajectoryErrors({Pair(truth, estimate)}, options).together;
  EXPECT_NEAR(errors.ate.translation_m.rmse, std::sqrt((9e-4 + 16e-4) / 5), 1e-15);
  EXPECT_NEAR(errors.ate.translation_m.mean, 0.07 / 5, 1e-15);
  EXPECT_NEAR(errors.ate.translation_m.max, 0.04, 1e-15);
  EXPECT_NEAR(errors.ate.rotation_deg.rmse, 2 / std::sqrt(5), 1e-12);
  EXPECT_NEAR(errors.ate.rotation_deg.mean, 0.4, 1e-12);
  // Steps err by 3, -3, 0 and 4 cm.
  EXPECT_EQ(errors.rpe_step.translation_m.count, 4u);
  EXPECT_NEAR(errors.rpe_step.translation_m.rmse, std::sqrt((9e-4 + 9e-4 + 16e-4) / 4), 1e-15);
  EXPECT_NEAR(errors.rpe_step.translation_m.mean, 0.1 / 4, 1e-15);
  EXPECT_NEAR(errors.rpe_step.rotation_deg.max, 2, 1e-12);
  // Marks at 2 and 4 m: one pair, off by 4 cm and 2 degrees.
  EXPECT_EQ(errors.rpe_distance.translation_m.count, 1u);
  EXPECT_NEAR(errors.rpe_distance.translation_m.rmse, 0.04, 1e-15);
  EXPECT_NEAR(errors.rpe_distance.rotation_deg.rmse, 2, 1e-12);
}

// The least squared distance over all turns, by trying them: what Umeyama's formula must find.
TEST(TrajectoryErrors, AreTheLeastThatAnyRigidMotionLeaves) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const bool planar : {true, false}) {
    std::vector<Pose> truth, estimate;
    for (int i = 0; i < 20; ++i) {
      truth.push_back(planar ? Planar(normal(random), normal(random), 10 * i)
                             : MakePose({normal(random), normal(random), normal(random)},
                                        Turn(0.1 * i, {1, 2, 3})));
      estimate.push_back(planar ? Planar(normal(random), normal(random), -10 * i)
                                : MakePose({normal(random), normal(random), normal(random)},
                                           Turn(0.1 * i, {3, 2, 1})));
    }
    TrajectoryErrorOptions options;
    const Accuracy best = TrajectoryErrors({Pair(truth, estimate)}, options);
    EXPECT_EQ(best.together.alignment,
              planar ? "se2 (Umeyama, no scale)" : "se3 (Umeyama, no scale)");
    const double rmse = best.together.ate.translation_m.rmse;
    const auto centred = [](std::vector<Pose> poses) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const Pose& pose : poses) mean += Eigen::Vector3d(pose[0], pose[1], pose[2]) / 20;
      for (Pose& pose : poses)
        for (std::size_t i = 0; i < 3; ++i) pose[i] -= mean[static_cast<Eigen::Index>(i)];
      return poses;
    };
    options.align = TrajectoryAlignment::kNone;
    double least = 1e9;
    for (int i = 0; i < 20000; ++i) {
      const auto q = planar ? Turn(2 * M_PI * i / 20000, Eigen::Vector3d::UnitZ())
                            : Eigen::Quaterniond(normal(random), normal(random), normal(random),
                                                 normal(random))
                                  .normalized();
      const Accuracy tried = TrajectoryErrors(
          {Pair(centred(truth), Moved(centred(estimate), q, Eigen::Vector3d::Zero()))}, options);
      least = std::min(least, tried.together.ate.translation_m.rmse);
    }
    EXPECT_GE(least, rmse - 1e-12);
    EXPECT_LT(least, rmse * (planar ? 1 + 1e-6 : 1.02));
  }
}

// A helix with seeded errors; the figures are from a calculation with matrices in another language,
// by evo's definitions.
TEST(TrajectoryErrors, HaveTheNumbersOfAnIndependentCalculation) {
  std::vector<Pose> truth, estimate;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.25 * i;
    const double x = 5 * std::cos(t), y = 5 * std::sin(t), z = 0.3 * t;
    const Eigen::Vector3d p(x, y, z);
    const auto q = Turn(t, Eigen::Vector3d::UnitZ());
    truth.push_back(MakePose(p, q));
    const Eigen::Vector3d noise(0.1 * std::sin(7.0 * i), 0.1 * std::cos(11.0 * i),
                                0.05 * std::sin(13.0 * i));
    estimate.push_back(
        MakePose(Turn(0.4, {1, 1, 0}) * (p + noise) + Eigen::Vector3d(1, 2, 3),
                 Turn(0.4, {1, 1, 0}) * q * Turn(0.02 * std::sin(5.0 * i), {1, 0, 0})));
  }
  TrajectoryErrorOptions options;
  options.rpe_distance_m = 5;
  const FamilyAccuracy errors = TrajectoryErrors({Pair(truth, estimate)}, options).together;
  EXPECT_EQ(errors.alignment, "se3 (Umeyama, no scale)");
  EXPECT_NEAR(errors.ate.translation_m.rmse, 0.105096000103939, 1e-12);
  EXPECT_NEAR(errors.ate.translation_m.mean, 0.0995081714509063, 1e-12);
  EXPECT_NEAR(errors.ate.translation_m.max, 0.151723613517493, 1e-12);
  EXPECT_NEAR(errors.ate.rotation_deg.rmse, 0.808877300758471, 1e-10);
  EXPECT_NEAR(errors.ate.rotation_deg.mean, 0.728195618615988, 1e-10);
  EXPECT_NEAR(errors.ate.rotation_deg.max, 1.21274671320913, 1e-10);
  EXPECT_NEAR(errors.rpe_step.translation_m.rmse, 0.113663908045459, 1e-12);
  EXPECT_NEAR(errors.rpe_step.translation_m.mean, 0.11298851794122, 1e-12);
  EXPECT_NEAR(errors.rpe_step.translation_m.max, 0.133263294983795, 1e-12);
  EXPECT_NEAR(errors.rpe_step.rotation_deg.rmse, 0.97317370693371, 1e-10);
  EXPECT_NEAR(errors.rpe_step.rotation_deg.mean, 0.897822566877588, 1e-10);
  EXPECT_NEAR(errors.rpe_step.rotation_deg.max, 1.36057202299739, 1e-10);
  EXPECT_EQ(errors.rpe_distance.translation_m.count, 6u);
  EXPECT_NEAR(errors.rpe_distance.translation_m.rmse, 0.196477807498213, 1e-12);
  EXPECT_NEAR(errors.rpe_distance.translation_m.mean, 0.19294631656995, 1e-12);
  EXPECT_NEAR(errors.rpe_distance.translation_m.max, 0.229816808859571, 1e-12);
  EXPECT_NEAR(errors.rpe_distance.rotation_deg.rmse, 0.716561361380584, 1e-10);
  EXPECT_NEAR(errors.rpe_distance.rotation_deg.mean, 0.671291885429839, 1e-10);
  EXPECT_NEAR(errors.rpe_distance.rotation_deg.max, 1.01959262004263, 1e-10);
}

TEST(TrajectoryErrors, OfSeveralFamiliesAreOfAllTogetherAndOfEachByItself) {
  std::vector<Pose> square = {Planar(0, 0, 0), Planar(2, 0, 90), Planar(2, 2, 180),
                              Planar(0, 2, -90)};
  // Both are right by themselves, and 1 m too far apart.
  const auto a = Pair(square, square, "a");
  auto b = Pair(square, Moved(square, Eigen::Quaterniond::Identity(), {1, 0, 0}), "b");
  b.poses = 5;  // of one no truth is known
  const Accuracy accuracy = TrajectoryErrors({a, b});
  EXPECT_NEAR(accuracy.together.ate.translation_m.rmse, 0.5, 1e-12);
  EXPECT_EQ(accuracy.together.poses, 9u);
  EXPECT_EQ(accuracy.together.matched, 8u);
  EXPECT_EQ(accuracy.together.rpe_step.translation_m.count, 6u) << "no pair joins two families";
  EXPECT_LT(accuracy.together.rpe_step.translation_m.max, 1e-12);
  ASSERT_EQ(accuracy.families.size(), 2u);
  for (const FamilyAccuracy& family : accuracy.families)
    EXPECT_LT(family.ate.translation_m.max, 1e-12) << family.family;
  EXPECT_EQ(accuracy.families[1].family, "b");
  EXPECT_EQ(accuracy.families[1].poses, 5u);
}

TEST(TrajectoryErrors, TakeTheFirstPoseWherePositionsLeaveTheRotationOpen) {
  std::vector<Pose> line;
  for (int i = 0; i < 5; ++i)
    line.push_back(MakePose(Eigen::Vector3d(1, 2, 3) * i, Turn(0.1, {1, 0, 0})));
  const Accuracy accuracy =
      TrajectoryErrors({Pair(line, Moved(line, Turn(1, {1, 1, 1}), {1, 2, 3}))});
  EXPECT_EQ(accuracy.together.alignment, "first pose, for the positions leave the rotation open");
  ExpectNothing(accuracy.together.ate);
  // In the plane a line is enough, a point is not.
  const std::vector<Pose> ahead = {Planar(0, 0, 0), Planar(1, 0, 0)}, here = {Planar(3, 4, 50)};
  EXPECT_EQ(TrajectoryErrors({Pair(ahead, ahead)}).together.alignment, "se2 (Umeyama, no scale)");
  const FamilyAccuracy one = TrajectoryErrors({Pair(here, {Planar(0, 0, 0)})}).together;
  ExpectNothing(one.ate);
  EXPECT_EQ(one.rpe_step.translation_m.count, 0u);
  EXPECT_TRUE(std::isnan(one.rpe_step.translation_m.rmse));
}

Graph TwoRobots() {
  Graph graph(Builtins());
  for (std::uint64_t i = 0; i < 3; ++i)
    for (const char* robot : {"a", "b"})
      graph.Add(Key(robot, 10 + i), "se2/1", {static_cast<double>(i), 0, 0});
  graph.Add(Key("landmark:10"), "point2/1", {0, 0});
  return graph;
}

std::vector<StampedPose> Stamped(const std::vector<double>& stamps) {
  std::vector<StampedPose> poses;
  for (const double stamp : stamps) poses.push_back({stamp, Planar(stamp, 0, 0)});
  return poses;
}

TEST(PairWithTruth, MatchesFamiliesAndNumbers) {
  const Graph graph = TwoRobots();
  const Values values = graph.InitialValues();
  const auto pairs = PairWithTruth(graph, values, {{"b", Stamped({12, 11, 99})}});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_TRUE(pairs[0].truth.empty());
  EXPECT_EQ(pairs[0].poses, 3u);
  ASSERT_EQ(pairs[1].truth.size(), 2u);
  EXPECT_EQ(pairs[1].truth[0][0], 11) << "in the order of keys";
  EXPECT_EQ(pairs[1].estimate[0][0], 1);
  // Stamps that are no keys: position by position, where there are as many.
  const auto by_place = PairWithTruth(graph, values, {{"a", Stamped({0.5, 1.5, 2.5})}});
  ASSERT_EQ(by_place[0].truth.size(), 3u);
  EXPECT_EQ(by_place[0].truth[1][0], 1.5);

  Graph one(Builtins());
  one.Add(Key("pose:10"), "se2/1", {0, 0, 0});
  EXPECT_EQ(PairWithTruth(one, one.InitialValues(), {{"robot", Stamped({10})}})[0].truth.size(),
            1u);
}

TEST(PairWithTruth, RefusesATruthThatIsOfNoPoseOrOfOneTwice) {
  const Graph graph = TwoRobots();
  const Values values = graph.InitialValues();
  EXPECT_THROW(PairWithTruth(graph, values, {{"c", Stamped({10, 11, 12})}}), Error);
  EXPECT_THROW(PairWithTruth(graph, values, {{"a", Stamped({0.5, 1.5})}}), Error);
  EXPECT_THROW(PairWithTruth(graph, values, {{"a", Stamped({10, 10})}}), Error);
  EXPECT_THROW(PairWithTruth(graph, values, {}), Error);
}

}  // namespace
}  // namespace graticule
