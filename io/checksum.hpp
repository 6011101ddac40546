#pragma once

#include <string>
#include <string_view>

namespace graticule {

/// The XXH64 of bytes, as 16 hexadecimal digits: tells whether something is what it was, and guards
/// against nobody.
std::string Checksum(std::string_view bytes);

}  // namespace graticule
