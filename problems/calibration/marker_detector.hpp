#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/marker_codes.hpp"

namespace graticule {

/// A marker in an image.
struct SeenMarker {
  int id = 0;
  /// Upper left, upper right, lower right, lower left as it is printed upright [px]; pixel (0, 0)
  /// is the centre of the upper left one.
  std::array<Eigen::Vector2d, 4> corners;
};

struct MarkerOptions {
  int border_cells = 1;
  /// Squares are looked for in a picture that is smaller by this factor; their edges are then found
  /// in the whole one.  2 is four times faster, and misses tags of less than some 20 px.
  double decimate = 1;
  /// Black shrinks by a pixel first: squares that touch at their corners (Kalibr's grids) come
  /// apart; the corners that are found are only as good as that.
  bool shrink_black = false;
};

/// Finds markers by libapriltag; OpenCV's dictionaries too, as families of its own form.  One
/// object may be asked by several threads at once: each gets a detector of its own, which is kept.
class MarkerDetector {
 public:
  MarkerDetector(const MarkerFamily& family, const MarkerOptions& options);
  ~MarkerDetector();

  /// In the order of their ids; of an id that is seen twice, none.
  std::vector<SeenMarker> Detect(const GreyImage& image) const;

 private:
  class Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace graticule
