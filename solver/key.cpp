#include "graticule/solver/key.hpp"

#include <charconv>
#include <cstring>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool IsFamily(std::string_view name) {
  if (name.empty() || name.size() > Key::kMaxFamily || !IsLetter(name[0])) return false;
  for (const char c : name)
    if (!IsLetter(c) && !(c >= '0' && c <= '9') && c != '_' && c != '-' && c != '.') return false;
  return true;
}

}  // namespace

int Key::Name::compare_to(const Name& other) const {
  return std::memcmp(data(), other.data(), kMaxFamily);
}

Key::Key(std::string_view family, std::uint64_t number) : number_(number) {
  if (!IsFamily(family))
    throw Error("expected a key family (a letter, then up to 22 of A-Z a-z 0-9 _ . -), found '" +
                std::string(family.substr(0, 60)) + "'");
  std::memcpy(family_.data(), family.data(), family.size());
  size_ = static_cast<std::uint8_t>(family.size());
}

Key::Key(std::string_view text) {
  if (!Parse(text, this))
    throw Error("expected a key such as pose:12, found '" + std::string(text.substr(0, 60)) + "'");
}

bool Key::Parse(std::string_view text, Key* key) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || !IsFamily(text.substr(0, colon))) return false;
  const char* end = text.data() + text.size();
  std::uint64_t number = 0;
  const auto [stop, problem] = std::from_chars(text.data() + colon + 1, end, number);
  if (problem != std::errc() || stop != end) return false;
  *key = Key(text.substr(0, colon), number);
  return true;
}

std::string Key::ToString() const {
  std::string text(Family());
  text += ':';
  text += std::to_string(number_);
  return text;
}

std::size_t KeyHash::operator()(const Key& key) const {
  // FNV over the family's three words, then a multiplicative mix with the number.
  std::uint64_t words[3] = {0, 0, 0};
  std::memcpy(words, key.family_.data(), Key::kMaxFamily);
  std::uint64_t h = 1469598103934665603ULL;
  for (const std::uint64_t w : {words[0], words[1], words[2], key.number_}) {
    h = (h ^ w) * 0x9E3779B97F4A7C15ULL;
    h ^= h >> 29;
  }
  return h;
}

}  // namespace graticule
