#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "graticule/problems/calibration/session.hpp"
#include "graticule/problems/calibration/undistort.hpp"

namespace graticule::apps {

/// A parameter of the camera, as it is known.
struct GuideParameter {
  std::string name, unit;
  double value = 0, deviation = 0;
  bool is_loose = false;  ///< the frames do not constrain it yet
};

/// After a frame.
struct GuideStep {
  double max_ere_px = 0;
  bool is_bootstrapping = true;  ///< that is no accuracy yet
};

/// What a session says after each change: a copy that nobody changes.
struct Guidance {
  std::size_t number = 0;   ///< of the change
  bool is_busy = false;     ///< another change is being solved
  CameraIntrinsics camera;  ///< a guessed one at first
  std::optional<Suggestion> suggestion;
  std::vector<GuideStep> steps;  ///< one a frame
  bool is_solved = false, is_bootstrapping = true, is_met = false;
  double rms_px = 0, sigma_px = 0;
  std::vector<GuideParameter> parameters;
  EreMap map;           ///< over the image; empty before anything is known
  std::string message;  ///< what became of the last frame, where it was not simply used
};

/// A calibration session that is solved by a thread of its own: whoever adds a frame does not
/// wait.  All members may be called by any thread.
class GuideSession {
 public:
  GuideSession(const Registry& types, const TargetLayout& target, const ImageSize& image,
               const SessionOptions& options);
  /// Ends after the change that is being solved.
  ~GuideSession();
  GuideSession(const GuideSession&) = delete;
  GuideSession& operator=(const GuideSession&) = delete;

  void Add(std::vector<DetectedCorner> corners);
  /// Takes the last frame back: the others are solved anew.
  void RemoveLast();
  /// Waits until every change is solved.
  void Settle();

  Guidance Now() const;
  /// Only if it is another than `number`, or busy or not.
  bool IsNewer(std::size_t number, bool is_busy) const;

  /// A view without distortion; none before the camera is solved.  The first after a change takes
  /// some tenths of a second.
  std::optional<GreyImage> Rectified(const GreyImage& image);

  /// Looks at the session itself, between changes.
  template <class Look>
  void With(const Look& look) const {
    const std::lock_guard<std::mutex> lock(session_mutex_);
    look(session_);
  }

 private:
  struct Change {
    bool is_removal = false;
    std::vector<DetectedCorner> corners;
  };
  void Work();
  std::string Apply(const Change& change);
  void Describe(Guidance* guidance) const;

  // Before the first lock: never changed.
  Registry types_;
  TargetLayout target_;
  ImageSize image_;
  SessionOptions options_;

  mutable std::mutex session_mutex_;  // held while a change is solved
  CalibrationSession session_;
  std::vector<GuideStep> steps_;

  mutable std::mutex mutex_;  // of all below; taken after session_mutex_, if both
  std::condition_variable wake_, idle_;
  std::deque<Change> changes_;
  bool is_working_ = false, is_stopping_ = false;
  Guidance guidance_;

  std::mutex rectifier_mutex_;
  std::unique_ptr<Rectifier> rectifier_;
  std::vector<double> rectified_camera_;

  std::thread thread_;
};

}  // namespace graticule::apps
