#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace graticule::apps {

/// So many finite numbers between commas, the value of an option.  Throws Error (kUsage) "OPTION
/// 'TEXT': expected ...".
std::vector<double> ReadNumbers(const char* option, const std::string& text, std::size_t count,
                                const std::string& expected);

}  // namespace graticule::apps
