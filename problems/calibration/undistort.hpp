#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/camera.hpp"

namespace graticule {

enum class RectifyKeep {
  kValid,  ///< the widest view in which every pixel has something to show
  kAll,    ///< a view that holds every pixel of the camera, with empty corners
};

struct RectifyOptions {
  RectifyKeep keep = RectifyKeep::kValid;
  int width = 0, height = 0;  ///< of the view [px]; 0: the camera's
  /// From the optical axis: what lies farther out is given up, since a pinhole's image of it grows
  /// without bound [rad].
  double widest_rad = 1.1;
};

/// A pinhole camera that looks where the camera looks, its centre at the same place of the image,
/// and sees as much of it as is asked for.
CameraIntrinsics RectifiedView(const Camera& camera, const RectifyOptions& options = {});

/// Turns images of one camera into those of another one at the same place: undistortion, where the
/// other one is a pinhole.
class Rectifier {
 public:
  /// Projects every pixel of `to` once; images are fast.  Throws Error (kUsage): more than 2^28
  /// pixels.
  Rectifier(const Camera& from, const Camera& to);

  std::size_t Width() const { return width_; }
  std::size_t Height() const { return height_; }

  /// Where in the image of `from` each pixel of `to` is, row by row; -1 where there is nothing.
  const std::vector<float>& X() const { return x_; }
  const std::vector<float>& Y() const { return y_; }
  /// The share of pixels that have something to show.
  double Filled() const;

  /// The image of `to`, black where there is nothing.  Throws Error (kUsage): another size than
  /// the images of `from`.
  GreyImage Image(const GreyImage& image) const;
  /// The same for pixels of `channels` bytes (1, 3 or 4) in rows of `row_bytes`; `out` has room for
  /// Width() * Height() * channels.
  void Image(const std::uint8_t* pixels, std::size_t row_bytes, int channels,
             std::uint8_t* out) const;

 private:
  int from_width_, from_height_;
  std::size_t width_, height_;
  std::vector<float> x_, y_;
};

}  // namespace graticule
