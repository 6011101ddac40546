#include "graticule/io/opencv_version.hpp"

#include <opencv2/core/version.hpp>

namespace graticule {

std::string OpenCvVersion() { return CV_VERSION; }

}  // namespace graticule
