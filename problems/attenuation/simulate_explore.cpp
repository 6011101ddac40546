#include "graticule/problems/attenuation/simulate_explore.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kClearance_m = 0.35;
constexpr double kApart_m = 15;  // how much further a robot goes not to meet another
constexpr int kBeams = 360;

}  // namespace

Exploration::Exploration(const OccupancyGrid& truth, int robots, double speed_m_s,
                         double scan_range_m, std::uint64_t seed)
    : truth_(truth),
      planner_(truth, kClearance_m),
      speed_m_s_(speed_m_s),
      scan_range_m_(scan_range_m),
      random_(seed, 2),
      map_(truth) {
  std::fill(map_.cells.begin(), map_.cells.end(), Occupancy::kUnknown);
  const auto& places = planner_.Places();
  if (places.size() < static_cast<std::size_t>(robots))
    throw Error("the place leaves no room for robots", ErrorKind::kUsage);
  // All start near one end of the place, two metres apart where that can be.
  std::vector<std::size_t> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return places[a].x + places[a].y < places[b].x + places[b].y;
  });
  for (const double apart : {2.0, 1.0, 0.0})
    for (const std::size_t i : order) {
      if (positions_.size() == static_cast<std::size_t>(robots)) break;
      const Eigen::Vector2d at(places[i].x, places[i].y);
      if (std::all_of(positions_.begin(), positions_.end(),
                      [&](const Eigen::Vector2d& other) { return (other - at).norm() >= apart; }))
        positions_.push_back(at);
    }
  goals_ = positions_;
  ways_.resize(positions_.size());
  driven_.resize(positions_.size(), 0);
}

bool Exploration::IsKnown(double x, double y) const {
  const auto cx = static_cast<std::size_t>(x / map_.resolution);
  const auto cy = static_cast<std::size_t>(y / map_.resolution);
  return cx >= map_.width || cy >= map_.height || map_.At(cx, cy) != Occupancy::kUnknown;
}

void Exploration::ChooseGoal(std::size_t robot) {
  const auto& places = planner_.Places();
  const Eigen::Vector2d& here = positions_[robot];
  double least = HUGE_VAL;
  std::size_t best = places.size();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (IsKnown(places[i].x, places[i].y)) continue;
    const Eigen::Vector2d at(places[i].x, places[i].y);
    double cost = (at - here).norm();
    for (std::size_t other = 0; other < goals_.size(); ++other)
      if (other != robot) cost += kApart_m * std::exp(-(goals_[other] - at).norm() / kApart_m);
    if (cost < least) {
      least = cost;
      best = i;
    }
  }
  if (best == places.size()) best = random_.Below(places.size());  // all is known: go anywhere
  goals_[robot] = {places[best].x, places[best].y};
  ways_[robot] = planner_.Route({here.x(), here.y()}, places[best]);
  std::reverse(ways_[robot].begin(), ways_[robot].end());
}

void Exploration::Drive(double seconds) {
  for (std::size_t robot = 0; robot < positions_.size(); ++robot) {
    if (ways_[robot].empty()) ChooseGoal(robot);
    double left = speed_m_s_ * seconds;
    while (left > 0 && !ways_[robot].empty()) {
      const Eigen::Vector2d next(ways_[robot].back().x, ways_[robot].back().y);
      const Eigen::Vector2d way = next - positions_[robot];
      if (way.norm() <= left) {
        positions_[robot] = next;
        left -= way.norm();
        ways_[robot].pop_back();
      } else {
        positions_[robot] += way * (left / way.norm());
        left = 0;
      }
    }
    driven_[robot] = speed_m_s_ * seconds - left;
  }
}

void Exploration::Scan() {
  const double step = 0.7 * map_.resolution;
  for (const Eigen::Vector2d& from : positions_) {
    const double first = random_.Uniform(0, 2 * M_PI / kBeams);
    for (int beam = 0; beam < kBeams; ++beam) {
      const double angle = first + 2 * M_PI * beam / kBeams;
      const double dx = std::cos(angle) * step, dy = std::sin(angle) * step;
      double x = from.x(), y = from.y();
      for (double range = 0; range < scan_range_m_; range += step, x += dx, y += dy) {
        if (x < 0 || y < 0) break;
        const auto cx = static_cast<std::size_t>(x / map_.resolution);
        const auto cy = static_cast<std::size_t>(y / map_.resolution);
        if (cx >= map_.width || cy >= map_.height) break;
        const std::size_t cell = cy * map_.width + cx;
        map_.cells[cell] = truth_.cells[cell];
        if (truth_.cells[cell] == Occupancy::kStructure) break;
      }
    }
  }
  // What was to be seen has been seen: look for more.
  for (std::size_t robot = 0; robot < positions_.size(); ++robot)
    if (!ways_[robot].empty() && IsKnown(goals_[robot].x(), goals_[robot].y()) &&
        (goals_[robot] - positions_[robot]).norm() > 3 && random_.Unit() < 0.2)
      ways_[robot].clear();
}

}  // namespace graticule
