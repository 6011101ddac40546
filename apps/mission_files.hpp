#pragma once

#include <memory>
#include <optional>

#include "commands.hpp"
#include "graticule/io/map_report.hpp"
#include "graticule/io/pose_sequence.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "graticule/problems/mapping/recorded_folder.hpp"

namespace graticule::apps {

/// A mission, and where its sequence of graphs comes from if it has one already.
struct LoadedMission {
  Mission mission;
  std::optional<PoseSequence> sequence;    ///< a .pgseq file beside a .g2o
  std::optional<RecordedFolder> recorded;  ///< whose mission this is
};

/// Reads the logs that a command names, and makes the mission's pose graph where they have none.
/// Adds what there is to say to the report.
LoadedMission LoadMission(const MapCommand& command, const Registry& types, MapReport* report,
                          const Console& console);

/// G_1 .. G_n as the files have them, else as an online solver would have had them.  The mission
/// and the types must outlive it.
std::unique_ptr<GraphSequence> SequenceOf(const LoadedMission& loaded, const MapCommand& command,
                                          const Registry& types);

}  // namespace graticule::apps
