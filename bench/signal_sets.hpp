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
/// Another drive in the same flat, a quarter of an hour after those: tests/test_robot_df.csv.
SignalSet LoadKolakTest(const std::string& signal_folder);
/// 344 fixed nodes; no time, no map.
SignalSet LoadGrenoble(const std::string& signal_folder);
/// A home with two routers of two bands each (a band is a radio), experiment 3 or 4, and its map.
/// The log has no time: a line, which is a quarter of a metre on, counts as half a second.
SignalSet LoadIkv(const std::string& signal_folder, int experiment);
/// Robot to robot in one of harvard_wsr's five rooms ("LOS_Set_A", ...), in the order of time.
SignalSet LoadHarvard(const std::string& signal_folder, const std::string& room);
/// Two vehicles around a field of 19 x 19 units, taken as metres, of rti_mobile_vdmeij: "empty",
/// "one_person_standing_center", ...  Packets whose ends are both known.  The log has no time: a
/// packet counts as a tenth of a second, those of unknown ends as well.
SignalSet LoadVehicles(const std::string& signal_folder, const std::string& dump);

}  // namespace graticule
