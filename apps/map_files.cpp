#include "map_files.hpp"

#include <algorithm>
#include <optional>

#include "graticule/io/geography.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/gnss_factors.hpp"
#include "problem.hpp"

namespace graticule::apps {

MapDrawing DrawingOf(const Mission& mission, const MissionStep& last, OccupancyGrid grid) {
  MapDrawing drawing;
  drawing.grid = std::move(grid);
  std::vector<std::size_t> node_of(mission.graph.VariableCount(), mission.nodes.size());
  for (const std::string& robot : mission.log.robots) drawing.trajectories.push_back({robot, {}});
  for (std::size_t i = 0; i < last.nodes; ++i) {
    node_of[mission.nodes[i].variable] = i;
    const LaserScan& scan = mission.log.scans[mission.nodes[i].scan];
    drawing.trajectories[scan.robot].points.push_back(
        {last.world_from_robot[i].x, last.world_from_robot[i].y});
  }
  for (FactorId id = 0; id < mission.graph.FactorCount(); ++id) {
    const FactorView factor = mission.graph.FactorAt(id);
    if (factor.variables.size() != 2 || factor.source != "loop") continue;
    const std::size_t a = node_of[factor.variables[0]], b = node_of[factor.variables[1]];
    if (std::max(a, b) >= last.nodes) continue;
    const auto place = [&](std::size_t node) {
      return MapDrawing::Point{last.world_from_robot[node].x, last.world_from_robot[node].y};
    };
    drawing.closures.emplace_back(place(a), place(b));
  }
  return drawing;
}

void WriteTrajectories(const Mission& mission, const MissionStep& last,
                       const OutputFolder& folder) {
  const std::optional<Geodetic>& datum = mission.datum;
  std::vector<std::vector<StampedPose>> poses(mission.log.robots.size());
  std::vector<GeographicLine> lines;
  for (const std::string& robot : mission.log.robots) lines.push_back({robot, {}});
  for (std::size_t i = 0; i < last.nodes; ++i) {
    const LaserScan& scan = mission.log.scans[mission.nodes[i].scan];
    const PlanarPose& pose = last.world_from_robot[i];
    poses[scan.robot].push_back(StampPlanar(scan.time, pose));
    if (datum) lines[scan.robot].points.push_back(GeodeticOf(*datum, pose.x, pose.y));
  }
  for (std::size_t robot = 0; robot < poses.size(); ++robot)
    folder.Write(mission.log.robots[robot] + ".tum", FormatTum(poses[robot]));
  if (!datum) return;
  folder.Write("trajectories.kml", FormatKml(lines, "graticule map"));
  folder.Write("trajectories.geojson", FormatGeoJson(lines));
}

void WriteGraph(const Mission& mission, const MissionStep& last, const OutputFolder& folder) {
  Recording recording(mission.graph.Types());
  recording.graph = mission.graph;
  Values values = mission.graph.InitialValues();
  for (std::size_t i = 0; i < last.nodes; ++i) {
    double* value = values.Mutable(mission.nodes[i].variable);
    value[0] = last.world_from_robot[i].x;
    value[1] = last.world_from_robot[i].y;
    value[2] = last.world_from_robot[i].yaw;
  }
  recording.graph.SetValues(values);
  recording.title = "the pose graph of a map";
  recording.made_by = MadeBy("map");
  WriteProblem(folder.Of("graph.fg"), recording, {});
  if (DatumOf(recording.graph)) recording.graph = WithPlainPositions(recording.graph);
  WriteProblem(folder.Of("graph.g2o"), recording, {});
}

}  // namespace graticule::apps
