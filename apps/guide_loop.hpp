#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>

#include "graticule/problems/calibration/detect.hpp"
#include "graticule/problems/calibration/live_capture.hpp"
#include "graticule/problems/calibration/match_advice.hpp"
#include "guide_session.hpp"
#include "guide_source.hpp"

namespace graticule::apps {

/// What one frame of the live picture showed.
struct LiveView {
  std::size_t number = 0;  ///< of the frame, from 1
  double seconds = 0, frames_per_second = 0;
  std::vector<DetectedCorner> corners;
  Match match;
  CaptureState capture;
  std::size_t guidance = 0;  ///< the change of the session that it was compared with
  bool is_busy = false, is_done = false;
  bool is_rectified = false;  ///< the picture; corners are the camera's own
};

/// Where the live thread leaves the newest frame, and requests wait for it.
class LiveBoard {
 public:
  /// `jpeg` is empty where nobody is looking.
  void Put(LiveView view, std::string jpeg);
  /// The newest view, once it is newer than `after`; or whatever there is after a second.
  LiveView WaitFor(std::size_t after);
  /// The newest picture, JPEG; empty before the first.
  std::string Picture();
  /// Somebody asked for a picture lately.
  bool IsWatched() const;
  /// Ends waits.
  void Close();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  LiveView view_;
  std::string jpeg_;
  bool is_closed_ = false;
  std::atomic<double> last_asked_s_{-1e9};
};

struct LoopOptions {
  CaptureOptions capture;
  double decimate = 2;  ///< of the detection
  /// Changes are solved before the next frame: the same frames give the same calibration.
  bool is_synchronous = false;
};

/// How long the parts of a frame took, all frames together [s].
struct LoopTimes {
  std::size_t frames = 0;
  double source_s = 0, detect_s = 0, advise_s = 0, picture_s = 0, solve_s = 0;
};

/// Frame by frame: detects, compares with the suggestion, captures, shows.  Step and what it does
/// belong to one thread; the requests below may come from any.
class GuideLoop {
 public:
  GuideLoop(GuideSource* source, GuideSession* session, LiveBoard* board, const Target& target,
            const LoopOptions& options);

  /// One frame; false at the source's end.
  bool Step();
  const LoopTimes& Times() const { return times_; }

  /// Takes the next frame that shows the target, matched or not.
  void CaptureNow() { capture_now_ = true; }
  /// Shows the rectified view, and captures no more.
  void SetDone(bool is_done) { is_done_ = is_done; }

 private:
  void Take(const LiveFrame& frame);
  void Show(const SourceFrame& frame, LiveView view);

  GuideSource& source_;
  GuideSession& session_;
  LiveBoard& board_;
  TargetLayout layout_;
  LoopOptions options_;
  TargetDetector detector_;
  LiveCapture capture_;
  Guidance guidance_;
  std::optional<SuggestionMatcher> matcher_;
  std::size_t number_ = 0;
  double last_s_ = 0, mean_s_ = 0;  // from frame to frame
  LoopTimes times_;
  std::atomic<bool> capture_now_{false}, is_done_{false};
};

}  // namespace graticule::apps
