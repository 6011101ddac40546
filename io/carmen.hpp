#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/gnss.hpp"
#include "graticule/io/laser_log.hpp"

namespace graticule {

struct CarmenOptions {
  /// Key family of the robot whose log it is.  Empty: "robot1", "robot2", ..., as they come.
  std::string robot;
  /// Which laser's messages: "FLASER", "ROBOTLASER1", "RAWLASER2", ...  Empty: the first of
  /// ROBOTLASER1, FLASER, RAWLASER1, and then any other that the log has.
  std::string laser;
  /// robot_from_laser, instead of what the log says, or does not say.
  std::optional<PlanarPose> laser_offset;
  /// Reads NMEAGGA messages; else they are counted as others are.
  bool read_fixes = false;
  /// Clocks of old logs jump: a scan may seem to be this much earlier than the ones before it [s].
  double time_jitter = 1;
  /// Lines that are wrong are counted and passed over instead of refused.
  bool skip_bad = false;
};

/// Where the times of a log's scans come from.
enum class LogTimes {
  kMessage,  ///< the first of the two at a line's end
  kLogger,   ///< the second: the first has too few digits, or goes backwards more often
  kNone,     ///< neither says when: scans are numbered, one a second
};

/// What was found in a log.
struct CarmenSummary {
  std::string laser;  ///< the messages that were read
  std::size_t scans = 0;
  /// Where the log says that the laser sits on its robot (PARAM; ROBOTLASERi: the first message),
  /// whatever the options say.  Empty: it does not say.
  std::optional<PlanarPose> logged_laser_offset;
  std::vector<GnssFix> fixes;                         ///< of this robot, by the clock of the scans
  std::map<std::string, std::size_t> other_messages;  ///< by name, not read; known or not
  LogTimes times = LogTimes::kMessage;
  std::size_t skipped = 0;    ///< lines, where skip_bad
  std::string first_skipped;  ///< the Error that the first of these would have been
};

/// Reads a log of the CARMEN toolkit (carmen.sourceforge.net) and appends its scans to `log`, as a
/// robot of their own.
///
/// - `FLASER n r1..rn x y yaw odom_x odom_y odom_yaw`: no field of view is given: half a turn from
///   the right, in steps of pi/n where n is even (180, 360), pi/(n-1) where it is odd (181, 361).
///   The laser is on its robot where `PARAM robot_frontlaser_offset` says [m ahead], else at its
///   centre, unless options say where.  "No return" is what is within a hundredth of the largest
///   reading of the log.
/// - `ROBOTLASERi`: geometry, laser pose and robot pose are in the message.
/// - `RAWLASERi`: as ROBOTLASERi without poses: dead reckoning is that of the `ODOM` lines before
///   and after, interpolated; the laser sits as FLASER's.
///
/// - `NMEAGGA nr utc latitude N|S longitude E|W quality satellites hdop sea_level height
/// geo_sea_level
///   geo_sep age`: a receiver's fix, degrees and minutes as ddmm.mmmm; of quality 0 there is none.
///   Its deviation is hdop (at least 1) times 2.5 m; 1 m differential, 0.3 m float, 0.03 m fixed.
///
/// Every line ends with a time, a host and the logger's time.  Times with six digits only, as some
/// tools write them, are useless where they count from 1970: see LogTimes.
///
/// Throws Error "name:line:column: expected ..., found ..." : a line that is cut short or too long,
/// a reading that is not a number or negative, times that go backwards by more than the jitter; no
/// laser message at all. Unknown messages are counted.
CarmenSummary ParseCarmen(std::string_view text, const std::string& name,
                          const CarmenOptions& options, LaserLog* log);

/// One robot's scans as ROBOTLASER1 lines.
std::string FormatCarmen(const LaserLog& log, std::size_t robot = 0);

}  // namespace graticule
