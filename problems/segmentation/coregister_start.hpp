#pragma once

#include <vector>

#include "graticule/problems/segmentation/coregister.hpp"

namespace graticule {

/// Where the camera may be, best first, and how far off half of the points then are.
struct CoregisterStart {
  Se3Array camera_from_lidar;
  double median_px = 0;
};

/// Poses from triples of points (P3P), all of them or 500 at random, ranked by the distance that
/// half of all points and two keep below (least median of squares, Rousseeuw 1984): up to half of
/// the points may be wrong.  At most `most`, no two of them alike.  Without points, from boards:
/// normals first, then offsets.
///
/// Throws Error (kIllPosed): fewer than 4 points (or 3 boards), all on a line, no pose that
/// explains half of them, or only one of their mirror image.
std::vector<CoregisterStart> FindCoregisterStarts(const CoregisterData& data, const Camera& camera,
                                                  const CoregisterOptions& options,
                                                  std::size_t most = 6);

}  // namespace graticule
