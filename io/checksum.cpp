#include "graticule/io/checksum.hpp"

#include <xxhash.h>

namespace graticule {

std::string Checksum(std::string_view bytes) {
  constexpr char kHex[] = "0123456789abcdef";
  const XXH64_hash_t hash = XXH64(bytes.data(), bytes.size(), 0);
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits += kHex[(hash >> shift) & 15];
  return digits;
}

}  // namespace graticule
