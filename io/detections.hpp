#pragma once

#include <array>
#include <string>
#include <vector>

namespace graticule {

/// A corner of a target, seen in an image.
struct DetectedCorner {
  int id = 0;                            ///< the same corner has the same id in every view
  std::array<double, 3> in_target = {};  ///< m
  std::array<double, 2> pixel = {};      ///< (0, 0) is the centre of the upper left one
};

/// What one camera saw of the target at one time.
struct TargetView {
  std::string image;         ///< its name, for messages
  std::size_t camera = 0;    ///< into Detections::cameras
  std::size_t exposure = 0;  ///< views of one exposure saw the target at one place
  std::vector<DetectedCorner> corners;
};

/// Size of a camera's images.
struct ImageSize {
  std::string camera;         ///< its name, "cam0"
  int width = 0, height = 0;  ///< px
};

/// Everything that calibration looks at: the corners of one rigid target, seen by one or several
/// cameras.
struct Detections {
  std::vector<ImageSize> cameras;
  std::vector<TargetView> views;
  std::size_t exposures = 0;
};

}  // namespace graticule
