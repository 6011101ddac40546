#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/geography.hpp"

namespace graticule {

/// Where a satellite receiver says that its antenna was.
struct GnssFix {
  double time = 0;  ///< s, by the clock of the robot's log
  std::string robot;
  Geodetic antenna;
  double sigma_m = 0;    ///< standard deviation, to the east and to the north
  std::size_t line = 0;  ///< of the file it was read from; 0: none
};

/// Reads lines `time,robot,latitude,longitude,height,sigma` (s, degrees, m), separated by commas or
/// blanks; a line that begins with `time` names the columns, `#` begins a comment.  Throws Error
/// "name:line:column: ...": no such place, a deviation that is not above 0, no fix at all.
std::vector<GnssFix> ParseGnss(std::string_view text, const std::string& name);

/// The same file again, to the bit.
std::string FormatGnss(const std::vector<GnssFix>& fixes);

/// The deviation [m] of a GGA message's fix: its quality's (1 single 2.5 m, 2 differential 1 m, 4
/// fixed 0.03 m, 5 float 0.3 m; others as 1) times the horizontal dilution of precision where that
/// is above 1.
double GnssSigma(std::uint64_t quality, double dilution);

}  // namespace graticule
