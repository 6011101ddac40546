#pragma once

// Internal to the writers of clouds: numbers as little-endian bytes.

#include <cstdint>
#include <cstring>
#include <string>

namespace graticule {

inline void AppendUnsigned(std::string* bytes, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) bytes->push_back(static_cast<char>(number >> 8 * i & 0xff));
}

inline void AppendFloat(std::string* bytes, float number) {
  std::uint32_t bits;
  std::memcpy(&bits, &number, sizeof(bits));
  AppendUnsigned(bytes, bits);
}

}  // namespace graticule
