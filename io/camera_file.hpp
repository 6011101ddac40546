#pragma once

#include <string>
#include <vector>

namespace graticule {

/// A camera's intrinsic parameters, as its files have them.
struct CameraIntrinsics {
  std::string name;                ///< "cam0", "" where a file has none
  std::string model;               ///< "angular4": factors/camera_model.hpp
  int width = 0, height = 0;       ///< px
  std::vector<double> parameters;  ///< fx fy cx cy [px], then the model's terms
};

}  // namespace graticule
