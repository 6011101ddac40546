#pragma once

#include <string>
#include <vector>

#include "graticule/io/mission_index.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"
#include "output_folder.hpp"

namespace graticule::apps {

/// Writes a mission as it is replayed: a graph a step, and in the end what they are of.
class MissionRecorder {
 public:
  /// An index that is there goes first: what it says is true no more.
  MissionRecorder(const OutputFolder& folder, std::string title, std::string made_by);

  void Keep(const MissionStep& step, Graph graph);
  void Finish(const Mission& mission, const MissionStep& last);

 private:
  const OutputFolder& folder_;
  std::string title_, made_by_;
  std::vector<MissionIndex::Graph> graphs_;
};

}  // namespace graticule::apps
