#include "mission_recorder.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "graticule/io/problem_file.hpp"
#include "graticule/problems/mapping/recorded_folder.hpp"
#include "graticule/problems/mapping/recorded_mission.hpp"

namespace graticule::apps {

MissionRecorder::MissionRecorder(const OutputFolder& folder, std::string title, std::string made_by)
    : folder_(folder), title_(std::move(title)), made_by_(std::move(made_by)) {
  std::error_code ignored;
  std::filesystem::remove(folder.Of(kMissionIndex), ignored);
  OutputFolder(folder.Of("graphs"));
  OutputFolder(folder.Of("scans"));
}

void MissionRecorder::Keep(const MissionStep& step, Graph graph) {
  Recording recording(graph.Types());
  recording.graph = std::move(graph);
  HoldEachPiece(&recording.graph);
  const std::size_t number = graphs_.size() + 1;
  recording.title = fmt::format("graph {} of {}, at {} s", number, title_, step.time);
  recording.made_by = made_by_;
  const std::string file = fmt::format("graphs/{:05}.fg", number);
  // Binary: less than half of the text, and nothing to wait for.
  WriteOptions options;
  options.binary = true;
  WriteProblem(folder_.Of(file), recording, options);
  graphs_.push_back({file, step.time, step.nodes, 0});
}

void MissionRecorder::Finish(const Mission& mission, const MissionStep& last) {
  MissionIndex index = IndexOf(mission);
  index.title = title_;
  index.made_by = made_by_;
  index.graphs = graphs_;
  for (std::uint32_t robot = 0; robot < mission.log.robots.size(); ++robot) {
    const std::string text = FormatScans(mission, robot, last.world_from_robot);
    if (!text.empty()) folder_.Write("scans/" + mission.log.robots[robot] + ".g2o.gz", text);
  }
  // Last: where there is an index, all that it names is there.
  folder_.Write(kMissionIndex, FormatMissionIndex(index));
}

}  // namespace graticule::apps
