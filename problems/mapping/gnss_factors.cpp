#include "graticule/problems/mapping/gnss_factors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "graticule/factors/geodetic.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/mapping/gnss_alignment.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

constexpr double kBeyond = 1;       // s, that a fix may be before the first scan or after the last
constexpr double kLongGap = 10;     // s, between two scans ...
constexpr double kFarGap = 1;       // m, ... that tell nothing of the way between
constexpr double kLeastSure = 0.2;  // rad, of the map's direction
constexpr double kBent = 0.02;      // of its extent, that a way may be bent before fixes unbend it
constexpr double kStartDeviations = 10;
constexpr double kOff = 5;  // deviations

std::array<double, 3> ArrayOf(const Geodetic& place) {
  return {place.latitude, place.longitude, place.height};
}

struct Placed {
  const GnssFix* fix;
  std::size_t node;         // into Mission::nodes
  double lever_x, lever_y;  // m, of the antenna, in the node's frame
  std::uint32_t piece;
  GroundPoint point;
};

class Georeferencing {
 public:
  Georeferencing(const std::vector<GnssFix>& fixes, const std::string& name, RobotTracks tracks,
                 const GnssOptions& options, Mission* mission)
      : fixes_(fixes),
        name_(name),
        tracks_(std::move(tracks)),
        options_(options),
        mission_(*mission),
        pieces_(mission->graph.VariableCount()) {}

  GnssReport Run() {
    RefuseOtherWorlds();
    FindPieces();
    Place();
    Align();
    mission_.graph = OnTheGround();
    mission_.datum = datum_;
    mission_.starts.clear();
    mission_.graph.SetValues(Solve(mission_.graph, options_.solve).values);
    Judge();
    return report_;
  }

 private:
  [[noreturn]] void Fail(const GnssFix& fix, const std::string& message) const {
    throw Error(name_, fix.line, 1, message);
  }

  void RefuseOtherWorlds() const {
    for (const FactorType& type : mission_.graph.UsedFactorTypes())
      if (type.name == "position_se2/1" || type.name == "prior_point2/1" ||
          type.name == "geodetic_se2/1")
        throw Error(name_ + ": the graph has factors " + type.name +
                    ", which say where its world is already");
  }

  void FindPieces() {
    const Graph& graph = mission_.graph;
    for (FactorId id = 0; id < graph.FactorCount(); ++id)
      for (const VariableId variable : graph.VariablesOf(id))
        pieces_.Join(variable, graph.VariablesOf(id)[0]);
  }

  PlanarPose PoseOf(VariableId variable) const {
    const Span<const double> value = mission_.graph.ValueOf(variable);
    return {value[0], value[1], value[2]};
  }

  // Which node a fix is of, and where on it the antenna was.
  void Place() {
    std::vector<std::vector<std::size_t>> nodes_of(mission_.log.robots.size());
    for (std::size_t i = 0; i < mission_.nodes.size(); ++i)
      nodes_of[mission_.log.scans[mission_.nodes[i].scan].robot].push_back(i);
    for (auto& nodes : nodes_of)
      std::stable_sort(nodes.begin(), nodes.end(), [&](std::size_t a, std::size_t b) {
        return mission_.TimeOf(mission_.nodes[a]) < mission_.TimeOf(mission_.nodes[b]);
      });
    for (auto& track : tracks_)
      std::stable_sort(track.begin(), track.end(),
                       [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
    for (const GnssFix& fix : fixes_) {
      const auto& robots = mission_.log.robots;
      const auto robot = std::find(robots.begin(), robots.end(), fix.robot);
      if (robot == robots.end())
        Fail(fix, "there is no robot " + fix.robot + ": the first is " + robots.front());
      const auto which = static_cast<std::size_t>(robot - robots.begin());
      PlanarPose world_from_robot;
      const auto& nodes = nodes_of[which];
      if (nodes.empty() || !PoseAt(tracks_[which], fix.time, &world_from_robot)) {
        ++report_.outside;
        continue;
      }
      const auto after = std::upper_bound(nodes.begin(), nodes.end(), fix.time,
                                          [&](double time, std::size_t node) {
                                            return time < mission_.TimeOf(mission_.nodes[node]);
                                          });
      const std::size_t node = after == nodes.begin() ? nodes.front() : *(after - 1);
      if (placed_.empty()) datum_ = options_.datum.value_or(fix.antenna);
      Placed placed{&fix, node, 0, 0, pieces_.Root(mission_.nodes[node].variable), {}};
      world_from_robot.Transform(options_.antenna_x, options_.antenna_y, &placed.point.x,
                                 &placed.point.y);
      Inverse(PoseOf(mission_.nodes[node].variable))
          .Transform(placed.point.x, placed.point.y, &placed.lever_x, &placed.lever_y);
      const Eigen::Vector3d ground =
          EastNorthUp(ArrayOf(fix.antenna).data(), ArrayOf(datum_).data());
      placed.point.east = ground.x();
      placed.point.north = ground.y();
      placed.point.sigma = fix.sigma_m;
      placed_.push_back(placed);
    }
    if (placed_.empty())
      throw Error(name_ +
                  ": no fix is of a time of its robot's log: the log and the receiver need "
                  "one clock");
    report_.used = placed_.size();
  }

  static bool PoseAt(const std::vector<TimedPose>& track, double time, PlanarPose* pose) {
    if (track.empty() || time < track.front().time - kBeyond || time > track.back().time + kBeyond)
      return false;
    const auto after = std::lower_bound(track.begin(), track.end(), time,
                                        [](const TimedPose& a, double at) { return a.time < at; });
    if (after == track.begin() || after == track.end()) {
      *pose = (after == track.end() ? track.back() : *after).world_from_robot;
      return true;
    }
    const TimedPose& before = *(after - 1);
    const double gap = after->time - before.time;
    const PlanarPose &a = before.world_from_robot, &b = after->world_from_robot;
    if (gap > kLongGap && std::hypot(b.x - a.x, b.y - a.y) > kFarGap) return false;
    *pose = Interpolated(a, b, (time - before.time) / gap);
    return true;
  }

  // Fixes may be better than the way that is laid onto them.
  static void AllowForBends(std::vector<GroundPoint>* points) {
    const auto [left, right] = std::minmax_element(
        points->begin(), points->end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    const auto [low, high] = std::minmax_element(
        points->begin(), points->end(), [](const auto& a, const auto& b) { return a.y < b.y; });
    const double bent = kBent * std::hypot(right->x - left->x, high->y - low->y);
    for (GroundPoint& point : *points) point.sigma = std::hypot(point.sigma, bent);
  }

  void Align() {
    std::map<std::uint32_t, std::vector<GroundPoint>> points;
    std::map<std::uint32_t, const GnssFix*> first;
    for (const Placed& placed : placed_) {
      points[placed.piece].push_back(placed.point);
      first.emplace(placed.piece, placed.fix);
    }
    for (auto& [piece, of_piece] : points) {
      AllowForBends(&of_piece);
      const GroundAlignment alignment = AlignToGround(of_piece);
      const GnssFix& fix = *first.at(piece);
      if (!(alignment.sigma_yaw <= kLeastSure))
        Fail(fix, "from here on " + std::to_string(of_piece.size()) + " fixes of " + fix.robot +
                      " lie too close together, for their deviation, to say where east is");
      if (2 * alignment.agreeing < of_piece.size())
        Fail(fix, "from here on only " + std::to_string(alignment.agreeing) + " of " +
                      std::to_string(of_piece.size()) + " fixes of " + fix.robot +
                      " agree with its way, within three deviations");
      alignments_.emplace(piece, alignment);
      report_.sigma_yaw_rad = std::max(report_.sigma_yaw_rad, alignment.sigma_yaw);
    }
    std::vector<char> is_without(mission_.log.robots.size(), 0);
    for (const MissionNode& node : mission_.nodes)
      if (!alignments_.count(pieces_.Root(node.variable)))
        is_without[mission_.log.scans[node.scan].robot] = 1;
    for (std::size_t robot = 0; robot < is_without.size(); ++robot)
      if (is_without[robot]) report_.without.push_back(mission_.log.robots[robot]);
  }

  // The same variables in the same order, each piece where it lies, and the fixes.
  Graph OnTheGround() {
    const Graph& old = mission_.graph;
    Graph graph(old.Types());
    for (VariableId id = 0; id < old.VariableCount(); ++id) {
      const auto found = alignments_.find(pieces_.Root(id));
      std::vector<double> value(old.ValueOf(id).begin(), old.ValueOf(id).end());
      const std::string& type = old.TypeOf(id).name;
      if (found != alignments_.end()) {
        const PlanarPose& ground_from_map = found->second.ground_from_map;
        if (type == "se2/1") {
          const PlanarPose pose = ground_from_map * PlanarPose{value[0], value[1], value[2]};
          value = {pose.x, pose.y, pose.yaw};
        } else if (type == "point2/1") {
          ground_from_map.Transform(value[0], value[1], &value[0], &value[1]);
        }
      }
      graph.Add(old.KeyOf(id), type, value, found == alignments_.end() && old.IsFixed(id));
    }
    for (FactorId id = 0; id < old.FactorCount(); ++id) {
      Factor factor = old.FactorRecord(id);
      const auto found = alignments_.find(pieces_.Root(old.VariablesOf(id)[0]));
      if (factor.type == "prior_se2/1" && found != alignments_.end()) {
        std::vector<double>& m = factor.measurement;
        const PlanarPose pose = found->second.ground_from_map * PlanarPose{m[0], m[1], m[2]};
        m = {pose.x, pose.y, pose.yaw};
      }
      graph.Add(factor);
    }
    AddStarts(&graph);
    for (const Placed& placed : placed_) {
      Factor factor = GeodeticSe2Factor(old.KeyOf(mission_.nodes[placed.node].variable),
                                        ArrayOf(placed.fix->antenna), ArrayOf(datum_),
                                        {placed.lever_x, placed.lever_y},
                                        Noise::Sigmas({placed.fix->sigma_m, placed.fix->sigma_m}));
      factor.loss = {LossKind::kCauchy, options_.loss};
      graph.Add(factor);
    }
    return graph;
  }

  void AddStarts(Graph* graph) {
    std::map<std::uint32_t, VariableId> first;
    for (const MissionNode& node : mission_.nodes)
      first.emplace(pieces_.Root(node.variable), node.variable);
    for (const auto& [piece, alignment] : alignments_) {
      const VariableId variable = first.at(piece);
      const PlanarPose in_map = PoseOf(variable);
      const PlanarPose pose = alignment.ground_from_map * in_map;
      const double away = std::hypot(in_map.x - alignment.middle_x, in_map.y - alignment.middle_y);
      const double sigma =
          kStartDeviations * std::hypot(alignment.sigma, alignment.sigma_yaw * away);
      graph->Add(PriorSe2Factor(
          mission_.graph.KeyOf(variable), {pose.x, pose.y, pose.yaw},
          Noise::Sigmas({sigma, sigma, kStartDeviations * alignment.sigma_yaw}), "gnss start"));
    }
  }

  void Judge() {
    double squares = 0;
    std::size_t count = 0;
    for (const Placed& placed : placed_) {
      double east = 0, north = 0;
      PoseOf(mission_.nodes[placed.node].variable)
          .Transform(placed.lever_x, placed.lever_y, &east, &north);
      const double miss = std::hypot(east - placed.point.east, north - placed.point.north);
      if (miss > kOff * placed.fix->sigma_m) {
        ++report_.off;
        continue;
      }
      squares += miss * miss;
      ++count;
    }
    if (count > 0) report_.rms_m = std::sqrt(squares / static_cast<double>(count));
  }

  const std::vector<GnssFix>& fixes_;
  const std::string& name_;
  RobotTracks tracks_;
  const GnssOptions& options_;
  Mission& mission_;
  UnionFind pieces_;
  Geodetic datum_;
  std::vector<Placed> placed_;
  std::map<std::uint32_t, GroundAlignment> alignments_;  // by piece
  GnssReport report_;
};

}  // namespace

RobotTracks TracksOfNodes(const Mission& mission) {
  RobotTracks tracks(mission.log.robots.size());
  for (const MissionNode& node : mission.nodes) {
    const Span<const double> value = mission.graph.ValueOf(node.variable);
    tracks[mission.log.scans[node.scan].robot].push_back(
        {mission.TimeOf(node), {value[0], value[1], value[2]}});
  }
  return tracks;
}

GnssReport AddGnss(const std::vector<GnssFix>& fixes, const std::string& name, RobotTracks tracks,
                   const GnssOptions& options, Mission* mission) {
  return Georeferencing(fixes, name, std::move(tracks), options, mission).Run();
}

Graph WithPlainPositions(const Graph& graph) {
  Graph plain(graph.Types());
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    plain.Add(graph.KeyOf(id), graph.TypeOf(id).name,
              {graph.ValueOf(id).begin(), graph.ValueOf(id).end()}, graph.IsFixed(id));
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    Factor factor = graph.FactorRecord(id);
    if (factor.type == "geodetic_se2/1") {
      const std::vector<double>& m = factor.measurement;
      const Eigen::Vector3d antenna = EastNorthUp(m.data(), m.data() + 3);
      const PlanarPose turned{0, 0, graph.ValueOf(graph.VariablesOf(id)[0])[2]};
      double x = 0, y = 0;
      turned.Transform(m[6], m[7], &x, &y);
      factor.type = "position_se2/1";
      factor.measurement = {antenna.x() - x, antenna.y() - y};
    }
    plain.Add(factor);
  }
  return plain;
}

std::optional<Geodetic> DatumOf(const Graph& graph) {
  std::optional<Geodetic> datum;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    if (factor.type->name != "geodetic_se2/1") continue;
    const Geodetic own{factor.measurement[3], factor.measurement[4], factor.measurement[5]};
    if (datum && (datum->latitude != own.latitude || datum->longitude != own.longitude ||
                  datum->height != own.height))
      throw Error("the factors geodetic_se2/1 of this graph are of several data");
    datum = own;
  }
  return datum;
}

}  // namespace graticule
