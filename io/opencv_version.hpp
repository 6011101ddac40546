#pragma once

#include <string>

namespace graticule {

/// Of the OpenCV that this was compiled with, "4.6.0".  Loads nothing of it.
std::string OpenCvVersion();

}  // namespace graticule
