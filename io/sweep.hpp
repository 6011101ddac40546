#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/cloud.hpp"

namespace graticule {

/// One turn of a planar laser.
struct SweptScan {
  double stamp_s = 0;
  double servo_rad = 0;          ///< the servo's angle phi when the scan was taken
  double first_bearing_rad = 0;  ///< of the first range; 0 is the laser's x axis
  double bearing_step_rad = 0;   ///< to the next
  std::vector<float> ranges_m;   ///< NaN: no return
};

/// Scans of a planar laser that a servo turns, in the order of their time.
///
/// A range r at bearing theta is (r cos theta, r sin theta, 0) in the laser's frame and
/// T(phi) (r cos theta, r sin theta, 0) in the sensor's, with T(phi) = R(axis, phi)
/// servo_from_laser (thesis, Eq. 4.1).
struct Sweep {
  std::array<double, 3> axis = {0, 1, 0};  ///< of the servo, unit: y nods the plane
  std::array<double, 7> servo_from_laser = {0, 0, 0, 0, 0, 0, 1};  ///< x y z [m] qx qy qz qw
  std::vector<SweptScan> scans;
};

/// A line a scan: `stamp_s,servo_rad,first_bearing_rad,bearing_step_rad,range_m,range_m,...`; a
/// range that is 0, nan or inf is no return.  Before the scans there may be
/// `axis,x,y,z` and `servo_from_laser,x,y,z,qx,qy,qz,qw`, and a line that begins with `stamp` names
/// the columns; `#` begins a comment.  Blanks do as commas.
///
/// Throws Error "name:line:column: ...": no scan, scans of unequal numbers of ranges, times that go
/// backwards, a range below 0 or beyond 1e6 m, an axis of no length.
Sweep ParseSweep(std::string_view text, const std::string& name);

/// The same file again, to the bit.
std::string FormatSweep(const Sweep& sweep);

/// The points in the sensor's frame, a scan a row.
PointCloud ToCloud(const Sweep& sweep);

}  // namespace graticule
