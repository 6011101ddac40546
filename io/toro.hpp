#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/read_options.hpp"
#include "graticule/io/recording.hpp"

namespace graticule {

/// Reads a TORO `.graph` file: VERTEX2, EDGE2, VERTEX3, EDGE3, EQUIV (docs/formats.md).  Keys are
/// `pose:ID`.  `EQUIV a b` adds no factor: the edges between the two get the source "equiv".
/// Throws Error "name:line:column: ...".
Recording ParseToro(std::string_view text, const std::string& name, const Registry& types,
                    const ReadOptions& options = {});

/// The recording as a TORO file.  2D comes back to the bit; 3D to rounding, for TORO stores roll,
/// pitch and yaw.  What is lost (losses, fixed variables) is said in `notes`, one line each.
/// Throws Error for anything but between_se2/1 and between_se3/1.
std::string FormatToro(const Recording& recording, std::vector<std::string>* notes);

}  // namespace graticule
