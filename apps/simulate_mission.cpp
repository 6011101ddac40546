#include <fmt/core.h>

#include "commands.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/simulate_gnss.hpp"
#include "output_folder.hpp"
#include "problem.hpp"
#include "recorded_folder.hpp"

namespace graticule::apps {
namespace {

constexpr double kFixEveryS = 5;

void Record(const Mission& mission, const std::string& title, const std::string& made_by,
            const OutputFolder& folder, const Console& console) {
  MissionRecorder recorder(folder, title, made_by);
  MissionReplay replay(mission, kEveryS);
  MissionStep step;
  while (replay.Next(&step)) {
    console.Progress(fmt::format("{} of {} nodes", step.nodes, mission.nodes.size()));
    recorder.Keep(step, replay.Problem());
  }
  console.Progress("");
  recorder.Finish(mission, step);
}

}  // namespace

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
  if (command.gnss_sigma_m > 0)
    folder.Write("gnss.csv",
                 FormatGnss(SimulateGnss(
                     simulated, ParseDatum(command.datum), kFixEveryS, command.gnss_sigma_m,
                     static_cast<std::size_t>(command.bad_fixes), command.seed)));
  Recording recording(mission.graph.Types());
  recording.graph = mission.graph;
  recording.title = fmt::format("{} robots in a simulated town", options.robots);
  recording.made_by =
      MadeBy(fmt::format("simulate-mission --shape {} --robots {} --minutes {} --seed {}",
                         command.shape, options.robots, options.duration_s / 60, command.seed));
  WriteProblem(folder.Of("graph.fg"), recording, {});
  if (command.record) Record(mission, recording.title, recording.made_by, folder, console);
  console.Note(fmt::format("{}: {} robots, {} scans, {} nodes", command.output, options.robots,
                           mission.log.scans.size(), mission.nodes.size()));
  return kDone;
}

}  // namespace graticule::apps
