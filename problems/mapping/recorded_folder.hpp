#pragma once

#include <string>
#include <vector>

#include "graticule/io/mission_index.hpp"
#include "graticule/problems/mapping/graph_sequence.hpp"
#include "graticule/problems/mapping/mission.hpp"

namespace graticule {

/// The file of a recorded mission's folder that says what is in it.
constexpr const char* kMissionIndex = "mission.index";

/// Whether a path is the folder of a recorded mission, or its index.
bool IsRecordedMission(const std::string& path);

/// A recorded mission as it lies in its folder.
struct RecordedFolder {
  std::string path;
  MissionIndex index;
};

/// Reads the index, and makes sure that what it names is there.  Throws Error.
RecordedFolder OpenRecordedMission(const std::string& path);
/// Reads scans and last graph.  Throws Error.
Mission ReadRecordedMission(const RecordedFolder& folder, const Registry& types);

/// The graphs as they were recorded.
class RecordedSequence : public GraphSequence {
 public:
  /// The folder must outlive it.  Of the graphs of each period from `begin` on, the last; 0: all.
  RecordedSequence(const RecordedFolder& folder, const Registry& types, double begin,
                   double every_s);

  bool Next(MissionStep* step) override;
  Graph Problem() const override { return graph_; }

 private:
  const RecordedFolder& folder_;
  std::vector<std::size_t> chosen_;  // into the index' graphs
  std::size_t next_ = 0;
  Graph graph_;
};

}  // namespace graticule
