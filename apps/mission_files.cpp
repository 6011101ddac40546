#include "mission_files.hpp"

#include <fmt/core.h>

#include "graticule/io/file.hpp"
#include "graticule/io/readable.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

Mission FromG2o(const MapCommand& command, const Registry& types, const Console& console) {
  const std::string& file = command.logs.front();
  Reading reading = command.reading;
  reading.skip_unknown = true;  // the scans, which are read by another
  Console silent = console;
  silent.quiet = true;  // of what was skipped
  Recording recording = Load(file, reading, types, silent);
  return MissionFromG2o(std::move(recording.graph), ParseG2oLaser(ReadFile(file), file), file);
}

}  // namespace

Mission LoadMission(const MapCommand& command, const Registry& types, MapReport* report,
                    const Console& console) {
  if (command.logs.size() > 1 || Ending(command.logs.front()) != ".g2o")
    throw Error("logs without a pose graph are not read yet", ErrorKind::kUsage);
  Mission mission = FromG2o(command, types, console);
  report->title = command.logs.front();
  if (mission.nodes.empty())
    throw Error(command.logs.front() + ": there are no scans to make a map of", ErrorKind::kOther);
  report->facts.emplace_back("robots", std::to_string(mission.log.robots.size()));
  report->facts.emplace_back(
      "nodes", fmt::format("{} with a scan, over {}", ReadableCount(mission.nodes.size()),
                           ReadableSeconds(mission.TimeOf(mission.nodes.back()) -
                                           mission.TimeOf(mission.nodes.front()))));
  return mission;
}

}  // namespace graticule::apps
