// A mission laid onto satellite fixes: the closed form, and the whole on a simulated mission.

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/geodetic.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/gnss_alignment.hpp"
#include "graticule/problems/mapping/gnss_factors.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/simulate_gnss.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

const Geodetic kAnnArbor{42.293, -83.711, 260};
const PlanarPose kTurned{120, -40, 2.5};  // where the map's frame is by accident

std::vector<GroundPoint> Points(std::size_t count, double sigma, std::size_t bad) {
  RandomNumbers random(3);
  std::vector<GroundPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    GroundPoint point{random.Uniform(-40, 40), random.Uniform(-20, 20), 0, 0, sigma};
    kTurned.Transform(point.x, point.y, &point.east, &point.north);
    point.east += sigma * random.Normal() + (i < bad ? 50 : 0);
    point.north += sigma * random.Normal();
    points.push_back(point);
  }
  return points;
}

TEST(GroundAlignment, IsExactWithoutNoise) {
  const GroundAlignment found = AlignToGround(Points(7, 1e-9, 0));
  EXPECT_NEAR(found.ground_from_map.x, kTurned.x, 1e-7);
  EXPECT_NEAR(found.ground_from_map.y, kTurned.y, 1e-7);
  EXPECT_NEAR(found.ground_from_map.yaw, kTurned.yaw, 1e-9);
  EXPECT_EQ(found.agreeing, 7u);
}

TEST(GroundAlignment, IsNotMovedByBadPoints) {
  for (const std::size_t bad : {0u, 1u, 12u, 36u}) {
    const GroundAlignment found = AlignToGround(Points(80, 1, bad));
    // Four deviations of what 44 good points leave.
    EXPECT_NEAR(found.ground_from_map.yaw, kTurned.yaw, 4 * found.sigma_yaw) << bad;
    EXPECT_NEAR(found.ground_from_map.x, kTurned.x, 0.7) << bad;
    EXPECT_NEAR(found.ground_from_map.y, kTurned.y, 0.7) << bad;
    EXPECT_LE(found.agreeing, 80 - bad);
    EXPECT_GE(found.agreeing, 80 - bad - 3);
  }
}

TEST(GroundAlignment, KnowsNoDirectionFromOnePlace) {
  EXPECT_GT(AlignToGround({{1, 2, 3, 4, 1}}).sigma_yaw, 10);
  EXPECT_GT(AlignToGround({{1, 2, 3, 4, 1}, {1, 2, 4, 4, 1}, {1, 2, 3, 5, 1}}).sigma_yaw, 10);
}

// The plane of the fixes and the projection of world file and KML are one, to what the header says;
// two independent ways there (GeographicLib's series, Earth-centred coordinates).
TEST(Geodetic, AgreesWithTheProjection) {
  for (const double height : {0.0, 260.0, 3000.0})
    for (const double x : {-3500.0, 0.0, 20.0, 3500.0})
      for (const double y : {-3500.0, 15.0, 3500.0}) {
        const Geodetic datum{42.293, -83.711, height};
        const Geodetic place = GeodeticOf(datum, x, y);
        const double numbers[2][3] = {{place.latitude, place.longitude, place.height},
                                      {datum.latitude, datum.longitude, datum.height}};
        const Eigen::Vector3d ground = EastNorthUp(numbers[0], numbers[1]);
        EXPECT_NEAR(ground.x(), x, 5e-3);
        EXPECT_NEAR(ground.y(), y, 5e-3);
      }
}

const SimulatedMission& Simulated() {
  static const SimulatedMission simulated = [] {
    MissionOptions options;
    options.town.width_m = options.town.height_m = 60;
    options.robots = 2;
    options.duration_s = 150;
    options.people = options.vehicles = 0;
    return SimulateMission(Builtins(), options);
  }();
  return simulated;
}

// The mission as a front end leaves it: solved, in a frame of its own, the first pose held.
Mission InAFrameOfItsOwn() {
  Mission mission = Simulated().mission;
  Graph graph(mission.graph.Types());
  for (VariableId id = 0; id < mission.graph.VariableCount(); ++id) {
    const Span<const double> value = mission.graph.ValueOf(id);
    const PlanarPose pose = Inverse(kTurned) * PlanarPose{value[0], value[1], value[2]};
    graph.Add(mission.graph.KeyOf(id), "se2/1", {pose.x, pose.y, pose.yaw}, id == 0);
  }
  for (FactorId id = 0; id < mission.graph.FactorCount(); ++id) {
    Factor factor = mission.graph.FactorRecord(id);
    if (factor.type == "prior_se2/1") {
      const std::vector<double>& m = factor.measurement;
      const PlanarPose pose = Inverse(kTurned) * PlanarPose{m[0], m[1], m[2]};
      factor.measurement = {pose.x, pose.y, pose.yaw};
    }
    graph.Add(factor);
  }
  mission.graph = std::move(graph);
  mission.graph.SetValues(Solve(mission.graph, {}).values);
  return mission;
}

double MeanError(const Mission& mission) {
  double sum = 0;
  for (const MissionNode& node : mission.nodes) {
    const PlanarPose& truth = Simulated().world_from_robot[node.scan];
    const Span<const double> value = mission.graph.ValueOf(node.variable);
    sum += std::hypot(value[0] - truth.x, value[1] - truth.y);
  }
  return sum / static_cast<double>(mission.nodes.size());
}

GnssReport Lay(const std::vector<GnssFix>& fixes, Mission* mission, GnssOptions options = {}) {
  if (!options.datum) options.datum = kAnnArbor;
  return AddGnss(fixes, "gnss.csv", TracksOfNodes(*mission), options, mission);
}

TEST(Gnss, LaysAMissionEastAndNorthOfTheDatum) {
  Mission mission = InAFrameOfItsOwn();
  EXPECT_GT(MeanError(mission), 20);
  const auto fixes = SimulateGnss(Simulated(), kAnnArbor, 2, 0.5, 0, 1);
  const GnssReport report = Lay(fixes, &mission);
  EXPECT_EQ(report.used + report.outside, fixes.size());
  EXPECT_EQ(report.off, 0u);
  EXPECT_NEAR(report.rms_m, 0.5 * std::sqrt(2.0), 0.12);
  // 75 fixes a robot leave 0.06 m and 0.4 degrees; the bent ways a little more.
  EXPECT_LT(MeanError(mission), 0.3);
  ASSERT_TRUE(mission.datum);
  EXPECT_EQ(mission.datum->latitude, kAnnArbor.latitude);
  EXPECT_EQ(DatumOf(mission.graph)->longitude, kAnnArbor.longitude);
  for (VariableId id = 0; id < mission.graph.VariableCount(); ++id)
    EXPECT_FALSE(mission.graph.IsFixed(id));
}

TEST(Gnss, IsNotMovedByBadFixes) {
  Mission good = InAFrameOfItsOwn(), bad = good;
  Lay(SimulateGnss(Simulated(), kAnnArbor, 2, 0.5, 0, 1), &good);
  for (const std::size_t count : {1u, 15u}) {
    bad = InAFrameOfItsOwn();
    const GnssReport report = Lay(SimulateGnss(Simulated(), kAnnArbor, 2, 0.5, count, 1), &bad);
    EXPECT_EQ(report.off, count);
    EXPECT_LT(MeanError(bad), MeanError(good) + 0.1) << count;
  }
}

// The antenna is 1 m ahead and 0.5 m to the left of the robot's centre.
TEST(Gnss, TakesTheAntennasPlaceIntoAccount) {
  auto fixes = SimulateGnss(Simulated(), kAnnArbor, 2, 0.01, 0, 1);
  std::size_t fix = 0;
  for (std::size_t i = 0; i < Simulated().mission.log.scans.size() && fix < fixes.size(); ++i) {
    const LaserScan& scan = Simulated().mission.log.scans[i];
    if (scan.time != fixes[fix].time ||
        Simulated().mission.log.robots[scan.robot] != fixes[fix].robot)
      continue;
    double x = 0, y = 0;
    Simulated().world_from_robot[i].Transform(1, 0.5, &x, &y);
    fixes[fix].antenna = GeodeticOf(kAnnArbor, x, y);
    fixes[fix++].sigma_m = 0.05;
  }
  ASSERT_EQ(fix, fixes.size());
  Mission right = InAFrameOfItsOwn(), wrong = right;
  GnssOptions options;
  options.antenna_x = 1;
  options.antenna_y = 0.5;
  Lay(fixes, &right, options);
  Lay(fixes, &wrong);
  EXPECT_LT(MeanError(right), 0.1);
  EXPECT_GT(MeanError(wrong), 0.2);
}

// Each graph of its sequence is determined, from the first fix on, and the last is the whole.
TEST(Gnss, LeavesASequenceOfGraphs) {
  Mission mission = InAFrameOfItsOwn();
  Lay(SimulateGnss(Simulated(), kAnnArbor, 5, 0.5, 1, 1), &mission);
  MissionReplay replay(mission, 30);
  MissionStep step;
  while (replay.Next(&step)) {
    const Solution solved = Solve(replay.Problem(), {});
    EXPECT_EQ(solved.report.termination, Termination::kConverged) << step.nodes;
  }
  for (std::size_t i = 0; i < step.nodes; ++i) {
    const Span<const double> value = mission.graph.ValueOf(mission.nodes[i].variable);
    EXPECT_NEAR(step.world_from_robot[i].x, value[0], 1e-4);
  }
}

TEST(Gnss, SaysWhyFixesAreOfNoUse) {
  const auto refusal = [](std::vector<GnssFix> fixes) -> std::string {
    Mission mission = InAFrameOfItsOwn();
    for (std::size_t i = 0; i < fixes.size(); ++i) fixes[i].line = i + 2;
    try {
      Lay(fixes, &mission);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  auto fixes = SimulateGnss(Simulated(), kAnnArbor, 2, 0.5, 0, 1);
  auto other = fixes;
  other[3].robot = "nobody";
  EXPECT_NE(refusal(other).find("gnss.csv:5:1: there is no robot nobody"), std::string::npos);
  other = fixes;
  for (GnssFix& fix : other) fix.time += 1e6;
  EXPECT_NE(refusal(other).find("one clock"), std::string::npos);
  EXPECT_NE(refusal({fixes[0], fixes[2]}).find("too close together"), std::string::npos);
  other = fixes;
  RandomNumbers random(1);
  for (GnssFix& fix : other) fix.antenna.latitude += random.Uniform(-0.001, 0.001);
  EXPECT_NE(refusal(other).find("agree with its way"), std::string::npos);
}

}  // namespace
}  // namespace graticule
