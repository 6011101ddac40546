#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/io/signal_log.hpp"

namespace graticule {

/// A recorded set of signal strengths, and the map that came with it.
struct SignalSet {
  SignalLog log;
  std::shared_ptr<const OccupancyGrid> map;  ///< null: there is none
};

/// A flat with six anchors: calibration_df.csv, whose frame is that of layout.csv and anchors.csv
/// (columns rssi_1 to rssi_6 are the anchors 1 to 6), and its map of 5 cm.
SignalSet LoadKolak(const std::string& signal_folder);
/// 344 fixed nodes; no time, no map.
SignalSet LoadGrenoble(const std::string& signal_folder);

}  // namespace graticule
