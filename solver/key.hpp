#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace graticule {

/// The name of a variable: a family and a number, written `pose:12`.
///
/// A family is 1 to 23 characters of [A-Za-z0-9_.-], and begins with a letter.  Keys are ordered by
/// family, then by number, so `pose:9` comes before `pose:10`.  A plain value of 32 bytes: graphs
/// hold one a variable, factors refer to it by position.
class Key {
 public:
  static constexpr std::size_t kMaxFamily = 23;

  /// Throws Error if `family` is not a legal family name.
  Key(std::string_view family, std::uint64_t number);

  /// Reads `family:number`.  Throws Error if the text is anything else.
  explicit Key(std::string_view text);

  /// The same, without an exception: false if the text is not a key.
  static bool Parse(std::string_view text, Key* key);

  std::string_view Family() const { return {family_.data(), size_}; }
  std::uint64_t Number() const { return number_; }
  std::string ToString() const;

  friend bool operator==(const Key& a, const Key& b) {
    return a.number_ == b.number_ && a.family_ == b.family_;
  }
  friend bool operator!=(const Key& a, const Key& b) { return !(a == b); }
  friend bool operator<(const Key& a, const Key& b) {
    const int order = a.family_.compare_to(b.family_);
    return order != 0 ? order < 0 : a.number_ < b.number_;
  }

 private:
  friend struct KeyHash;
  struct Name : std::array<char, kMaxFamily> {
    int compare_to(const Name& other) const;
  };

  Key() = default;
  Name family_{};  // padded with zeros, so that bytewise order is the order of the names
  std::uint8_t size_ = 0;
  std::uint64_t number_ = 0;
};

struct KeyHash {
  std::size_t operator()(const Key& key) const;
};

}  // namespace graticule
