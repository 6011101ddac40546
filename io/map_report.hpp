#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/accuracy.hpp"

namespace graticule {

/// What one update of a map took (thesis Figures 2.5 to 2.8).
struct MapUpdateRow {
  double time = 0;     ///< s, of the log
  double seconds = 0;  ///< wall time
  std::size_t nodes = 0, cover = 0, regenerated_nodes = 0, left_over_slices = 0;
  std::size_t dirty_tiles = 0, flipped_cells = 0;
};

/// A mission replayed with one method.
struct MapRun {
  std::string method;
  std::vector<MapUpdateRow> updates;
  /// Against the map of all nodes at the same poses.
  double structure_iou = 0, known_recall = 0, known_changed = 0;
};

struct MapReport {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< "robots" "14", in order
  std::vector<MapRun> runs;                                ///< the first is the one that is written
  std::vector<std::string> warnings;
  std::optional<Accuracy> accuracy = {};  ///< of the poses, where the truth is known
};

/// Total, mean, 99th percentile and worst of a run's updates, in seconds.
struct MapRunTimes {
  double total = 0, mean = 0, p99 = 0, worst = 0;
};
MapRunTimes TimesOf(const MapRun& run);

/// Upper ends of the bands in which updates are counted, in seconds, and how many updates fall in
/// each, those above the last after them.
std::vector<double> MapBands();
std::vector<std::size_t> CountInBands(const MapRun& run);
/// What the updates of each band took together, in seconds.
std::vector<double> SecondsInBands(const MapRun& run);

/// One self-contained page: the picture, the facts, the methods side by side, their time by band
/// and cumulative (Figure 2.5), time per update with its mean (Figures 2.6, 2.7), and nodes, cover
/// and regenerated nodes (Figure 2.8).
std::string MapReportHtml(const MapReport& report, const std::string& map_svg);

/// For programs.
std::string MapReportJson(const MapReport& report);

}  // namespace graticule
