#pragma once

#include "arrays.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/io/photo.hpp"

namespace graticule::python {

/// (height, width) shades, the top row first.
GreyImage GreyOf(const Dense<std::uint8_t>& pixels);
py::array_t<std::uint8_t> ArrayOf(GreyImage&& image);
/// (height, width, 3): red, green, blue.
ColourImage ColourOf(const Dense<std::uint8_t>& pixels);
py::array_t<std::uint8_t> ArrayOf(ColourImage&& image);

}  // namespace graticule::python
