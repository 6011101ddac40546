#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "graticule/io/detections.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/match_advice.hpp"

namespace graticule {

/// Corners of one frame of a live picture.
struct LiveFrame {
  std::size_t number = 0;
  double seconds = 0;  ///< when it was taken
  std::vector<DetectedCorner> corners;
  double sharpness = 0;  ///< SharpnessOf; 0: not known
};

/// How sharp a picture is where a target is: the root mean square of the difference from pixel to
/// pixel within the corners' bounding box.  Of the same view, motion and lost focus make it less.
double SharpnessOf(const GreyImage& image, const std::vector<DetectedCorner>& corners);

/// Mean distance that corners moved from one frame to another [px]; infinite where none is in both.
double MotionBetween(const LiveFrame& a, const LiveFrame& b);

struct CaptureOptions {
  /// A suggestion is matched when its tags are nearer than this many cells (AprilCal: one) ...
  double reached_cells = 1;
  /// ... and one more for each of these seconds that it was waited for, up to the most: hands
  /// tremble, and where exactly a frame was taken matters little.
  double patience_s = 10, most_cells = 3;
  /// Steady: corners move less from frame to frame, in thousandths of the image's width.
  double steady_thousandths = 3;
  /// Matched and steady frames of so long are collected, and the best is kept.
  double window_s = 0.5;
  std::size_t fewest = 3;  ///< of them; fewer were an accident
};

/// What a frame meant to the capture.
struct CaptureState {
  double limit_cells = 0;  ///< that counts as matched now
  bool is_matched = false, is_steady = false;
  double progress = 0;  ///< of the window, 0 to 1
};

/// Takes a frame by itself when the target is held where it is suggested, and held still: of the
/// frames of a short window the one that moved least, and among those that moved about as little
/// the sharpest.
class LiveCapture {
 public:
  explicit LiveCapture(int image_width, const CaptureOptions& options = {});

  /// A new suggestion is shown from this time on.
  void Begin(double seconds);
  /// The frame that was decided for, if this one ended the window.
  std::optional<LiveFrame> Offer(const LiveFrame& frame, const Match& match);
  const CaptureState& State() const { return state_; }

 private:
  struct Candidate {
    LiveFrame frame;
    double motion_px;
  };
  std::optional<LiveFrame> Decide();

  CaptureOptions options_;
  double steady_px_;
  double begun_s_ = 0;
  std::optional<LiveFrame> previous_;
  std::vector<Candidate> window_;
  CaptureState state_;
};

}  // namespace graticule
