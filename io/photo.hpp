#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/grey_image.hpp"

namespace graticule {

/// A picture in colours, red green blue, 0 to 255, the top row first.
struct ColourImage {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Reads what a camera took, in any format that OpenCV reads (JPEG, PNG, TIFF, BMP, PGM, WebP,
/// ...), as the sensor saw it: without turning it as its metadata may ask, for a calibration is of
/// the sensor.  Colours become grey by the usual weights, sixteen bits eight.  Throws Error "name:
/// ...": no picture, damaged.
GreyImage ParseGreyPhoto(std::string_view contents, const std::string& name);
GreyImage ReadGreyPhoto(const std::string& path);

/// The same in colours; of a grey picture all three are equal.
ColourImage ReadColourPhoto(const std::string& path);

/// Whether a name ends as pictures' do.
bool IsPhotoName(const std::string& path);

/// JPEG and PNG bytes: for pages and reports.  The quality is 1 to 100.
std::string FormatJpeg(const ColourImage& image, int quality = 85);
std::string FormatJpeg(const GreyImage& image, int quality = 85);
std::string FormatPng(const ColourImage& image);
/// Sixteen bits a pixel, the top row first.
std::string FormatPng16(const std::vector<std::uint16_t>& shades, std::size_t width);

}  // namespace graticule
