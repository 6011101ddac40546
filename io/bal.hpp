#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/recording.hpp"

namespace graticule {

/// Reads a problem of Bundle Adjustment in the Large
/// (https://grail.cs.washington.edu/projects/bal): cameras `camera:i` of bal_camera/1, points
/// `point:i` of point3/1, and an observation in pixels a factor of bal_reprojection/1 with unit
/// noise.  Throws Error "name:line:column: ...".
Recording ParseBal(std::string_view text, const std::string& name, const Registry& types);

/// The recording in that format; cameras and points are numbered in key order.  What is lost
/// (losses, fixed variables, keys) is said in `notes`, one line each.  Throws Error for anything
/// but cameras, points and observations of unit noise.
std::string FormatBal(const Recording& recording, std::vector<std::string>* notes);

}  // namespace graticule
