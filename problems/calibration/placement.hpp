#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "graticule/factors/make.hpp"
#include "graticule/io/detections.hpp"
#include "graticule/problems/calibration/camera.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// A target as guidance and simulation see it: corners in groups that are seen whole or not at all.
struct TargetLayout {
  std::vector<TargetCorner> corners;  ///< those of a tag follow one another
  std::size_t corners_per_tag = 4;    ///< 1 for targets of single corners (ChArUco)
  /// The printed side looks along -z (x right, y down as seen), or, true, along +z (x right, y up).
  bool printed_towards_z = false;

  std::size_t Tags() const { return corners.size() / corners_per_tag; }
  Eigen::Vector3d Centre() const;  ///< of the bounding box
  double Width() const;            ///< [m], the larger side of the bounding box
};

/// A target as its description has it.
TargetLayout LayoutOf(const Target& target);

/// Where and how a target should appear in an image.
struct Placement {
  double across = 0.5, down = 0.5;  ///< its centre, in image widths and heights
  double size = 0.5;                ///< its width if it faced the camera, in image widths
  /// From facing the camera (along the ray of its centre): about its own vertical, about its own
  /// horizontal, about the ray [rad].
  double tilt_sideways = 0, tilt_up = 0, roll = 0;
};

/// camera_from_target of a placement; none where no ray has its image there.
std::optional<Se3Array> PlaceTarget(const Camera& camera, const TargetLayout& target,
                                    const Placement& placement);

/// What a detector needs to find a tag.
struct Detectability {
  double min_edge_px = 12;  ///< the shortest edge of a tag; not asked of single corners
  double margin_px = 2;     ///< between a tag and the image's border
};

/// The corners that the camera sees of a target there, without noise: those of tags that are inside
/// the image and the model's angle whole, large enough, and seen from their printed side.
/// `warp` bends the board as the factor's board_warp/1.
std::vector<DetectedCorner> VisibleCorners(const Camera& camera, const TargetLayout& target,
                                           const Se3Array& camera_from_target,
                                           const std::array<double, 3>& warp = {},
                                           const Detectability& detectability = {});

}  // namespace graticule
