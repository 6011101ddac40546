#include <fmt/core.h>

#include "commands.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/mapping/simulate.hpp"
#include "output_folder.hpp"
#include "problem.hpp"

namespace graticule::apps {

int Run(const SimulateMissionCommand& command, const Console& console) {
  MissionOptions options;
  if (command.shape == "keswick-like") options = KeswickLike();
  if (command.shape == "phase2-like") options = Phase2Like();
  if (command.robots > 0) options.robots = command.robots;
  if (command.minutes > 0) options.duration_s = 60 * command.minutes;
  options.seed = options.town.seed = command.seed;
  const OutputFolder folder(command.output);
  const SimulatedMission simulated = SimulateMission(Builtins(), options);
  const Mission& mission = simulated.mission;
  for (std::size_t robot = 0; robot < mission.log.robots.size(); ++robot) {
    const std::string& name = mission.log.robots[robot];
    folder.Write(name + ".log", FormatCarmen(mission.log, robot));
    std::vector<StampedPose> truth;
    for (std::size_t i = 0; i < mission.log.scans.size(); ++i) {
      if (mission.log.scans[i].robot != robot) continue;
      truth.push_back(StampPlanar(mission.log.scans[i].time, simulated.world_from_robot[i]));
    }
    folder.Write("truth." + name + ".tum", FormatTum(truth));
  }
  WriteOccupancy(simulated.town.grid, folder.Of("truth"));
  Recording recording(mission.graph.Types());
  recording.graph = mission.graph;
  recording.title = fmt::format("{} robots in a simulated town", options.robots);
  recording.made_by =
      MadeBy(fmt::format("simulate-mission --shape {} --robots {} --minutes {} --seed {}",
                         command.shape, options.robots, options.duration_s / 60, command.seed));
  WriteProblem(folder.Of("graph.fg"), recording, {});
  console.Note(fmt::format("{}: {} robots, {} scans, {} nodes", command.output, options.robots,
                           mission.log.scans.size(), mission.nodes.size()));
  return kDone;
}

}  // namespace graticule::apps
