#include "fuzz.hpp"
#include "graticule/io/photo.hpp"

GRATICULE_FUZZ(bytes) {
  const graticule::GreyImage image = graticule::ParseGreyPhoto(bytes, "fuzz.jpg");
  if (image.shades.size() != image.width * image.height) std::abort();
}
