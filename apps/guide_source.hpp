#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/problems/calibration/target.hpp"
#include "guide_session.hpp"

namespace graticule::apps {

/// A frame of a source.
struct SourceFrame {
  GreyImage image;
  double seconds = 0;  ///< since the source's first
  /// A simulation that does without detection says what is seen.
  std::optional<std::vector<DetectedCorner>> corners;
  /// A picture that somebody chose to take: it is kept without waiting for a match.
  bool is_chosen = false;
};

/// Where pictures come from.
class GuideSource {
 public:
  virtual ~GuideSource() = default;
  virtual ImageSize Size() const = 0;
  /// Waits for the next frame, as long as a live source takes; none at its end.  Where nobody
  /// watches, a frame that says what is seen need have no picture.
  virtual std::optional<SourceFrame> Next(const Guidance& guidance, bool is_watched) = 0;
  /// A film's last frame was shown, and is shown on where it is live.  May be asked by any thread.
  virtual bool IsAtEnd() const { return false; }
  /// The camera that a simulation looks through.
  virtual const CameraIntrinsics* Truth() const { return nullptr; }
};

/// The source that the command's words mean.  `is_live`: frames come as time goes by, not as fast
/// as they are asked for, and a folder is watched for new pictures.  Throws Error.
std::unique_ptr<GuideSource> OpenSource(const CalibrateGuideCommand& command, const Target& target,
                                        bool is_live);

}  // namespace graticule::apps
