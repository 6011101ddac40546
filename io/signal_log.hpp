#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/trajectory.hpp"

namespace graticule {

/// Who listened to whom, where and when.
struct SignalLink {
  double time_s = 0;
  std::uint32_t receiver = 0, transmitter = 0;              ///< indices into SignalLog::radios
  Eigen::Vector3d receiver_m = Eigen::Vector3d::Zero();     ///< map_from_receiver; z 0 if unknown
  Eigen::Vector3d transmitter_m = Eigen::Vector3d::Zero();  ///< map_from_transmitter
};

/// What was heard over a link.
struct SignalMeasurement {
  SignalLink link;
  double dbm = 0;        ///< received strength; of a packet not heard the floor that it is below
  bool is_heard = true;  ///< false: all that is known is that it is below `dbm` (censored)
};

/// A log of received strengths, in the order of time.
struct SignalLog {
  std::vector<std::string> radios;  ///< names, in the order of their first line
  std::vector<SignalMeasurement> measurements;
  bool has_height = false;  ///< z was given
  bool has_time = true;     ///< false: every time_s is 0, and only hold-out evaluation makes sense
};

/// Where radios stand whose positions are not in the log itself.
struct SignalLogOptions {
  std::map<std::string, Eigen::Vector3d> anchors;  ///< map_from_radio [m]
  /// map_from_radio over time; in the order of stamps; positions between two
  /// poses are interpolated along a line.
  std::map<std::string, std::vector<StampedPose>> trajectories;
  std::string mobile = "mobile";  ///< the radio that the wide form's x, y belong to
  bool sort = false;              ///< put lines in the order of time instead of refusing them
};

/// Reads a log of comma-separated values; the first line names the columns, others than these are
/// passed over (docs/formats.md):
/// - long: time, receiver, transmitter, rx_x, rx_y[, rx_z], tx_x, tx_y[, tx_z], dbm[, heard]; an
///   end without position columns takes its position from the options, a log without receiver has
///   one, "rx"; without time it has none.
/// - wide: time, x, y[, z] of the mobile radio, and a column rssi_ID for each anchor ID.  An empty
///   cell is no measurement.  The mobile radio counts as the receiver.
/// Times are seconds, or nanoseconds where above 1e15.  A byte order mark and either line ending
/// load.  Throws Error "name:line:column: ...": columns that miss, times that go backwards, a radio
/// of which nobody says where it is, a dBm that is not within -200 and 30, what is not finite.
SignalLog ParseSignalLog(std::string_view text, const std::string& name,
                         const SignalLogOptions& options = {});
/// The same of a file, which may be packed with gzip.
SignalLog ReadSignalLog(const std::string& path, const SignalLogOptions& options = {});

/// Reads the positions of fixed radios: id, x, y[, z].  Throws Error: one that is there twice.
std::map<std::string, Eigen::Vector3d> ParseAnchors(std::string_view text, const std::string& name);

/// The long form, which reads back to the bit; a column `heard` only where one was not.  Throws
/// Error (kInput): a name with a comma, a quote, a line end or blanks around it.
std::string FormatSignalLog(const SignalLog& log);
/// The same without positions, as radios that do not know where they are write it.
std::string FormatSignalLogWithoutPositions(const SignalLog& log);
/// The long form into a file; packed with gzip if its name ends in `.gz`.
void WriteSignalLog(const SignalLog& log, const std::string& path);

}  // namespace graticule
