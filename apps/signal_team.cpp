#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/plan.hpp"
#include "graticule/problems/mapping/route.hpp"
#include "problem.hpp"
#include "signal_model.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kClearance_m = 0.3;
constexpr std::size_t kMostCandidates = 400;

/// The radios of a positions file, by name.
struct Team {
  std::vector<std::string> names;
  std::vector<std::uint32_t> radios;  ///< the model's numbers; beyond all where it knows none
  std::vector<Eigen::Vector3d> at_m;
};

Team LoadTeam(const std::string& path, const SignalModel& model) {
  Team team;
  auto next = static_cast<std::uint32_t>(model.radios.size());
  for (const auto& [name, at] : ParseAnchors(ReadFile(path), path)) {
    const std::uint32_t radio = model.RadioOf(name);
    team.names.push_back(name);
    team.radios.push_back(radio < model.radios.size() ? radio : next++);
    team.at_m.push_back(at);
  }
  if (team.names.size() < 2) throw Error(path + ": a team has two radios at least");
  return team;
}

/// Free places that the robot reaches, as many as are worth trying.
std::vector<Eigen::Vector3d> PlacesInReach(const OccupancyGrid& map, const Eigen::Vector3d& from,
                                           double reach_m) {
  // The planner's grid is upright with its corner at the origin.
  OccupancyGrid plain = map;
  plain.map_from_grid = {};
  for (Occupancy& cell : plain.cells)
    if (cell == Occupancy::kUnknown) cell = Occupancy::kStructure;
  const double c = std::cos(map.map_from_grid.yaw), s = std::sin(map.map_from_grid.yaw);
  const double dx = from.x() - map.map_from_grid.x, dy = from.y() - map.map_from_grid.y;
  const RoutePlanner::Point here{c * dx + s * dy, c * dy - s * dx};
  const RoutePlanner planner(plain, kClearance_m);
  std::vector<Eigen::Vector3d> near;
  for (const RoutePlanner::Point& place : planner.Places()) {
    if (std::hypot(place.x - here.x, place.y - here.y) > reach_m) continue;
    near.emplace_back(map.map_from_grid.x + c * place.x - s * place.y,
                      map.map_from_grid.y + s * place.x + c * place.y, from.z());
  }
  std::vector<Eigen::Vector3d> some;
  const std::size_t stride = near.size() / kMostCandidates + 1;
  for (std::size_t i = 0; i < near.size(); i += stride) {
    const double x = near[i].x() - map.map_from_grid.x, y = near[i].y() - map.map_from_grid.y;
    const RoutePlanner::Point place{c * x + s * y, c * y - s * x};
    if (!planner.Route(here, place, reach_m).empty()) some.push_back(near[i]);
  }
  return some;
}

}  // namespace

int Run(const SignalConnectCommand& command, const Console&) {
  const SignalModel model = LoadSignalModel(command.model, command.map);
  const Team team = LoadTeam(command.positions, model);
  const TeamConnectivity found = About(command.positions, [&] {
    return Connect(*model.predictor, team.radios, team.at_m, command.usable_dbm, model.now_s);
  });
  Json json = {{"schema", "graticule-signal-connectivity/1"},
               {"usable_dbm", command.usable_dbm},
               {"connected", found.connected},
               {"links", Json::array()}};
  if (!command.json)
    fmt::print("at {:g} dBm and more the team is connected with probability {:.3f}\n",
               command.usable_dbm, found.connected);
  for (std::size_t k = 0; k < found.links.size(); ++k) {
    const TeamLink& link = found.links[k];
    const bool is_backbone =
        std::find(found.backbone.begin(), found.backbone.end(), k) != found.backbone.end();
    json["links"].push_back({{"a", team.names[link.a]},
                             {"b", team.names[link.b]},
                             {"dbm", link.prediction.dbm},
                             {"sigma_db", link.prediction.sigma_db},
                             {"probability", link.probability},
                             {"backbone", is_backbone}});
    if (!command.json)
      fmt::print("  {:<12} {:<12} {:7.1f} dBm +- {:4.1f}  p {:.3f}{}\n", team.names[link.a],
                 team.names[link.b], link.prediction.dbm, link.prediction.sigma_db,
                 link.probability, is_backbone ? "  *" : "");
  }
  if (command.json)
    fmt::print("{}\n", JsonText(json, 1));
  else
    fmt::print("  * joins the team at the best product of probabilities\n");
  return kDone;
}

int Run(const SignalWhereCommand& command, const Console&) {
  if (command.map.empty()) throw Error("--map: places are looked for on a map", ErrorKind::kUsage);
  const SignalModel model = LoadSignalModel(command.model, command.map);
  const Team team = LoadTeam(command.positions, model);
  const auto robot = static_cast<std::size_t>(
      std::find(team.names.begin(), team.names.end(), command.robot) - team.names.begin());
  if (robot == team.names.size())
    throw Error("--robot: " + command.positions + " has no " + Quoted(command.robot),
                ErrorKind::kUsage);
  const std::vector<Eigen::Vector3d> candidates =
      PlacesInReach(*LoadMap(command.map), team.at_m[robot], command.reach_m);
  if (candidates.empty())
    throw Error(fmt::format("{}: {} reaches no free place within {:g} m", command.positions,
                            command.robot, command.reach_m));
  std::vector<std::uint32_t> others;
  std::vector<Eigen::Vector3d> others_m;
  for (std::size_t i = 0; i < team.names.size(); ++i)
    if (i != robot) {
      others.push_back(team.radios[i]);
      others_m.push_back(team.at_m[i]);
    }
  const std::vector<WorthwhilePlace> places = About(command.positions, [&] {
    return WhereToMeasure(model.predictor.get(), model.noise_db, model.now_s, team.radios[robot],
                          others, others_m, candidates, static_cast<std::size_t>(command.places));
  });
  Json json = {{"schema", "graticule-signal-where/1"},
               {"robot", command.robot},
               {"candidates", candidates.size()},
               {"places", Json::array()}};
  for (const WorthwhilePlace& place : places) {
    json["places"].push_back({{"x", place.at_m.x()},
                              {"y", place.at_m.y()},
                              {"gain_nats", place.gain_nats},
                              {"sigma_db", place.sigma_db}});
    if (!command.json)
      fmt::print("{:8.2f} {:8.2f}  tells {:.3f} nats; strengths there are known to {:.1f} dB\n",
                 place.at_m.x(), place.at_m.y(), place.gain_nats, place.sigma_db);
  }
  if (command.json) fmt::print("{}\n", JsonText(json, 1));
  return kDone;
}

}  // namespace graticule::apps
