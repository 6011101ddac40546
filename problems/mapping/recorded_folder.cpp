#include "graticule/problems/mapping/recorded_folder.hpp"

#include <cmath>
#include <filesystem>

#include "graticule/io/file.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/mapping/recorded_mission.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

Graph ReadGraph(const RecordedFolder& folder, const MissionIndex::Graph& step,
                const Registry& types) {
  return ReadProblem(folder.path + "/" + step.file, types, {}).graph;
}

}  // namespace

bool IsRecordedMission(const std::string& path) {
  return std::filesystem::is_directory(path) ||
         std::filesystem::path(path).filename().string() == kMissionIndex;
}

RecordedFolder OpenRecordedMission(const std::string& path) {
  namespace fs = std::filesystem;
  const bool is_folder = fs::is_directory(path);
  std::string folder = is_folder ? path : fs::path(path).parent_path().string();
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  if (folder.empty()) folder = ".";
  const std::string name = folder + "/" + kMissionIndex;
  if (is_folder && !fs::exists(name))
    throw Error(path + ": this folder is no recorded mission: there is no " + kMissionIndex +
                " in it");
  MissionIndex index = ParseMissionIndex(ReadFile(name), name);
  // All of them, before hours of work on the first.
  for (const MissionIndex::Graph& graph : index.graphs)
    if (!fs::exists(folder + "/" + graph.file))
      throw Error(name, graph.line, 1,
                  "the graph " + graph.file + " of the sequence is missing in " + folder);
  for (const MissionIndex::Robot& robot : index.robots)
    if (!fs::exists(folder + "/" + robot.scans))
      throw Error(name, robot.line, 1,
                  "the scans " + robot.scans + " of " + robot.name + " are missing in " + folder);
  return {folder, std::move(index)};
}

Mission ReadRecordedMission(const RecordedFolder& folder, const Registry& types) {
  std::vector<G2oLaser> scans;
  for (const MissionIndex::Robot& robot : folder.index.robots) {
    const std::string file = folder.path + "/" + robot.scans;
    scans.push_back(ParseG2oLaser(ReadFile(file), file));
  }
  return MissionFromParts(folder.index, std::move(scans),
                          ReadGraph(folder, folder.index.graphs.back(), types), folder.path);
}

RecordedSequence::RecordedSequence(const RecordedFolder& folder, const Registry& types,
                                   double begin, double every_s)
    : folder_(folder), graph_(types) {
  const std::vector<MissionIndex::Graph>& graphs = folder.index.graphs;
  // A graph at the end of a period, but for the last digits of its time, is of that period.
  const auto period = [&](std::size_t i) {
    return std::ceil((graphs[i].time - begin) / every_s - 1e-6);
  };
  for (std::size_t i = 0; i < graphs.size(); ++i)
    if (every_s <= 0 || i + 1 == graphs.size() || period(i) != period(i + 1)) chosen_.push_back(i);
}

bool RecordedSequence::Next(MissionStep* step) {
  if (next_ == chosen_.size()) return false;
  const MissionIndex::Graph& graph = folder_.index.graphs[chosen_[next_++]];
  graph_ = ReadGraph(folder_, graph, graph_.Types());
  step->time = graph.time;
  step->nodes = graph.nodes;
  step->world_from_robot = PosesOf(folder_.index, graph, graph_, folder_.path);
  return true;
}

}  // namespace graticule
