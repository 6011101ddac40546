#include "numbers.hpp"

#include <charconv>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule::apps {

std::vector<double> ReadNumbers(const char* option, const std::string& text, std::size_t count,
                                const std::string& expected) {
  std::vector<double> numbers(count);
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    const bool ends_well = i + 1 < count ? next != end && *next == ',' : next == end;
    if (error != std::errc() || !ends_well || !std::isfinite(numbers[i]))
      throw Error(std::string(option) + " '" + text + "': expected " + expected, ErrorKind::kUsage);
    at = next + 1;
  }
  return numbers;
}

}  // namespace graticule::apps
