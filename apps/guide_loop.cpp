#include "guide_loop.hpp"

#include <chrono>

#include "graticule/io/photo.hpp"

namespace graticule::apps {
namespace {

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Adds the time until the next lap.
class Laps {
 public:
  void Lap(double* sum) {
    const double now = Seconds();
    *sum += now - last_;
    last_ = now;
  }

 private:
  double last_ = Seconds();
};

DetectOptions Decimated(double by) {
  DetectOptions options;
  options.decimate = by;
  return options;
}

}  // namespace

void LiveBoard::Put(LiveView view, std::string jpeg) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    view_ = std::move(view);
    if (!jpeg.empty()) jpeg_ = std::move(jpeg);
  }
  changed_.notify_all();
}

LiveView LiveBoard::WaitFor(std::size_t after) {
  last_asked_s_ = Seconds();
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, std::chrono::seconds(1),
                    [&] { return is_closed_ || view_.number > after; });
  return view_;
}

std::string LiveBoard::Picture() {
  last_asked_s_ = Seconds();
  const std::lock_guard<std::mutex> lock(mutex_);
  return jpeg_;
}

bool LiveBoard::IsWatched() const {
  constexpr double kLately = 2;
  return Seconds() - last_asked_s_ < kLately;
}

void LiveBoard::Close() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_all();
}

GuideLoop::GuideLoop(GuideSource* source, GuideSession* session, LiveBoard* board,
                     const Target& target, const LoopOptions& options)
    : source_(*source),
      session_(*session),
      board_(*board),
      layout_(LayoutOf(target)),
      options_(options),
      detector_(target, Decimated(options.decimate)),
      capture_(source->Size().width, options.capture),
      guidance_(session->Now()) {}

bool GuideLoop::Step() {
  Laps laps;
  std::optional<SourceFrame> frame = source_.Next(guidance_, board_.IsWatched());
  laps.Lap(&times_.source_s);
  if (!frame) return false;
  ++times_.frames;
  const bool is_done = is_done_;

  LiveView view;
  view.number = ++number_;
  view.seconds = frame->seconds;
  LiveFrame live{view.number, frame->seconds, {}, 0};
  if (!is_done)
    live.corners = frame->corners ? std::move(*frame->corners) : detector_.Detect(frame->image);
  laps.Lap(&times_.detect_s);

  if (!matcher_ || session_.IsNewer(guidance_.number, guidance_.is_busy)) {
    const std::size_t before = guidance_.number;
    guidance_ = session_.Now();
    if (guidance_.suggestion && (!matcher_ || guidance_.number != before)) {
      matcher_.emplace(Camera(guidance_.camera), layout_, *guidance_.suggestion);
      capture_.Begin(frame->seconds);
    }
  }
  view.guidance = guidance_.number;
  view.is_busy = guidance_.is_busy;
  view.is_done = is_done;
  std::optional<LiveFrame> taken;
  if (!is_done && matcher_) {
    view.match = matcher_->Compare(live.corners);
    // While a change is solved, what is shown is no longer asked for.
    if (!guidance_.is_busy) {
      if (view.match.distance_cells <= options_.capture.most_cells && !frame->image.shades.empty())
        live.sharpness = SharpnessOf(frame->image, live.corners);
      taken = capture_.Offer(live, view.match);
      view.capture = capture_.State();
    }
  }
  if (!is_done && !live.corners.empty() && (frame->is_chosen || capture_now_.exchange(false)))
    taken = live;
  view.corners = std::move(live.corners);
  laps.Lap(&times_.advise_s);

  const double now = Seconds(), passed = now - last_s_;
  constexpr double kFollow = 0.1;  // of the mean
  if (last_s_ > 0 && passed > 0)
    mean_s_ = mean_s_ > 0 ? mean_s_ + kFollow * (passed - mean_s_) : passed;
  last_s_ = now;
  view.frames_per_second = mean_s_ > 0 ? 1 / mean_s_ : 0;
  Show(*frame, std::move(view));
  laps.Lap(&times_.picture_s);

  if (taken) Take(*taken);
  laps.Lap(&times_.solve_s);
  return true;
}

void GuideLoop::Take(const LiveFrame& frame) {
  session_.Add(frame.corners);
  guidance_.is_busy = true;
  if (!options_.is_synchronous) return;
  session_.Settle();
}

void GuideLoop::Show(const SourceFrame& frame, LiveView view) {
  if (!board_.IsWatched() || frame.image.shades.empty()) {
    board_.Put(std::move(view), "");
    return;
  }
  std::optional<GreyImage> rectified;
  if (view.is_done) rectified = session_.Rectified(frame.image);
  view.is_rectified = rectified.has_value();
  constexpr int kQuality = 80;
  std::string jpeg = FormatJpeg(rectified ? *rectified : frame.image, kQuality);
  board_.Put(std::move(view), std::move(jpeg));
}

}  // namespace graticule::apps
