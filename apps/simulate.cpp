#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/bundle/simulate.hpp"
#include "graticule/problems/pose_graph/corrupt.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

void Write(const SimulateCommand& command, const Graph& graph, const Values& truth,
           const std::vector<FactorId>& outliers, const std::string& title,
           const std::string& words, const Console& console) {
  const bool as_trajectory = Ending(command.truth) == ".tum";
  const auto trajectories = TrajectoryFiles(as_trajectory ? command.truth : "", graph);
  Recording recording(graph.Types());
  recording.graph = graph;
  recording.title = title;
  recording.made_by = MadeBy(words);
  WriteOptions options;
  options.binary = command.binary;
  WriteProblem(command.output, recording, options);
  if (!command.outliers.empty())
    WriteFile(command.outliers, JsonText(nlohmann::json(outliers)) + "\n");
  if (as_trajectory) {
    for (const auto& [path, family] : trajectories)
      WriteFile(path, FormatTum(Trajectory(graph, truth, family)));
  } else if (!command.truth.empty()) {
    recording.graph.SetValues(truth);
    recording.title += ", the truth";
    WriteProblem(command.truth, recording, options);
  }
  console.Note(fmt::format("{}: {} variables, {} factors ({})", command.output,
                           graph.VariableCount(), graph.FactorCount(), CountFactors(graph)));
}

int Corrupt(const SimulateCommand& command, const Console& console) {
  if (command.outlier_fraction <= 0)
    throw Error("simulate corrupt needs --outlier-fraction, the share of false closures",
                ErrorKind::kUsage);
  Recording recording = Load(command.input, command.reading, LoadTypes(command.reading), console);
  CorruptOptions options;
  options.fraction = command.outlier_fraction;
  options.kind = command.outlier_kind == "grouped" ? Corruption::kGrouped
                 : command.outlier_kind == "local" ? Corruption::kLocal
                                                   : Corruption::kRandom;
  options.seed = command.seed;
  Corrupted corrupted =
      About(command.input, [&] { return AddFalseClosures(recording.graph, options); });
  recording.graph = std::move(corrupted.graph);
  recording.made_by = MadeBy(
      fmt::format("simulate corrupt {} --outlier-fraction {} --outlier-kind {} --seed {}",
                  command.input, command.outlier_fraction, command.outlier_kind, command.seed));
  recording.solved_by.clear();
  recording.report.clear();
  WriteOptions writing;
  writing.binary = command.binary;
  for (const std::string& note : WriteProblem(command.output, recording, writing))
    console.Note(command.output + ": " + note);
  if (!command.outliers.empty())
    WriteFile(command.outliers, JsonText(nlohmann::json(corrupted.outliers)) + "\n");
  console.Note(fmt::format("{}: {} false closures added to {} factors", command.output,
                           corrupted.outliers.size(),
                           recording.graph.FactorCount() - corrupted.outliers.size()));
  return kDone;
}

}  // namespace

int Run(const SimulateCommand& command, const Console& console) {
  ExpectEnding(command.output, "-o", ProblemEndings());
  std::vector<std::string> truths = ProblemEndings();
  truths.emplace_back(".tum");
  ExpectEnding(command.truth, "--truth", truths);
  for (const std::string& path : {command.output, command.truth, command.outliers})
    ExpectWritable(path);
  if (command.kind == "corrupt") return Corrupt(command, console);

  if (command.kind == "bundle") {
    RingOptions options;
    options.cameras = command.cameras;
    options.points = command.points;
    options.seed = command.seed;
    const SimulatedBundle world = SimulateRing(Builtins(), options);
    Write(command, world.graph, world.truth, {}, "cameras on a ring round a cloud of points",
          fmt::format("simulate bundle --cameras {} --points {} --seed {}", command.cameras,
                      command.points, command.seed),
          console);
    return kDone;
  }
  CityOptions options;
  options.dimension = command.dimension;
  options.robots = command.robots;
  options.poses_per_robot = command.poses;
  options.landmarks = command.landmarks;
  options.outlier_fraction = command.outlier_fraction;
  options.seed = command.seed;
  if (command.closures_per_pose >= 0) options.loops_per_pose = command.closures_per_pose;
  const Simulated world = SimulateCity(Builtins(), options);
  Write(command, world.graph, world.truth, world.outliers,
        fmt::format("{} robots in a city of square blocks, {} poses each", command.robots,
                    command.poses),
        fmt::format("simulate city --robots {} --poses {} --dimension {} --landmarks {} "
                    "--closures-per-pose {} --outlier-fraction {} --seed {}",
                    command.robots, command.poses, command.dimension, command.landmarks,
                    options.loops_per_pose, command.outlier_fraction, command.seed),
        console);
  return kDone;
}

}  // namespace graticule::apps
