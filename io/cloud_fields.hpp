#pragma once

// Internal to the readers of clouds: which of a point's fields is which, and their values.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

/// A number that a file has for every point.
struct CloudField {
  std::string name;
  char kind = 'F';        ///< I, U, F: as PCD's TYPE
  std::size_t size = 4;   ///< bytes: 1, 2, 4, 8
  std::size_t count = 1;  ///< numbers of this kind
  std::size_t Bytes() const { return size * count; }
};

/// Bytes of a file, and what to call it.
struct CloudBytes {
  std::string_view bytes;
  const std::string& name;
  bool is_big_endian = false;
};

/// Where a field's numbers are: at begin + i * stride.
struct CloudPlace {
  std::size_t begin = 0, stride = 0;
};

/// The fields of a file's points.
class CloudFields {
 public:
  /// Nothing, or what is wrong with them: no x, one that is there twice.
  std::optional<std::string> SetFields(std::vector<CloudField> fields);
  const std::vector<CloudField>& Fields() const { return fields_; }
  /// Bytes of a point.
  std::size_t PointBytes() const;
  /// Of a text's line.
  std::size_t NumbersOfPoint() const;

  /// Points whose fields lie at places; the caller has checked that the bytes hold them.
  void ReadBinary(const CloudBytes& file, const std::vector<CloudPlace>& places, std::size_t count,
                  PointCloud* cloud) const;
  /// Points that are words; each begins a line.
  void ReadText(TextReader* reader, std::size_t count, PointCloud* cloud) const;

 private:
  enum Role { kX, kY, kZ, kPacked, kRed, kGreen, kBlue, kIntensity, kLabel, kRoles };
  static std::optional<Role> RoleOf(const std::string& name);
  void Reserve(std::size_t count, PointCloud* cloud) const;
  std::optional<std::string> Append(const double* values, PointCloud* cloud) const;

  std::vector<CloudField> fields_;
  std::vector<std::optional<Role>> roles_;
  std::optional<std::size_t> field_of_role_[kRoles];
};

/// Refuses more points than an index of 32 bits counts.
inline constexpr std::size_t kMostPoints = 0xffffffffu;

/// A whole number of a binary file.
std::uint64_t UnsignedAt(const char* at, std::size_t size, bool is_big_endian);

/// Throws Error "name: at byte N: message".
[[noreturn]] void FailAtByte(const std::string& name, std::size_t byte, const std::string& message);

}  // namespace graticule
