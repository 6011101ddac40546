#include "graticule/io/readable.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace graticule {
namespace {

constexpr const char* kUnknown = "–";

// fmt writes 1e-07, 1e+06: people write 1e-7, 1e6.
std::string ShortExponent(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  std::size_t from = e + 1;
  if (text[from] == '+')
    text.erase(from, 1);
  else
    ++from;
  while (from + 1 < text.size() && text[from] == '0') text.erase(from, 1);
  return text;
}

// Three significant digits and their zeros, so that columns of numbers line up: 1.20, 12.0, 120.
std::string ThreeDigits(double value) {
  const int decimals = value < 9.995 ? 2 : value < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}", value, decimals);
}

char32_t NextCodePoint(std::string_view* text) {
  const auto first = static_cast<unsigned char>((*text)[0]);
  const std::size_t length = first < 0xc0 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  char32_t code = length == 1 ? first : first & (0x7fu >> length);
  std::size_t used = 1;
  while (used < length && used < text->size() &&
         (static_cast<unsigned char>((*text)[used]) & 0xc0) == 0x80)
    code = (code << 6) | (static_cast<unsigned char>((*text)[used++]) & 0x3f);
  text->remove_prefix(used);
  return code;
}

// The blocks that terminals draw two columns wide, and the marks that take none.
constexpr std::pair<char32_t, char32_t> kWide[] = {
    {0x1100, 0x115f}, {0x2e80, 0xa4cf},   {0xac00, 0xd7a3},   {0xf900, 0xfaff},  {0xfe30, 0xfe6f},
    {0xff00, 0xff60}, {0x1f300, 0x1f64f}, {0x1f900, 0x1f9ff}, {0x20000, 0x3fffd}};
constexpr std::pair<char32_t, char32_t> kZero[] = {
    {0x0300, 0x036f}, {0x200b, 0x200f}, {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}, {0xfe20, 0xfe2f}};

template <std::size_t N>
bool In(const std::pair<char32_t, char32_t> (&blocks)[N], char32_t code) {
  for (const auto& [first, last] : blocks)
    if (code >= first && code <= last) return true;
  return false;
}

}  // namespace

std::string ReadableNumber(double number, int digits) {
  if (!std::isfinite(number)) return kUnknown;
  if (number == 0) return "0";
  const double size = std::fabs(number);
  // Whole numbers below a million are easier to read than 1.235e5.
  if (size < 999999.5 && size >= std::pow(10, digits) - 0.5) return fmt::format("{:.0f}", number);
  return ShortExponent(fmt::format("{:.{}g}", number, digits));
}

std::string ReadableCount(std::uint64_t count) {
  std::string text = fmt::format("{}", count);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string ReadableSeconds(double seconds) {
  if (!std::isfinite(seconds)) return kUnknown;
  if (seconds < 0) return "-" + ReadableSeconds(-seconds);
  if (seconds == 0) return "0 s";
  if (seconds < 0.9995e-3) return ThreeDigits(seconds * 1e6) + " µs";
  if (seconds < 0.9995) return ThreeDigits(seconds * 1e3) + " ms";
  if (seconds < 599.5) return ThreeDigits(seconds) + " s";
  const long long whole = std::llround(seconds);
  if (whole < 2 * 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string ReadableBytes(std::uint64_t bytes) {
  if (bytes == 0) return kUnknown;
  const double size = static_cast<double>(bytes);
  if (size < 1024 * 1023.5) return ThreeDigits(size / 1024) + " KiB";
  if (size < 1024 * 1024 * 1023.5) return ThreeDigits(size / (1024 * 1024)) + " MiB";
  return ThreeDigits(size / (1024.0 * 1024 * 1024)) + " GiB";
}

std::string ReadableGap(double gap) {
  if (!std::isfinite(gap)) return kUnknown;
  if (gap == 0) return "0";
  const double size = std::fabs(gap);
  const char* sign = gap < 0 ? "-" : "+";
  if (size < 1e-5) return sign + ShortExponent(fmt::format("{:.1e}", size));
  if (size >= 10) return sign + ShortExponent(fmt::format("{:.3g}", size)) + "x";
  return fmt::format("{}{:.{}f} %", sign, size * 100, size < 1e-3 ? 4 : size < 0.1 ? 2 : 1);
}

std::size_t DisplayWidth(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const char32_t code = NextCodePoint(&text);
    width += In(kZero, code) ? 0 : In(kWide, code) ? 2 : 1;
  }
  return width;
}

}  // namespace graticule
