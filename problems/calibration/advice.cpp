#include "graticule/problems/calibration/advice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "graticule/problems/calibration/camera.hpp"

namespace graticule {
namespace {

constexpr std::size_t kFewestViews = 3;
constexpr double kTilted = 15 * M_PI / 180;
constexpr const char* kPlaces[9] = {
    "the upper left corner", "the upper edge", "the upper right corner",
    "the left edge",         "the middle",     "the right edge",
    "the lower left corner", "the lower edge", "the lower right corner"};

// The ninths of the image that rays reach but no corner was seen in.
std::vector<std::string> EmptyPlaces(const Detections& detections, const Camera& model,
                                     std::size_t camera) {
  std::array<bool, 9> seen{};
  for (const TargetView& view : detections.views) {
    if (view.camera != camera) continue;
    for (const DetectedCorner& corner : view.corners) {
      const int column = static_cast<int>(std::floor(3 * (corner.pixel[0] + 0.5) / model.Width()));
      const int row = static_cast<int>(std::floor(3 * (corner.pixel[1] + 0.5) / model.Height()));
      seen[static_cast<std::size_t>(3 * std::clamp(row, 0, 2) + std::clamp(column, 0, 2))] = true;
    }
  }
  std::vector<std::string> empty;
  for (std::size_t i = 0; i < 9; ++i) {
    if (seen[i]) continue;
    const Eigen::Vector2d middle((static_cast<double>(i % 3) + 0.5) * model.Width() / 3 - 0.5,
                                 (static_cast<double>(i / 3) + 0.5) * model.Height() / 3 - 0.5);
    if (model.Unproject(middle)) empty.emplace_back(kPlaces[i]);
  }
  return empty;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace

std::vector<std::string> AdviseViews(const Detections& detections, const CalibrationState& state,
                                     std::size_t camera, const Posterior* posterior) {
  std::size_t views = 0;
  double steepest = 0;
  for (const TargetView& view : detections.views) {
    const auto& pose = state.rig_from_target[view.exposure];
    if (view.camera != camera || view.corners.empty() || !pose) continue;
    ++views;
    // Against the optical axis: what tells the focal length is a depth that varies in the view.
    const Eigen::Matrix3d turn =
        IsometryOf(state.camera_from_rig[camera]).linear() * IsometryOf(*pose).linear();
    steepest = std::max(steepest, std::acos(std::min(1.0, std::fabs(turn(2, 2)))));
  }
  std::vector<std::string> advice;
  if (views < kFewestViews)
    advice.push_back(std::string("Take ") + (views == 0 ? "" : "more ") +
                     "pictures of the target: there " + (views == 1 ? "is " : "are ") +
                     std::to_string(views) + " that can be used.");
  if (views > 0 && steepest < kTilted)
    advice.emplace_back(
        "Tilt the target by 30 to 45 degrees, sideways and upward: no view is tilted by more "
        "than " +
        std::to_string(static_cast<int>(std::ceil(steepest * 180 / M_PI))) +
        " degrees, which does not tell the focal length from the distance.");
  const Camera model(state.cameras[camera]);
  const std::vector<std::string> empty = EmptyPlaces(detections, model, camera);
  if (!empty.empty())
    advice.push_back("Show the target at " + Listed(empty) +
                     " of the image: no corner was seen there.");
  if (advice.empty() && posterior && !posterior->Constrained())
    advice.emplace_back(
        "Show the target nearer, tilted and turned by a quarter, out to the image's corners.");
  return advice;
}

}  // namespace graticule
