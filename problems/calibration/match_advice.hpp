#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "graticule/problems/calibration/camera.hpp"
#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/suggest.hpp"

namespace graticule {

/// What to do with a target to bring it where it is suggested.  Left, right, up and down are the
/// picture's, as the camera takes it; a target that is tilted left turns its face to the picture's
/// left: its right edge comes nearer.
enum class TargetMove {
  kRight,
  kLeft,
  kDown,
  kUp,
  kFarther,
  kCloser,
  kTiltDown,
  kTiltUp,
  kTiltLeft,
  kTiltRight,
  kTurnClockwise,
  kTurnAnticlockwise,
};
/// "closer", "tilt left", "turn clockwise".
const char* WordsOf(TargetMove move);

/// How a live view of the target compares with the suggested one.
struct Match {
  /// Tags that are seen now and in the suggested view.
  std::size_t shared = 0;
  /// Mean distance between where those tags' centres are and where they should be; infinite where
  /// too few are shared.
  double distance_px = std::numeric_limits<double>::infinity();
  /// The same in cells of the suggested view's tags.
  double distance_cells = std::numeric_limits<double>::infinity();
  /// What to do, what matters most first; what moves tags by less than half a cell is not said.
  std::vector<TargetMove> moves;
  /// camera_from_target as the camera believes it to be; none where it cannot be told.
  std::optional<Se3Array> camera_from_target;
};

/// Compares live detections with one suggestion.
class SuggestionMatcher {
 public:
  SuggestionMatcher(const Camera& camera, const TargetLayout& target, const Suggestion& suggestion);

  /// Some tenths of a millisecond.  What is shared must be a third of what was suggested, and four
  /// tags at least (or all, of fewer), to have a distance.
  Match Compare(const std::vector<DetectedCorner>& live) const;

  /// A tenth of the distance between neighbouring tags' (or single corners') centres in the
  /// suggested view: a cell of AprilCal's mosaics.
  double CellPx() const { return cell_px_; }

 private:
  using Centres = std::map<std::size_t, Eigen::Vector2d>;  // by tag
  Centres CentresOf(const std::vector<DetectedCorner>& corners) const;
  std::vector<TargetMove> Moves(const Eigen::Isometry3d& now) const;

  Camera camera_;
  TargetLayout target_;
  std::map<int, std::size_t> tag_of_;  // by a corner's id
  std::vector<Eigen::Vector3d> tags_;  // centres, in the target's frame
  Eigen::Isometry3d suggested_;
  Centres centres_;
  double cell_px_ = 1;
};

}  // namespace graticule
