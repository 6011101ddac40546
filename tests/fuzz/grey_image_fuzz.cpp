#include "fuzz.hpp"
#include "graticule/io/grey_image.hpp"

// What was read is written in both formats, and read again the same.
GRATICULE_FUZZ(text) {
  const graticule::GreyImage image = graticule::ParseGreyImage(text, "fuzz");
  for (const std::string& written : {FormatPgm(image), FormatPng(image)})
    if (graticule::ParseGreyImage(written, "again").shades != image.shades) __builtin_trap();
}
