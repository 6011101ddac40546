#pragma once

#include <cairo.h>

#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace graticule::test {

/// A picture as 0xRRGGBB, row by row.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;

  std::uint32_t At(int x, int y) const { return pixels[static_cast<std::size_t>(y * width + x)]; }
  std::size_t Colours() const {
    return std::set<std::uint32_t>(pixels.begin(), pixels.end()).size();
  }
};

inline Picture ReadPng(const std::string& png) {
  struct Reader {
    const std::string& data;
    std::size_t at;
  } reader{png, 0};
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(
      [](void* closure, unsigned char* data, unsigned int length) {
        Reader& from = *static_cast<Reader*>(closure);
        if (from.data.size() - from.at < length) return CAIRO_STATUS_READ_ERROR;
        from.data.copy(reinterpret_cast<char*>(data), length, from.at);
        from.at += length;
        return CAIRO_STATUS_SUCCESS;
      },
      &reader);
  if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) throw std::runtime_error("not a PNG");
  Picture picture;
  picture.width = cairo_image_surface_get_width(surface);
  picture.height = cairo_image_surface_get_height(surface);
  const unsigned char* row = cairo_image_surface_get_data(surface);
  for (int y = 0; y < picture.height; ++y, row += cairo_image_surface_get_stride(surface))
    for (int x = 0; x < picture.width; ++x)
      picture.pixels.push_back(reinterpret_cast<const std::uint32_t*>(row)[x] & 0xffffff);
  cairo_surface_destroy(surface);
  return picture;
}

}  // namespace graticule::test
