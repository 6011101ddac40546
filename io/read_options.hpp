#pragma once

#include <optional>
#include <string_view>

namespace graticule {

/// What the rotation part of a 3D residual is, which a g2o file does not say (docs/formats.md).
enum class G2oRotation {
  kHalf,    ///< the vector part of the error quaternion, about half the angle: the tool g2o
  kDouble,  ///< twice the vector part: Ceres' example
  kFull,    ///< the rotation vector, the full angle: GTSAM
};

/// "half", "double", "full": as in options, `.fg` headers and comments in g2o files.
std::string_view ToString(G2oRotation rotation);
/// Empty if the word is none of these.
std::optional<G2oRotation> G2oRotationFromWord(std::string_view word);

/// How problem files are read.
struct ReadOptions {
  /// Lines whose first word is not known are counted and passed over instead of refused.
  bool skip_unknown = false;
  /// Overrules what the file's own comment says; without either: kHalf.
  std::optional<G2oRotation> rotation;
  /// Information matrices that are not positive definite are projected (ProjectInformation) and
  /// recorded, instead of refused.
  bool repair_information = false;
  /// ROBOTLASER1 lines of a g2o file, sweeps of a laser, are passed over in silence: ParseG2oLaser
  /// reads them.
  bool pass_over_sweeps = false;
};

}  // namespace graticule
