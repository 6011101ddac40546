#include "graticule/problems/urban/town_radio.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/attenuation/simulate_team.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

Filling FillingOf(TownThing thing) {
  switch (thing) {
    case TownThing::kOpen:
      break;
    case TownThing::kWall:
      return Filling::kConcreteWall;
    case TownThing::kPartition:
      return Filling::kBlockWall;
    case TownThing::kFurniture:
      return Filling::kFurniture;
    case TownThing::kTree:
      return Filling::kTrunk;
    case TownThing::kCar:
      return Filling::kCar;
  }
  return Filling::kAir;
}

struct Stop {
  double time_s;
  Eigen::Vector3d at_m;
};

constexpr std::uint64_t kLinkStream = 5;

// To a millimetre, as signal logs have them.
Eigen::Vector3d Rounded(const Eigen::Vector3d& at_m) {
  return (1000 * at_m).array().round() / 1000;
}

Eigen::Vector3d At(const std::vector<Stop>& stops, double time_s) {
  const auto after =
      std::upper_bound(stops.begin(), stops.end(), time_s,
                       [](double time, const Stop& stop) { return time < stop.time_s; });
  if (after == stops.begin()) return Rounded(stops.front().at_m);
  const Stop& before = *(after - 1);
  if (after == stops.end()) return Rounded(before.at_m);
  const double part = (time_s - before.time_s) / (after->time_s - before.time_s);
  return Rounded(before.at_m + part * (after->at_m - before.at_m));
}

SignalLog Unmeasured(const std::vector<std::vector<Stop>>& stops, std::uint64_t seed,
                     TeamRadios* radios) {
  constexpr std::size_t kLinks = 400, kTries = 20000;
  constexpr double kFarthest = 30;
  SignalLog log;
  log.radios = radios->Log().radios;
  log.has_time = false;
  RandomNumbers random(seed, kLinkStream);
  for (std::size_t i = 0; i < kTries && log.measurements.size() < kLinks; ++i) {
    const std::size_t from = random.Below(stops.size()), to = random.Below(stops.size());
    if (from == to) continue;
    SignalMeasurement measurement;
    SignalLink& link = measurement.link;
    link.transmitter = static_cast<std::uint32_t>(from);
    link.receiver = static_cast<std::uint32_t>(to);
    link.transmitter_m = Rounded(stops[from][random.Below(stops[from].size())].at_m);
    link.receiver_m = Rounded(stops[to][random.Below(stops[to].size())].at_m);
    if ((link.transmitter_m - link.receiver_m).norm() > kFarthest) continue;
    const double dbm = radios->ExpectedDbm(from, to, link.transmitter_m, link.receiver_m);
    measurement.dbm = std::round(100 * dbm) / 100;
    log.measurements.push_back(measurement);
  }
  return log;
}

}  // namespace

FloorPlan FloorPlanOf(const Town& town) {
  FloorPlan plan;
  plan.exponent = FloorPlan::kStreetExponent;
  plan.resolution = town.grid.resolution;
  plan.width = town.grid.width;
  plan.height = town.grid.height;
  for (const TownThing thing : town.things) plan.cells.push_back(FillingOf(thing));
  return plan;
}

TownSignal SimulateTownSignal(const SimulatedMission& mission, const RadioOptions& radio,
                              double rate_hz, std::uint64_t seed) {
  const LaserLog& log = mission.mission.log;
  const std::size_t robots = log.robots.size();
  if (robots < 2) throw Error("a signal needs 2 robots at least", ErrorKind::kUsage);
  if (!(rate_hz > 0) || rate_hz > 1000)
    throw Error("the rate of packets is above 0 and up to 1000 Hz", ErrorKind::kUsage);
  std::vector<std::vector<Stop>> stops(robots);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const PlanarPose& pose = mission.world_from_robot[i];
    stops[log.scans[i].robot].push_back({log.scans[i].time, {pose.x, pose.y, 0}});
  }
  TeamRadios radios(FloorPlanOf(mission.town), radio, robots, seed, seed);
  const double end_s = log.scans.back().time;
  std::vector<Eigen::Vector3d> before;
  for (std::int64_t tick = 0;; ++tick) {
    const double time_s = std::round(static_cast<double>(tick) / rate_hz * 1e6) / 1e6;
    if (time_s > end_s) break;
    std::vector<Eigen::Vector3d> at;
    std::vector<double> driven;
    for (std::size_t robot = 0; robot < robots; ++robot) {
      at.push_back(At(stops[robot], time_s));
      driven.push_back(tick > 0 ? (at[robot] - before[robot]).norm() : 0);
    }
    radios.Send(time_s, at, driven, 1 / rate_hz);
    before = at;
  }
  return {radios.Log(), radios.BiasDb(), radios.SendingBiasDb(), radios.ListeningBiasDb(),
          Unmeasured(stops, seed, &radios)};
}

}  // namespace graticule
