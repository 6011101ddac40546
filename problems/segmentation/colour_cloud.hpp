#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "graticule/io/cloud.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/problems/calibration/camera.hpp"

namespace graticule {

struct ColourOptions {
  /// A point is hidden where others around its pixel are nearer by more than this [m], or by this
  /// share of its depth, whichever is more.
  double hidden_m = 0.3, hidden_share = 0.05;
};

/// What a picture says of a cloud's points.
struct CloudColours {
  std::vector<Rgb> colours;                       ///< black where the picture says nothing
  std::vector<std::uint8_t> is_seen;              ///< 1 where it does
  std::size_t seen = 0, hidden = 0, outside = 0;  ///< numbers of points with a return
};

/// The colours of points by their pixels: p = d(K E T r), thesis Equation 4.1, through any of the
/// camera models.  `camera_from_lidar` is x y z [m] qx qy qz qw.  The pixel is interpolated between
/// its four neighbours.
///
/// A point that is hidden from the camera, though not from the LIDAR, gets no colour: where the
/// nearest points of the cells left and right of its own, or above and below, or of its own, are
/// nearer.  Cells are as large as points are apart.  Throws Error (kInput): the picture is not of
/// the camera's size.
CloudColours ColoursOf(const PointCloud& cloud, const ColourImage& image, const Camera& camera,
                       const std::array<double, 7>& camera_from_lidar,
                       const ColourOptions& options = {});

/// The cloud in these colours.  Points that are not seen have no return, as in thesis section 4.2,
/// or stay and are black.
PointCloud Coloured(const PointCloud& cloud, const CloudColours& colours, bool keep_unseen);

}  // namespace graticule
