#pragma once

#include <memory>
#include <vector>

#include "graticule/io/detections.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

struct DetectOptions {
  /// For live use: tags are looked for in a picture that is smaller by this factor, corners refined
  /// in the whole one; and what costs long is not tried where the quick way finds nothing.
  double decimate = 1;
};

/// Finds a target's corners in images.  One object may be asked by several threads at once.
///
/// - Mosaic: the four corners of every tag, where libapriltag's edges meet: there is no saddle that
///   could be refined.
/// - Grid and ChArUco: tags say where on the target they are; corners are predicted from the tags,
///   and then from each other, and refined as saddles; so corners of tags that could not be
///   read are found, too, however strong the lens' distortion.
/// - Chessboard: all corners or none (OpenCV's two detectors); the first one is the one whose
/// square
///   at larger x and y is black, the upper left one where that leaves a choice.
class TargetDetector {
 public:
  /// Throws Error (kUsage): CheckTarget.
  explicit TargetDetector(const Target& target, const DetectOptions& options = {});
  ~TargetDetector();

  const Target& Of() const;

  /// In the order of their ids; empty where there is no target.
  std::vector<DetectedCorner> Detect(const GreyImage& image) const;

 private:
  class Finder;
  class MosaicFinder;
  class SaddleTargetFinder;
  class ChessboardFinder;
  Target target_;
  std::unique_ptr<Finder> finder_;
};

}  // namespace graticule
