#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// A picture of shades, 0 black to 255 white, the top row first.
struct GreyImage {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> shades;
};

/// Reads PGM (P2, P5) or PNG, told apart by how they begin; colours become their mean, sixteen bits
/// eight, and transparency is ignored.  Throws Error "name: ...": neither, damaged, cut short,
/// larger than 2^31 shades.
GreyImage ParseGreyImage(std::string_view contents, const std::string& name);

/// Binary PGM (P5).
std::string FormatPgm(const GreyImage& image);
/// PNG of eight bits.  The same shades give the same bytes.
std::string FormatPng(const GreyImage& image);

}  // namespace graticule
