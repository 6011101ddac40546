#include "graticule/problems/calibration/live_capture.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace graticule {

double SharpnessOf(const GreyImage& image, const std::vector<DetectedCorner>& corners) {
  if (corners.empty() || image.width < 2 || image.height < 1) return 0;
  double left = HUGE_VAL, top = HUGE_VAL, right = 0, bottom = 0;
  for (const DetectedCorner& corner : corners) {
    left = std::min(left, corner.pixel[0]);
    right = std::max(right, corner.pixel[0]);
    top = std::min(top, corner.pixel[1]);
    bottom = std::max(bottom, corner.pixel[1]);
  }
  const auto within = [](double value, std::size_t most) {
    return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  const std::size_t x0 = within(left, image.width - 2), x1 = within(right, image.width - 2);
  const std::size_t y0 = within(top, image.height - 1), y1 = within(bottom, image.height - 1);
  double sum = 0;
  for (std::size_t y = y0; y <= y1; ++y) {
    const std::uint8_t* row = &image.shades[y * image.width];
    std::int64_t of_row = 0;
    for (std::size_t x = x0; x <= x1; ++x) {
      const int step = row[x + 1] - row[x];
      of_row += step * step;
    }
    sum += static_cast<double>(of_row);
  }
  return std::sqrt(sum / static_cast<double>((x1 - x0 + 1) * (y1 - y0 + 1)));
}

double MotionBetween(const LiveFrame& a, const LiveFrame& b) {
  std::map<int, std::array<double, 2>> before;
  for (const DetectedCorner& corner : a.corners) before[corner.id] = corner.pixel;
  double sum = 0;
  std::size_t count = 0;
  for (const DetectedCorner& corner : b.corners) {
    const auto was = before.find(corner.id);
    if (was == before.end()) continue;
    sum += std::hypot(corner.pixel[0] - was->second[0], corner.pixel[1] - was->second[1]);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : HUGE_VAL;
}

LiveCapture::LiveCapture(int image_width, const CaptureOptions& options)
    : options_(options), steady_px_(options.steady_thousandths * image_width / 1000) {}

void LiveCapture::Begin(double seconds) {
  begun_s_ = seconds;
  window_.clear();
  state_ = {};
}

std::optional<LiveFrame> LiveCapture::Offer(const LiveFrame& frame, const Match& match) {
  const double motion = previous_ ? MotionBetween(*previous_, frame) : HUGE_VAL;
  previous_ = frame;
  const double waited = std::max(0.0, frame.seconds - begun_s_);
  state_.limit_cells =
      std::min(options_.most_cells, options_.reached_cells + waited / options_.patience_s);
  state_.is_matched = match.distance_cells <= state_.limit_cells;
  state_.is_steady = motion <= steady_px_;
  if (!state_.is_matched || !state_.is_steady) return Decide();
  window_.push_back({frame, motion});
  const double lasted = frame.seconds - window_.front().frame.seconds;
  state_.progress = std::clamp(lasted / options_.window_s, 0.0, 1.0);
  if (lasted < options_.window_s) return std::nullopt;
  return Decide();
}

std::optional<LiveFrame> LiveCapture::Decide() {
  std::vector<Candidate> window = std::move(window_);
  window_.clear();
  state_.progress = 0;
  if (window.size() < options_.fewest) return std::nullopt;
  double least = HUGE_VAL;
  for (const Candidate& candidate : window) least = std::min(least, candidate.motion_px);
  // A tenth of a pixel more is detection noise, not motion.
  constexpr double kAlikePx = 0.1;
  const Candidate* best = nullptr;
  for (const Candidate& candidate : window)
    if (candidate.motion_px <= least + kAlikePx &&
        (!best || candidate.frame.sharpness > best->frame.sharpness))
      best = &candidate;
  return best->frame;
}

}  // namespace graticule
