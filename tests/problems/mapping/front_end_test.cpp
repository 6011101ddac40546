#include "graticule/problems/mapping/front_end.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/relations.hpp"
#include "graticule/problems/mapping/pose_noise.hpp"
#include "graticule/problems/mapping/relation_error.hpp"
#include "graticule/problems/mapping/relative_uncertainty.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/marginals.hpp"
#include "ring.hpp"

namespace graticule {
namespace {

double Apart(const PlanarPose& a, const PlanarPose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// The largest distance of scans from the truth, with scan 0 laid onto it.
double LargestError(const FrontEndResult& mission, const std::vector<PlanarPose>& truth) {
  const PlanarPose lay = truth[0] * Inverse(mission.world_from_scan[0]);
  double largest = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    largest = std::max(largest, Apart(lay * mission.world_from_scan[i], truth[i]));
  return largest;
}

TEST(FrontEnd, ClosesALoopWithWheelsThatTurnTooFar) {
  LaserLog log;
  std::vector<PlanarPose> truth;
  test::Drive(0, 1.3, 1, &log, &truth);
  EXPECT_GT(Apart(truth[0] * log.scans.back().odom_from_robot, truth.back()), 3) << "is too easy";
  const FrontEndResult mission = BuildMission(log, Builtins());
  EXPECT_LT(LargestError(mission, truth), 0.1);

  ASSERT_EQ(mission.world_from_scan.size(), log.scans.size());
  ASSERT_EQ(mission.nodes.size(), mission.graph.VariableCount());
  EXPECT_EQ(mission.nodes[0].key, Key("robot1:0"));
  EXPECT_TRUE(mission.graph.IsFixed(0));
  std::set<std::string> sources;
  for (FactorId id = 0; id < mission.graph.FactorCount(); ++id)
    sources.insert(std::string(mission.graph.FactorAt(id).source));
  EXPECT_EQ(sources, (std::set<std::string>{"loop", "odometry", "scan"}));
  for (std::size_t i = 0; i < mission.nodes.size(); ++i) {
    const Span<const double> value = mission.graph.ValueOf(static_cast<VariableId>(i));
    EXPECT_EQ(value[0], mission.world_from_node[i].x);
    EXPECT_LT(Apart(mission.world_from_node[i], mission.world_from_scan[mission.nodes[i].scan]),
              1e-9);
  }
}

TEST(FrontEnd, GivesTheSameDigitsWhateverTheThreads) {
  LaserLog log;
  std::vector<PlanarPose> truth;
  test::Drive(0, 1.2, 2, &log, &truth);
  FrontEndOptions options;
  options.threads = 1;
  const FrontEndResult one = BuildMission(log, Builtins(), options);
  options.threads = 3;
  const FrontEndResult three = BuildMission(log, Builtins(), options);
  ASSERT_EQ(one.graph.FactorCount(), three.graph.FactorCount());
  EXPECT_EQ(one.graph.InitialValues().Data(), three.graph.InitialValues().Data());
}

TEST(FrontEnd, JoinsRobotsWhoseStartsNobodyKnows) {
  LaserLog log;
  std::vector<PlanarPose> truth;
  test::Drive(0, 0.7, 3, &log, &truth);
  test::Drive(0.4, 0.7, 4, &log, &truth);
  const FrontEndResult mission = BuildMission(log, Builtins());
  EXPECT_EQ(mission.report.piece_of_robot[0], mission.report.piece_of_robot[1]);
  EXPECT_LT(LargestError(mission, truth), 0.15);
}

TEST(FrontEnd, TakesStartsThatAreKnownRoughly) {
  LaserLog log;
  std::vector<PlanarPose> truth;
  test::Drive(0, 0.6, 5, &log, &truth);
  const std::size_t second = truth.size();
  test::Drive(0.4, 0.6, 6, &log, &truth);
  FrontEndOptions options;
  options.starts = {truth[0], truth[second] * PlanarPose{0.4, -0.3, 0.05}};
  const FrontEndResult mission = BuildMission(log, Builtins(), options);
  EXPECT_LT(LargestError(mission, truth), 0.15);
  options.starts.pop_back();
  EXPECT_THROW(BuildMission(log, Builtins(), options), Error);
}

TEST(FrontEnd, RefusesALogWithoutScansAndBearsOnesWithoutPoints) {
  LaserLog log;
  log.robots = {"robot1"};
  EXPECT_THROW(BuildMission(log, Builtins()), Error);
  log.geometries.push_back({-M_PI / 2, M_PI / 180, 79, PlanarPose{}});
  for (int i = 0; i < 20; ++i) {
    LaserScan scan;
    scan.time = i;
    scan.odom_from_robot.x = 0.1 * i;
    scan.first_range = log.ranges.size();
    scan.beams = 181;
    log.ranges.insert(log.ranges.end(), 181, 80.f);
    log.scans.push_back(scan);
  }
  const FrontEndResult mission = BuildMission(log, Builtins());
  EXPECT_NEAR(mission.world_from_scan.back().x, 1.9, 1e-6) << "dead reckoning is all there is";
}

TEST(FrontEnd, DescribesEachOptionOnce) {
  std::set<std::string> names;
  FrontEndOptions options;
  for (const auto& row : FrontEndOptionTable()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.set(options, row.get(options))) << row.name;
  }
}

TEST(FrontEnd, IsBelowThePublishedErrorOnTheStataCentre) {
  const std::string path = std::string(GRATICULE_DATA_DIR) + "/mapping/kuemmerle/mit-csail";
  std::string text, relations;
  try {
    text = ReadFile(path + ".clf.gz");
    relations = ReadFile(path + ".relations");
  } catch (const Error&) {
    GTEST_SKIP() << path << " is not there";
  }
  LaserLog log;
  ParseCarmen(text, path, {}, &log);
  const FrontEndResult mission = BuildMission(log, Builtins());
  std::vector<TimedPose> poses;
  for (std::size_t i = 0; i < log.scans.size(); ++i)
    poses.push_back({log.scans[i].time, mission.world_from_scan[i]});
  const RelationError error = CompareWithRelations(poses, ParseRelations(relations, path));
  EXPECT_EQ(error.relations, 1172u);
  EXPECT_LT(error.translation_m.mean, 0.032);  // Cartographer's (Hess et al. 2016)
  EXPECT_LT(error.rotation_rad.mean, 0.37 * M_PI / 180);
}

TEST(RelativeUncertainty, IsTheMarginalOfAChainAndNoLessThanThatOfALoop) {
  Graph graph(Builtins());
  std::vector<PlanarPose> poses;
  std::vector<UncertainEdge> edges;
  RandomNumbers random(1);
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    const PlanarPose step = Inverse(poses[a]) * poses[b];
    Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.02, 0.005).asDiagonal();
    covariance(0, 2) = covariance(2, 0) = 0.003;
    edges.push_back({a, b, covariance});
    graph.Add(BetweenSe2Factor(
        Key("pose", a), Key("pose", b), {step.x, step.y, step.yaw},
        InformationNoise(covariance.inverse() - 1e-2 * Eigen::Matrix3d::Identity())));
  };
  PlanarPose pose;
  for (std::uint32_t i = 0; i < 8; ++i) {
    poses.push_back(pose);
    graph.Add(Key("pose", i), "se2/1", {pose.x, pose.y, pose.yaw}, i == 0);
    pose = pose * PlanarPose{random.Uniform(0, 2), random.Normal(), random.Normal()};
  }
  // Some edges backwards.
  for (std::uint32_t i = 1; i < 8; ++i) add(i % 3 ? i - 1 : i, i % 3 ? i : i - 1);
  for (const bool has_loop : {false, true}) {
    if (has_loop) add(7, 0);
    RelativeUncertainty known(8, edges);
    known.From(0, poses);
    for (std::uint32_t i = 1; i < 8; ++i) {
      ASSERT_TRUE(known.IsReached(i));
      const auto marginals =
          std::get<Marginals>(ComputeMarginals(graph, graph.InitialValues(), {Key("pose", i)}));
      const std::vector<double>& exact = marginals.Covariance(Key("pose", i));
      for (int k = 0; k < 9; ++k) {
        const double bound = known.Of(i)(k / 3, k % 3);
        if (!has_loop) {
          EXPECT_NEAR(bound, exact[static_cast<std::size_t>(k)], 1e-9) << i;
        } else if (k % 4 == 0) {
          EXPECT_GE(bound * (1 + 1e-9), exact[static_cast<std::size_t>(k)]) << i;
        }
      }
    }
  }
}

TEST(RelationError, MeasuresWhatIsApart) {
  const std::vector<TimedPose> poses = {{0, {}}, {1, {1, 0, 0}}, {2, {1, 1, M_PI / 2}}};
  const std::vector<PoseRelation> exact = {{0, 1, {1, 0, 0}}, {1, 2, {0, 1, M_PI / 2}}};
  RelationError error = CompareWithRelations(poses, exact);
  EXPECT_EQ(error.relations, 2u);
  EXPECT_NEAR(error.translation_m.mean, 0, 1e-15);
  EXPECT_NEAR(error.rotation_rad.mean, 0, 1e-15);
  const std::vector<PoseRelation> apart = {
      {0, 1, {1, 0.3, 0}}, {1, 2, {0, 1, M_PI / 2 - 0.2}}, {0, 9, {1, 0, 0}}};
  error = CompareWithRelations(poses, apart);
  EXPECT_EQ(error.unmatched, 1u);
  EXPECT_NEAR(error.translation_m.mean, 0.15, 1e-12);
  EXPECT_NEAR(error.translation_m.deviation, 0.15, 1e-12);
  EXPECT_NEAR(error.rotation_rad.mean, 0.1, 1e-12);
  EXPECT_NEAR(error.squared_translation.mean, 0.045, 1e-12);
  // Between two poses: by time.
  error = CompareWithRelations(poses, {{0, 0.5, {0.5, 0, 0}}});
  EXPECT_NEAR(error.translation_m.mean, 0, 1e-12);
}

}  // namespace
}  // namespace graticule
