#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace graticule {

/// Numbers for people: rounded, with a unit that fits their size.  Blind to the locale.  What a
/// program reads has all digits instead (report_json.hpp).

/// `digits` significant ones: "1.23e-7", "0.0123", "1234".  Not finite: "–".
std::string ReadableNumber(double number, int digits = 4);
/// "12,345".
std::string ReadableCount(std::uint64_t count);
/// "1.25 ms", "34.1 s", "12 min 5 s".  Not finite: "–".
std::string ReadableSeconds(double seconds);
/// "1.25 MiB"; 0, which stands for unknown: "–".
std::string ReadableBytes(std::uint64_t bytes);
/// A relative difference: "+0.12 %", "+3.4e-9", "0".  Not finite: "–".
std::string ReadableGap(double gap);

/// Columns that the UTF-8 text takes on a terminal.
std::size_t DisplayWidth(std::string_view text);

}  // namespace graticule
