#pragma once

#include <string>

#include "graticule/io/comparison.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

/// A run as words of one line, for another process or a later one: all but what it is only beside
/// others (best_known, gap), every number to the bit, nan and infinity too.
std::string RunText(const ComparisonRun& run);

/// Reads it back, from the next word of the reader's line to the line's end.  Throws Error
/// "name:line:column: ...".
ComparisonRun ParseRun(TextReader* reader);

}  // namespace graticule
