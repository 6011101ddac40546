#pragma once

// A fuzz target calls a parser with any bytes.  It may refuse them with an Error of one line;
// anything else (a crash, another exception, a sanitizer's finding) is a bug.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "../io/test_registry.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

template <class Parse>
int Fuzz(const std::uint8_t* data, std::size_t size, Parse parse) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    parse(text);
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}

}  // namespace graticule

#define GRATICULE_FUZZ(text)                                                    \
  static void Parse(std::string_view text);                                     \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* d, std::size_t n);  \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* d, std::size_t n) { \
    return graticule::Fuzz(d, n, Parse);                                        \
  }                                                                             \
  static void Parse(std::string_view text)
