#pragma once

// Internal to the readers of formats whose numbers may be parted by commas as well as by blanks.

#include <string>
#include <string_view>

namespace graticule {

/// The text with blanks for its commas, so that places in it are places in the file.  Throws Error,
/// with file, line and column: a comma with nothing before it, since what is behind would move into
/// the empty place.  Lines that begin with # are not looked at.
std::string CommasAsBlanks(std::string_view text, const std::string& name);

}  // namespace graticule
