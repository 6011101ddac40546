#include "graticule/problems/mapping/simulate_gnss.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/random.hpp"

namespace graticule {
namespace {

constexpr double kBad = 50;  // m

}  // namespace

std::vector<GnssFix> SimulateGnss(const SimulatedMission& simulated, const Geodetic& datum,
                                  double every_s, double sigma_m, std::size_t bad,
                                  std::uint64_t seed) {
  const GeographicLib::LocalCartesian local(datum.latitude, datum.longitude, datum.height);
  RandomNumbers noise(seed, 17);
  const LaserLog& log = simulated.mission.log;
  std::vector<double> next(log.robots.size(), -std::numeric_limits<double>::infinity());
  std::vector<std::size_t> scans;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    double& due = next[log.scans[i].robot];
    if (log.scans[i].time < due) continue;
    due = log.scans[i].time + every_s;
    scans.push_back(i);
  }
  bad = std::min(bad, scans.size());
  std::vector<GnssFix> fixes;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const LaserScan& scan = log.scans[scans[i]];
    const PlanarPose& pose = simulated.world_from_robot[scans[i]];
    double east = pose.x + sigma_m * noise.Normal(), north = pose.y + sigma_m * noise.Normal();
    const double up = sigma_m * noise.Normal(), direction = noise.Uniform(0, 2 * M_PI);
    // Evenly spread: fix i is bad where another bad one is due by then.
    if ((i + 1) * bad / scans.size() > i * bad / scans.size()) {
      east += kBad * std::cos(direction);
      north += kBad * std::sin(direction);
    }
    GnssFix fix;
    fix.time = scan.time;
    fix.robot = log.robots[scan.robot];
    local.Reverse(east, north, up, fix.antenna.latitude, fix.antenna.longitude, fix.antenna.height);
    fix.sigma_m = sigma_m;
    fixes.push_back(fix);
  }
  return fixes;
}

}  // namespace graticule
