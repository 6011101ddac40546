#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <thread>

#include "camera_output.hpp"
#include "commands.hpp"
#include "graticule/io/detections.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/target.hpp"
#include "guide_loop.hpp"
#include "guide_server.hpp"
#include "guide_session.hpp"
#include "guide_source.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

SessionOptions SessionOptionsOf(const CalibrateGuideCommand& command) {
  SessionOptions options;
  options.calibration.model = command.model;
  options.calibration.board = command.board == "free"     ? BoardShape::kFree
                              : command.board == "warped" ? BoardShape::kWarped
                                                          : BoardShape::kFlat;
  options.calibration.sigma_px = command.sigma_px;
  options.accuracy_px = command.accuracy_px;
  return options;
}

LoopOptions LoopOptionsOf(const CalibrateGuideCommand& command) {
  LoopOptions options;
  options.decimate = command.decimate;
  options.is_synchronous = command.is_headless;
  double every_s = command.take_every_s;
  if (every_s < 0) every_s = command.video.empty() ? 0 : 1;
  if (every_s > 0) {
    options.capture.reached_cells = options.capture.most_cells = HUGE_VAL;
    options.capture.window_s = every_s;
  }
  return options;
}

// What is left of a session: written, and said.
struct Outcome {
  Guidance guidance;
  CameraRig rig;
  Detections detections;
  bool is_constrained = false;
};

Outcome OutcomeOf(const GuideSession& session) {
  Outcome outcome;
  outcome.guidance = session.Now();
  session.With([&](const CalibrationSession& s) {
    outcome.detections = s.Frames();
    if (!s.Solved()) return;
    const Eigen::MatrixXd covariance = s.Uncertainty()->OfCamera(0);
    outcome.rig.cameras.push_back({s.Solved()->state.cameras[0],
                                   kIdentityPose,
                                   {covariance.data(), covariance.data() + covariance.size()}});
    outcome.rig.meta["made-by"] = MadeBy("calibrate guide");
    outcome.rig.meta["rms_px"] = fmt::format("{:.6g}", s.Solved()->rms_px);
    outcome.rig.meta["sigma_px"] = fmt::format("{:.6g}", s.SigmaPx());
    outcome.rig.meta["max_ere_px"] = fmt::format("{:.6g}", s.MaxEre().MaxPx());
    outcome.is_constrained = !s.IsBootstrapping() && s.Uncertainty()->Constrained();
  });
  return outcome;
}

// Files of what is known so far; nothing where nothing is.
void Write(const CalibrateGuideCommand& command, const std::vector<CameraOutput>& outputs,
           const Outcome& outcome) {
  if (!outcome.rig.cameras.empty()) WriteAll(outputs, outcome.rig);
  if (!command.detections.empty() && !outcome.detections.views.empty())
    WriteDetections(command.detections, outcome.detections);
}

std::string FilesOf(const CalibrateGuideCommand& command,
                    const std::vector<CameraOutput>& outputs) {
  std::string files;
  for (const CameraOutput& output : outputs) files += (files.empty() ? "" : ", ") + output.path;
  if (!command.detections.empty()) files += (files.empty() ? "" : ", ") + command.detections;
  return files;
}

// Largest difference to the camera that was simulated, the frame's rotation taken out.
double ErrorAgainst(const CameraIntrinsics& truth, const CameraIntrinsics& found) {
  DifferenceOptions options;
  options.nodes = 25;
  const CalibrationDifference difference = Difference(Camera(truth), Camera(found), options);
  return difference.unseen > 0 ? HUGE_VAL : difference.max_px;
}

int Conclude(const CalibrateGuideCommand& command, const Outcome& outcome, const LoopTimes& times,
             double wall_s, const CameraIntrinsics* truth) {
  if (outcome.rig.cameras.empty())
    throw Error("nothing is known of the camera: no frame was taken that a camera explains",
                ErrorKind::kIllPosed);
  const Guidance& guidance = outcome.guidance;
  const double count = static_cast<double>(std::max<std::size_t>(1, times.frames));
  const double live_s = times.detect_s + times.advise_s + times.picture_s;
  const double max_ere = guidance.steps.back().max_ere_px;
  if (command.json) {
    nlohmann::ordered_json json = {
        {"model", guidance.camera.model}, {"frames", guidance.steps.size()},
        {"met", guidance.is_met},         {"max_ere_px", max_ere},
        {"rms_px", guidance.rms_px},      {"sigma_px", guidance.sigma_px}};
    for (const GuideParameter& p : guidance.parameters)
      json["parameters"][p.name] = {
          {"value", p.value}, {"deviation", p.deviation}, {"constrained", !p.is_loose}};
    for (const GuideStep& step : guidance.steps)
      json["max_ere_by_frame_px"].push_back(step.max_ere_px);
    if (truth) json["largest_error_px"] = ErrorAgainst(*truth, guidance.camera);
    json["live"] = {{"frames", times.frames},
                    {"frames_per_second", count / wall_s},
                    {"frames_per_second_without_source_and_solves", count / std::max(1e-9, live_s)},
                    {"source_ms", 1e3 * times.source_s / count},
                    {"detect_ms", 1e3 * times.detect_s / count},
                    {"advise_ms", 1e3 * times.advise_s / count},
                    {"picture_ms", 1e3 * times.picture_s / count},
                    {"solve_s", times.solve_s}};
    fmt::print("{}\n", JsonText(json, 2));
  } else {
    fmt::print("{} frames taken of {} seen\n  model         {}\n", guidance.steps.size(),
               times.frames, guidance.camera.model);
    for (const GuideParameter& p : guidance.parameters)
      fmt::print("  {:<13} {:>12.6g} ± {:.2g} {}{}\n", p.name, p.value, p.deviation, p.unit,
                 p.is_loose ? ", not constrained" : "");
    fmt::print("  Max ERE       {:.3g} px (the frame's rotation taken out)\n", max_ere);
    if (truth)
      fmt::print("  true error    {:.3g} px at most\n", ErrorAgainst(*truth, guidance.camera));
    fmt::print("  residuals     rms {:.4f} px\n", guidance.rms_px);
    fmt::print(
        "  a frame       {:.1f} ms: detection {:.1f}, advice {:.1f}, picture {:.1f}; source {:.1f} "
        "ms\n",
        1e3 * live_s / count, 1e3 * times.detect_s / count, 1e3 * times.advise_s / count,
        1e3 * times.picture_s / count, 1e3 * times.source_s / count);
    fmt::print("  accuracy      {} px asked for: {}\n", command.accuracy_px,
               guidance.is_met ? "met" : "not met");
  }
  return outcome.is_constrained ? kDone : kIllPosed;
}

// Buttons and the end of the live thread, for the main thread.
class Requests {
 public:
  void Set(bool Requests::*which, bool to = true) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      this->*which = to;
    }
    changed_.notify_all();
  }
  bool Take(bool Requests::*which) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(this->*which, false);
  }
  /// Until something is set, or some time passed.
  void Wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(50),
                      [this] { return finish || resume || close || ended; });
  }

  bool finish = false, resume = false, close = false, ended = false;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
};

// The live thread, beside the server's and the session's: ends when asked, or at the source's end.
class LiveThread {
 public:
  LiveThread(GuideLoop* loop, Requests* requests, std::size_t most) {
    thread_ = std::thread([this, loop, requests, most] {
      try {
        for (std::size_t i = 0; !is_stopping_ && (most == 0 || i < most) && loop->Step(); ++i) {
        }
      } catch (...) {
        failure_ = std::current_exception();
      }
      requests->Set(&Requests::ended);
    });
  }
  ~LiveThread() { Join(); }

  void Join() {
    is_stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// After Join.
  void Rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::atomic<bool> is_stopping_{false};
  std::exception_ptr failure_;
  std::thread thread_;
};

std::string Told(const Guidance& guidance) {
  std::string text = fmt::format("{} frames", guidance.steps.size());
  if (!guidance.steps.empty())
    text += fmt::format(", Max ERE {:.3g} px{}", guidance.steps.back().max_ere_px,
                        guidance.is_bootstrapping ? ", not certain yet" : "");
  return guidance.message.empty() ? text : text + ": " + guidance.message;
}

// Until the page says that it is enough, or Ctrl-C.
void Serve(const CalibrateGuideCommand& command, const std::vector<CameraOutput>& outputs,
           const TargetLayout& layout, const GuideSource& source, GuideSession* session,
           LiveBoard* board, GuideLoop* loop, const Console& console) {
  Requests requests;
  GuideServerOptions options;
  options.address = command.listen;
  options.port = command.port;
  options.is_mirrored = command.is_mirrored;
  options.accuracy_px = command.accuracy_px;
  options.files = FilesOf(command, outputs);
  GuideActions actions;
  actions.capture = [&] { loop->CaptureNow(); };
  actions.remove = [&] { session->RemoveLast(); };
  actions.finish = [&] { requests.Set(&Requests::finish); };
  actions.resume = [&] { requests.Set(&Requests::resume); };
  actions.close = [&] { requests.Set(&Requests::close); };
  Interruptible interruptible;
  GuideServer server(options, *session, board, layout, source.Size(), actions);
  LiveThread live(loop, &requests, command.frames);
  console.Note("open " + server.Url() + " in a browser; Ctrl-C ends");

  bool is_done = false, was_resumed = false;
  std::size_t told = 0;  // changes of the session
  while (!Interruptible::WasAsked() && !requests.Take(&Requests::close)) {
    requests.Wait();
    const Guidance guidance = session->Now();
    const bool is_met = guidance.is_met;
    if (guidance.number != told) {
      told = guidance.number;
      console.Note(Told(guidance));
    }
    const bool is_at_end = requests.Take(&Requests::ended);
    if (requests.Take(&Requests::resume)) {
      is_done = false;
      was_resumed = true;
      loop->SetDone(false);
    }
    if (!is_met) was_resumed = false;
    const bool is_enough = requests.Take(&Requests::finish) || is_at_end || source.IsAtEnd() ||
                           (is_met && !was_resumed);
    if (is_enough && !is_done) {
      is_done = true;
      loop->SetDone(true);
      session->Settle();
      Write(command, outputs, OutcomeOf(*session));
    }
    if (is_at_end) break;
  }
  live.Join();
  live.Rethrow();
}

void RunHeadless(const CalibrateGuideCommand& command, const GuideSession& session,
                 GuideLoop* loop) {
  Interruptible interruptible;
  // A simulated person who cannot do it must not go on for ever.
  const std::size_t most = command.frames > 0         ? command.frames
                           : command.simulate.empty() ? 0
                                                      : 9000;
  std::size_t frames = 0;
  while (!Interruptible::WasAsked() && !session.Now().is_met && (most == 0 || frames++ < most) &&
         loop->Step()) {
  }
}

}  // namespace

int Run(const CalibrateGuideCommand& command, const Console& console) {
  const std::vector<CameraOutput> outputs = CameraOutputsOf(command.outputs);
  if (!command.detections.empty()) ExpectEnding(command.detections, "--detections", {".json"});
  ExpectWritable(command.detections);
  const Registry types = LoadTypes(command.reading);
  const Target target = command.target.empty() ? AprilCalMosaic() : ReadTarget(command.target);
  const TargetLayout layout = LayoutOf(target);
  const std::unique_ptr<GuideSource> source = OpenSource(command, target, !command.is_headless);
  GuideSession session(types, layout, source->Size(), SessionOptionsOf(command));
  LiveBoard board;
  GuideLoop loop(source.get(), &session, &board, target, LoopOptionsOf(command));
  const auto start = std::chrono::steady_clock::now();
  try {
    if (command.is_headless)
      RunHeadless(command, session, &loop);
    else
      Serve(command, outputs, layout, *source, &session, &board, &loop, console);
  } catch (...) {
    // A camera that was unplugged takes nothing back.
    session.Settle();
    Write(command, outputs, OutcomeOf(session));
    throw;
  }
  session.Settle();
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Outcome outcome = OutcomeOf(session);
  Write(command, outputs, outcome);
  return Conclude(command, outcome, loop.Times(), wall_s, source->Truth());
}

}  // namespace graticule::apps
