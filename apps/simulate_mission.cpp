#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/carmen.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/mapping/mission_replay.hpp"
#include "graticule/problems/mapping/simulate_gnss.hpp"
#include "graticule/problems/urban/town_camera.hpp"
#include "graticule/problems/urban/town_radio.hpp"
#include "graticule/problems/urban/town_scene.hpp"
#include "mission_readme.hpp"
#include "mission_recorder.hpp"
#include "output_folder.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

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

void WriteLasers(const SimulatedMission& simulated, const OutputFolder& folder,
                 const OutputFolder& truth) {
  const LaserLog& log = simulated.mission.log;
  for (std::size_t robot = 0; robot < log.robots.size(); ++robot) {
    folder.Write(log.robots[robot] + ".log", FormatCarmen(log, robot));
    std::vector<StampedPose> poses;
    for (std::size_t i = 0; i < log.scans.size(); ++i)
      if (log.scans[i].robot == robot)
        poses.push_back(StampPlanar(log.scans[i].time, simulated.world_from_robot[i]));
    truth.Write("poses." + log.robots[robot] + ".tum", FormatTum(poses));
  }
  WriteOccupancy(simulated.town.grid, truth.Of("map"));
}

Json WriteSignal(const SimulatedMission& simulated, const SimulateMissionCommand& command,
                 const OutputFolder& folder, const OutputFolder& truth) {
  const RadioOptions radio;
  const TownSignal signal = SimulateTownSignal(simulated, radio, command.rate_hz, command.seed);
  folder.Write("signal.csv", FormatSignalLogWithoutPositions(signal.log));
  WriteSignalLog(signal.log, truth.Of("signal.csv"));
  WriteSignalLog(signal.unmeasured, truth.Of("links.csv"));
  Json json = {{"l0_dbm", radio.l0_dbm},
               {"exponent", FloorPlan::kStreetExponent},
               {"wall_ceiling_db", radio.ceiling_db},
               {"shadowing_db", radio.shadowing_db},
               {"floor_dbm", radio.floor_dbm}};
  for (std::size_t i = 0; i < signal.log.radios.size(); ++i)
    json["radios"][signal.log.radios[i]] = {{"bias_db", signal.bias_db[i]},
                                            {"sending_db", signal.sending_bias_db[i]},
                                            {"listening_db", signal.listening_bias_db[i]}};
  return json;
}

void WriteCameras(const std::vector<std::string>& robots, const SimulateMissionCommand& command,
                  const OutputFolder& folder, const OutputFolder& truth, const Console& console) {
  const OutputFolder cameras(folder.Of("cameras"));
  const Target target = AprilCalMosaic(8, 6, 0.05);
  WriteTarget(cameras.Of("target.yaml"), target);
  for (std::size_t robot = 0; robot < robots.size(); ++robot) {
    console.Progress(fmt::format("pictures of {}'s camera", robots[robot]));
    const CameraIntrinsics camera = TownCamera(robot, command.seed);
    WriteCamera(truth.Of(robots[robot] + ".yaml"), camera);
    const OutputFolder own(cameras.Of(robots[robot]));
    const auto pictures = TakePictures(camera, target, static_cast<std::size_t>(command.pictures),
                                       command.seed + 1000 * robot);
    for (std::size_t i = 0; i < pictures.size(); ++i)
      own.Write(fmt::format("{:02}.png", i), FormatPng(pictures[i].image));
  }
  console.Progress("");
}

Json WriteScene(const SimulatedMission& simulated, const SimulateMissionCommand& command,
                const OutputFolder& folder, const OutputFolder& truth) {
  const TownScene town = SimulateTownScene(simulated, 0, TownCamera(0, command.seed), command.seed);
  const OutputFolder scene(folder.Of("scene"));
  WriteCloud(scene.Of("scan.pcd"), town.scene.cloud);
  scene.Write("image.png", FormatPng(town.scene.image));
  scene.Write("points.csv", FormatCorrespondences(town.points));
  LidarRig rig;
  rig.camera = town.scene.camera;
  rig.camera_from_lidar = town.scene.camera_from_lidar;
  WriteRig(truth.Of("rig.yaml"), rig);
  const PlanarPose& pose = town.world_from_robot;
  Json json = {{"world_from_robot", {pose.x, pose.y, pose.yaw}}, {"wrong_points", Json::array()}};
  for (const std::size_t wrong : town.wrong) json["wrong_points"].push_back(wrong + 1);
  return json;
}

}  // namespace

int Run(const SimulateMissionCommand& command, const Console& console) {
  MissionOptions options;
  if (command.shape == "keswick-like") options = KeswickLike();
  if (command.shape == "phase2-like") options = Phase2Like();
  if (command.robots > 0) options.robots = command.robots;
  if (command.minutes > 0) options.duration_s = 60 * command.minutes;
  options.seed = options.town.seed = command.seed;
  options.town.street_things = command.street_things;
  const OutputFolder folder = OutputFolder::New(command.output);
  const OutputFolder truth(folder.Of("truth"));
  const SimulatedMission simulated = SimulateMission(Builtins(), options);
  const Mission& mission = simulated.mission;
  WriteLasers(simulated, folder, truth);
  if (command.gnss_sigma_m > 0)
    folder.Write("gnss.csv",
                 FormatGnss(SimulateGnss(
                     simulated, ParseDatum(command.datum), kFixEveryS, command.gnss_sigma_m,
                     static_cast<std::size_t>(command.bad_fixes), command.seed)));
  Recording recording(mission.graph.Types());
  recording.graph = mission.graph;
  recording.title = fmt::format("{} robots in a simulated town", options.robots);
  recording.made_by =
      MadeBy(fmt::format("simulate mission --shape {} --robots {} --minutes {} --seed {}",
                         command.shape, options.robots, options.duration_s / 60, command.seed));
  WriteProblem(folder.Of("graph.fg"), recording, {});
  if (command.record) Record(mission, recording.title, recording.made_by, folder, console);

  MissionContents contents;
  contents.made_by = recording.made_by;
  contents.robots = mission.log.robots;
  contents.has_gnss = command.gnss_sigma_m > 0;
  contents.is_recorded = command.record;
  contents.has_signal = command.rate_hz > 0 && options.robots > 1;
  contents.has_cameras = command.pictures > 0;
  contents.datum = command.datum;
  Json json = {{"schema", "graticule-mission-truth/1"},
               {"made_by", recording.made_by},
               {"seed", command.seed},
               {"robots", options.robots},
               {"duration_s", options.duration_s},
               {"datum", command.datum}};
  if (contents.has_signal) json["signal"] = WriteSignal(simulated, command, folder, truth);
  if (contents.has_cameras) {
    WriteCameras(mission.log.robots, command, folder, truth, console);
    json["scene"] = WriteScene(simulated, command, folder, truth);
  }
  truth.Write("truth.json", JsonText(json, 1) + "\n");
  folder.Write("README.md", MissionReadme(contents));
  console.Note(fmt::format("{}: {} robots, {} scans, {} nodes", command.output, options.robots,
                           mission.log.scans.size(), mission.nodes.size()));
  return kDone;
}

}  // namespace graticule::apps
