#include "graticule/problems/mapping/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "graticule/factors/make.hpp"
#include "graticule/problems/mapping/route.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Point = RoutePlanner::Point;

// One stream a purpose: the same town and the same ways whatever the noise.
enum Stream : std::uint64_t { kWays, kCrowd, kOdometry, kLaser, kMatches };

constexpr double kTick = 0.1;  // s, of driving
constexpr double kTurnRate = 1.0, kRobotRadius = 0.35;

void Check(const MissionOptions& o) {
  const auto demand = [](bool fine, const char* what) {
    if (!fine) throw Error(std::string("simulated mission: expected ") + what, ErrorKind::kUsage);
  };
  demand(o.robots >= 1 && o.robots <= 1000, "1 to 1000 robots");
  demand(o.scan_every_s >= kTick && o.duration_s >= o.scan_every_s && o.duration_s <= 1e6,
         "a scan every 0.1 s at most, and a duration of one scan to 1e6 s");
  demand(o.speed_m_s > 0, "a speed above 0");
  demand(o.node_every_m > 0 && o.node_every_rad > 0, "nodes a distance above 0 apart");
  demand(o.beams >= 2 && o.beams <= 10000, "2 to 10000 beams");
  demand(o.max_range_m > 0 && o.range_sigma_m >= 0 && o.no_return >= 0 && o.no_return <= 1,
         "ranges above 0, and a share without return of 0 to 1");
  demand(o.match_sigma_m > 0 && o.match_sigma_rad > 0 && o.closure_range_m >= 0,
         "standard deviations above 0");
  demand(o.people >= 0 && o.vehicles >= 0, "people and vehicles of 0 or more");
}

// Somebody who goes to and fro on a way, as discs.
class Walker {
 public:
  Walker(std::vector<Point> way, double speed, double radius, double tail, double phase)
      : way_(std::move(way)), speed_(speed), radius_(radius), tail_(tail), phase_(phase) {
    for (std::size_t i = 0; i + 1 < way_.size(); ++i)
      length_ += std::hypot(way_[i + 1].x - way_[i].x, way_[i + 1].y - way_[i].y);
  }
  double Radius() const { return radius_; }
  template <class Visit>
  void Discs(double time, const Visit& visit) const {
    visit(At(time * speed_ + phase_));
    if (tail_ > 0) visit(At(time * speed_ + phase_ - tail_));
  }

 private:
  Point At(double driven) const {
    if (length_ <= 0) return way_.front();
    double along = std::fmod(std::abs(driven), 2 * length_);
    if (along > length_) along = 2 * length_ - along;
    for (std::size_t i = 0; i + 1 < way_.size(); ++i) {
      const double leg = std::hypot(way_[i + 1].x - way_[i].x, way_[i + 1].y - way_[i].y);
      if (along <= leg && leg > 0)
        return {way_[i].x + along / leg * (way_[i + 1].x - way_[i].x),
                way_[i].y + along / leg * (way_[i + 1].y - way_[i].y)};
      along -= leg;
    }
    return way_.back();
  }

  std::vector<Point> way_;
  double speed_, radius_, tail_, phase_, length_ = 0;
};

struct Robot {
  PlanarPose world_from_robot, odom_from_robot;
  std::vector<Point> way;
  std::size_t next = 0;
  std::vector<Point> visited;
  PlanarPose last_true, last_odometry;  // at its last node
  std::size_t nodes = 0;
};

class MissionSimulation {
 public:
  MissionSimulation(const Registry& types, const MissionOptions& options)
      : options_(options),
        planner_((Check(options), simulated_.town = MakeTown(options.town), simulated_.town.grid),
                 kRobotRadius),
        ways_(options.seed, kWays),
        odometry_(options.seed, kOdometry),
        laser_(options.seed, kLaser),
        matches_(options.seed, kMatches) {
    simulated_.mission.graph = Graph(types);
    if (planner_.Places().size() < 2)
      throw Error("simulated mission: the town has no room to drive", ErrorKind::kUsage);
  }

  SimulatedMission Run() {
    simulated_.is_swept.assign(simulated_.town.grid.cells.size(), 0);
    Populate();
    PlaceRobots();
    const auto scans = static_cast<std::size_t>(options_.duration_s / options_.scan_every_s + 1e-9);
    for (std::size_t k = 0; k <= scans; ++k) {
      const double time = static_cast<double>(k) * options_.scan_every_s;
      if (k > 0) Drive();
      Sweep(time);
      for (std::size_t r = 0; r < robots_.size(); ++r) TakeScan(r, time);
    }
    return std::move(simulated_);
  }

 private:
  Point AnyPlace(RandomNumbers* random, const RoutePlanner& planner) const {
    return planner.Places()[random->Below(planner.Places().size())];
  }

  void Populate() {
    RandomNumbers random(options_.seed, kCrowd);
    const auto add = [&](const RoutePlanner& planner, int count, double speed, double radius,
                         double tail) {
      for (int i = 0; i < count && !planner.Places().empty(); ++i) {
        const Point from = AnyPlace(&random, planner);
        std::vector<Point> way = planner.Route(from, AnyPlace(&random, planner));
        if (way.empty()) way.push_back(from);
        walkers_.emplace_back(std::move(way), speed * random.Uniform(0.7, 1.3), radius, tail,
                              random.Uniform(0, 100));
      }
    };
    add(planner_, options_.people, 1.2, 0.25, 0);
    if (options_.vehicles > 0)
      add(RoutePlanner(simulated_.town.grid, 1.6, 0.8), options_.vehicles, 4, 0.9, 1.8);
  }

  void PlaceRobots() {
    // In a row by the gate, as a team starts.
    const double gate = 0.5 * options_.town.street_m;
    for (int i = 0; i < options_.robots; ++i) {
      const Point wanted{gate + 1.5 * static_cast<double>(i % 10),
                         gate + 1.5 * static_cast<double>(i / 10)};
      const std::vector<Point> start = planner_.Route(wanted, wanted);
      Robot robot;
      robot.world_from_robot = {start.front().x, start.front().y, 0};
      robots_.push_back(robot);
      simulated_.mission.log.robots.push_back("robot" + std::to_string(i + 1));
    }
    LaserGeometry geometry;
    geometry.first_angle = -M_PI / 2;
    geometry.step = M_PI / (options_.beams - 1);
    geometry.max_range = options_.max_range_m;
    geometry.robot_from_laser = {0.1, 0, 0};
    simulated_.mission.log.geometries.push_back(geometry);
  }

  // Towards where the team has been least.
  void ChooseWay(Robot* robot) {
    const Point here{robot->world_from_robot.x, robot->world_from_robot.y};
    Point best = here;
    double farthest = -1;
    for (int i = 0; i < 8; ++i) {
      const Point place = AnyPlace(&ways_, planner_);
      double nearest = 40;
      for (const Robot& other : robots_)
        for (const Point& visited : other.visited)
          nearest = std::min(nearest, std::hypot(visited.x - place.x, visited.y - place.y));
      // Near places first, where both are new.
      const double worth = nearest - 0.15 * std::hypot(place.x - here.x, place.y - here.y);
      if (i > 0 && worth <= farthest) continue;
      farthest = worth;
      best = place;
    }
    robot->way = planner_.Route(here, best);
    robot->next = 1;
    robot->visited.push_back(best);
  }

  void Drive() {
    for (Robot& robot : robots_) {
      PlanarPose& pose = robot.world_from_robot;
      const PlanarPose before = pose;
      double driven = 0, turned = 0;
      for (double t = 0; t < options_.scan_every_s - 1e-9; t += kTick) {
        if (robot.next >= robot.way.size()) ChooseWay(&robot);
        if (robot.next >= robot.way.size()) break;
        const Point& goal = robot.way[robot.next];
        const double away = std::hypot(goal.x - pose.x, goal.y - pose.y);
        if (away < 1e-6) {
          ++robot.next;
          continue;
        }
        const double off = WrappedAngle(std::atan2(goal.y - pose.y, goal.x - pose.x) - pose.yaw);
        const double turn = std::clamp(off, -kTurnRate * kTick, kTurnRate * kTick);
        pose.yaw = WrappedAngle(pose.yaw + turn);
        turned += std::abs(turn);
        if (std::abs(off - turn) > 1e-9) continue;
        const double step = std::min(away, options_.speed_m_s * kTick);
        pose.x += step * std::cos(pose.yaw);
        pose.y += step * std::sin(pose.yaw);
        driven += step;
        if (step == away) ++robot.next;
      }
      // What the wheels say of it.
      PlanarPose moved = Inverse(before) * pose;
      const double root = std::sqrt(driven);
      moved.x += options_.odometry_sigma * driven * odometry_.Normal();
      moved.y += options_.odometry_sigma * driven * odometry_.Normal();
      moved.yaw += options_.odometry_sigma_rad_m * root * odometry_.Normal() +
                   options_.odometry_sigma_turn * turned * odometry_.Normal();
      robot.odom_from_robot = robot.odom_from_robot * moved;
    }
  }

  void Sweep(double time) {
    const OccupancyGrid& grid = simulated_.town.grid;
    for (const Walker& walker : walkers_)
      for (double t = time; t < time + options_.scan_every_s - 1e-9; t += kTick)
        walker.Discs(t, [&](const Point& at) {
          const auto index = [&](double metres, std::size_t count) {
            return static_cast<std::size_t>(
                std::clamp(metres / grid.resolution, 0.0, static_cast<double>(count - 1)));
          };
          const double reach = walker.Radius();
          for (std::size_t y = index(at.y - reach, grid.height);
               y <= index(at.y + reach, grid.height); ++y)
            for (std::size_t x = index(at.x - reach, grid.width);
                 x <= index(at.x + reach, grid.width); ++x) {
              const double dx = (static_cast<double>(x) + 0.5) * grid.resolution - at.x;
              const double dy = (static_cast<double>(y) + 0.5) * grid.resolution - at.y;
              if (dx * dx + dy * dy <= reach * reach) simulated_.is_swept[y * grid.width + x] = 1;
            }
        });
  }

  void TakeScan(std::size_t r, double time) {
    Robot& robot = robots_[r];
    LaserLog& log = simulated_.mission.log;
    const LaserGeometry& geometry = log.geometries.front();
    const PlanarPose laser = robot.world_from_robot * geometry.robot_from_laser;
    // Who stands about, seen from the laser.
    struct Disc {
      double x, y, radius;
    };
    std::vector<Disc> discs;
    const auto add = [&](const Point& at, double radius) {
      const double dx = at.x - laser.x, dy = at.y - laser.y;
      const double away = std::hypot(dx, dy);
      if (away < options_.max_range_m + radius && away > radius) discs.push_back({dx, dy, radius});
    };
    for (const Walker& walker : walkers_)
      walker.Discs(time, [&](const Point& at) { add(at, walker.Radius()); });
    for (std::size_t other = 0; other < robots_.size(); ++other)
      if (other != r)
        add({robots_[other].world_from_robot.x, robots_[other].world_from_robot.y}, 0.3);

    LaserScan scan;
    scan.time = time;
    scan.robot = static_cast<std::uint32_t>(r);
    scan.odom_from_robot = robot.odom_from_robot;
    scan.first_range = log.ranges.size();
    scan.beams = static_cast<std::uint32_t>(options_.beams);
    for (int i = 0; i < options_.beams; ++i) {
      const double angle = laser.yaw + geometry.first_angle + i * geometry.step;
      double range = CastRay(simulated_.town.grid, laser.x, laser.y, angle, options_.max_range_m);
      const double c = std::cos(angle), s = std::sin(angle);
      for (const Disc& disc : discs) {
        const double along = c * disc.x + s * disc.y, across = c * disc.y - s * disc.x;
        if (along <= 0 || std::abs(across) >= disc.radius) continue;
        range = std::min(range, along - std::sqrt(disc.radius * disc.radius - across * across));
      }
      range += options_.range_sigma_m * laser_.Normal();
      const bool is_lost = laser_.Unit() < options_.no_return;
      const bool returns = !is_lost && range < options_.max_range_m;
      log.ranges.push_back(
          static_cast<float>(returns ? std::max(range, 0.02) : options_.max_range_m));
    }
    log.scans.push_back(scan);
    simulated_.world_from_robot.push_back(robot.world_from_robot);
    AddNode(r);
  }

  PlanarPose Noisy(const PlanarPose& measured) {
    const double m = options_.match_sigma_m, rad = options_.match_sigma_rad;
    const PlanarPose error{m * matches_.Normal(), m * matches_.Normal(), rad * matches_.Normal()};
    return measured * error;
  }

  // A node where the robot has moved far enough, tied to the one before and to those around it.
  void AddNode(std::size_t r) {
    Robot& robot = robots_[r];
    const std::size_t scan = simulated_.mission.log.scans.size() - 1;
    const PlanarPose moved = Inverse(robot.last_true) * robot.world_from_robot;
    if (robot.nodes > 0 && std::hypot(moved.x, moved.y) < options_.node_every_m &&
        std::abs(moved.yaw) < options_.node_every_rad)
      return;
    Graph& graph = simulated_.mission.graph;
    const std::string& name = simulated_.mission.log.robots[r];
    const Key key(name, robot.nodes);
    const PlanarPose start = robot.nodes > 0 ? robot.last_odometry : robot.world_from_robot;
    const PlanarPose guess =
        robot.nodes > 0 ? guesses_[r] * (Inverse(robot.last_odometry) * robot.odom_from_robot)
                        : start;
    const VariableId variable = graph.Add(key, "se2/1", {guess.x, guess.y, guess.yaw});
    const Noise match =
        Noise::Sigmas({options_.match_sigma_m, options_.match_sigma_m, options_.match_sigma_rad});
    if (robot.nodes == 0) {
      simulated_.mission.starts.resize(robots_.size());
      simulated_.mission.starts[r] = start;
      graph.Add(PriorSe2Factor(key, {guess.x, guess.y, guess.yaw}, Noise::Sigmas({0.3, 0.3, 0.03}),
                               "start"));
    } else {
      const PlanarPose z = Noisy(moved);
      graph.Add(
          BetweenSe2Factor(Key(name, robot.nodes - 1), key, {z.x, z.y, z.yaw}, match, "scan"));
    }
    AddClosures(r, key, match);
    known_[{CellOf(robot.world_from_robot.x), CellOf(robot.world_from_robot.y)}].push_back(
        {robot.world_from_robot, static_cast<std::uint32_t>(r), robot.nodes});
    simulated_.mission.nodes.push_back({variable, scan});
    guesses_.resize(robots_.size());
    guesses_[r] = guess;
    robot.last_true = robot.world_from_robot;
    robot.last_odometry = robot.odom_from_robot;
    ++robot.nodes;
  }

  // Of cells as wide as closures reach.
  std::size_t CellOf(double metres) const {
    return static_cast<std::size_t>(metres / std::max(options_.closure_range_m, 0.1));
  }

  // With the nearest node of each robot that looked the same way and sees us, old enough.
  void AddClosures(std::size_t r, const Key& key, const Noise& match) {
    const PlanarPose& here = robots_[r].world_from_robot;
    std::vector<const Known*> nearest(robots_.size(), nullptr);
    std::vector<double> least(robots_.size(), options_.closure_range_m);
    const auto look = [&](const Known& node) {
      const double away = std::hypot(node.pose.x - here.x, node.pose.y - here.y);
      if (away >= least[node.robot]) return;
      if (node.robot == r && robots_[r].nodes - node.number < 20) return;
      if (std::abs(WrappedAngle(node.pose.yaw - here.yaw)) > 1) return;
      least[node.robot] = away;
      nearest[node.robot] = &node;
    };
    const std::size_t column = CellOf(here.x), row = CellOf(here.y);
    for (std::size_t y = row - std::min<std::size_t>(row, 1); y <= row + 1; ++y)
      for (std::size_t x = column - std::min<std::size_t>(column, 1); x <= column + 1; ++x)
        if (const auto cell = known_.find({x, y}); cell != known_.end())
          for (const Known& node : cell->second) look(node);
    for (std::size_t other = 0; other < nearest.size(); ++other) {
      if (!nearest[other]) continue;
      const PlanarPose& there = nearest[other]->pose;
      const PlanarPose& now = robots_[other].world_from_robot;
      if (std::hypot(now.x - here.x, now.y - here.y) > options_.radio_range_m) continue;
      const double bearing = std::atan2(there.y - here.y, there.x - here.x);
      if (CastRay(simulated_.town.grid, here.x, here.y, bearing, least[other]) < least[other])
        continue;
      if (matches_.Unit() < 0.5) continue;  // not all are found
      const PlanarPose z = Noisy(Inverse(there) * here);
      simulated_.mission.graph.Add(
          BetweenSe2Factor(Key(simulated_.mission.log.robots[other], nearest[other]->number), key,
                           {z.x, z.y, z.yaw}, match, "loop"));
    }
  }

  struct Known {
    PlanarPose pose;
    std::uint32_t robot;
    std::size_t number;
  };

  const MissionOptions& options_;
  SimulatedMission simulated_{{{}, Graph(Registry()), {}}, {}, {}, {}};
  RoutePlanner planner_;
  RandomNumbers ways_, odometry_, laser_, matches_;
  std::vector<Walker> walkers_;
  std::vector<Robot> robots_;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Known>> known_;  // by cell
  std::vector<PlanarPose> guesses_;  // of each robot's last node
};

}  // namespace

SimulatedMission SimulateMission(const Registry& types, const MissionOptions& options) {
  return MissionSimulation(types, options).Run();
}

MissionOptions KeswickLike() {
  MissionOptions options;
  options.town.width_m = options.town.height_m = 150;
  options.robots = 10;
  options.duration_s = 680;
  options.people = 20;
  options.vehicles = 4;
  return options;
}

MissionOptions Phase2Like() {
  MissionOptions options;
  options.town.width_m = 220;
  options.town.height_m = 160;
  options.robots = 14;
  options.duration_s = 4290;
  options.scan_every_s = 2;
  options.people = 40;
  options.vehicles = 8;
  return options;
}

}  // namespace graticule
