#include "graticule/problems/attenuation/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "graticule/problems/attenuation/simulate_explore.hpp"
#include "graticule/problems/attenuation/simulate_team.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

/// Positions and strengths as files have them: what is written reads back the same.
double Rounded(double value, double unit) { return std::round(value / unit) * unit; }

}  // namespace

void SignalMissionOptions::Check() const {
  const auto refuse = [](const std::string& what) { throw Error(what, ErrorKind::kUsage); };
  if (robots < 2 || robots > 100) refuse("a signal needs 2 robots at least, and 100 at most");
  if (!(rate_hz > 0) || rate_hz > 1000) refuse("the rate of packets is above 0 and up to 1000 Hz");
  if (!(place.duration_s > 0) || place.duration_s > 1e5)
    refuse("a mission lasts longer than 0 s and up to 100000 s");
  if (!(speed_m_s >= 0)) refuse("a robot's speed is not below 0");
  if (radio.diversity < 1) refuse("a band has one part at least");
}

SimulatedSignal SimulateSignal(const SignalMissionOptions& options) {
  options.Check();
  SimulatedSignal result;
  result.plan = MakeFloorPlan(options.place);
  const OccupancyGrid truth = result.plan.Occupied();
  Exploration team(truth, options.robots, options.speed_m_s, options.scan_range_m, options.seed);
  const auto robots = static_cast<std::size_t>(options.robots);
  TeamRadios radios(result.plan, options.radio, robots, options.place.seed, options.seed);
  result.trajectories.resize(robots);

  const double tick_s = 1 / options.rate_hz;
  const auto ticks = static_cast<std::int64_t>(options.place.duration_s * options.rate_hz);
  double next_scan_s = 0, next_map_s = options.map_every_s, next_pose_s = 0;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double time_s = Rounded(static_cast<double>(tick) * tick_s, 1e-6);
    if (tick > 0) team.Drive(tick_s);
    if (time_s >= next_scan_s) {
      team.Scan();
      next_scan_s += options.scan_every_s;
    }
    if (options.map_every_s > 0 && time_s >= next_map_s) {
      result.maps.push_back({time_s, std::make_shared<const OccupancyGrid>(team.Map())});
      next_map_s += options.map_every_s;
    }
    std::vector<Eigen::Vector3d> at;
    for (const Eigen::Vector2d& position : team.Positions())
      at.emplace_back(Rounded(position.x(), 1e-3), Rounded(position.y(), 1e-3), options.height_m);
    if (time_s >= next_pose_s) {
      for (std::size_t i = 0; i < robots; ++i)
        result.trajectories[i].push_back(StampPlanar(time_s, {at[i].x(), at[i].y(), 0}));
      next_pose_s += 1;
    }
    radios.Send(time_s, at, team.Driven(), tick_s);
  }
  result.log = radios.Log();
  result.bias_db = radios.BiasDb();
  result.sending_bias_db = radios.SendingBiasDb();
  result.listening_bias_db = radios.ListeningBiasDb();
  result.log.has_height = options.height_m != 0;
  result.map = std::make_shared<const OccupancyGrid>(team.Map());
  result.maps.push_back({options.place.duration_s, result.map});
  return result;
}

std::vector<TrueAttenuation> TrueAttenuations(const FloorPlan& plan, const OccupancyGrid& map,
                                              double coarse_m) {
  std::map<std::tuple<Occupancy, std::int32_t, std::int32_t>, std::pair<double, std::size_t>> sums;
  for (std::size_t y = 0; y < plan.height; ++y)
    for (std::size_t x = 0; x < plan.width; ++x) {
      const auto coarse = [&](std::size_t i) {
        return static_cast<std::int32_t>((static_cast<double>(i) + 0.5) * plan.resolution /
                                         coarse_m);
      };
      auto& [sum, count] = sums[{map.At(x, y), coarse(x), coarse(y)}];
      sum += LossOf(plan.At(x, y)).db_per_m;
      ++count;
    }
  std::vector<TrueAttenuation> result;
  for (const auto& [where, sum] : sums)
    result.push_back({std::get<0>(where), std::get<1>(where), std::get<2>(where),
                      sum.first / static_cast<double>(sum.second), sum.second});
  return result;
}

}  // namespace graticule
