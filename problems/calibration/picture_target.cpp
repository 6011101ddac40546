// What of picture_data.hpp follows from the target: its shape, its rows undistorted, its quads.

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "graticule/io/readable.hpp"
#include "graticule/problems/calibration/picture_data.hpp"
#include "graticule/problems/calibration/undistort.hpp"

namespace graticule {
namespace {

// The least distance between corners of a view on the target.
double SpacingOf(const std::vector<DetectedCorner>& corners) {
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(least, std::hypot(corners[i].in_target[0] - corners[j].in_target[0],
                                         corners[i].in_target[1] - corners[j].in_target[1]));
  return least;
}

// Corners of a view that lie on a line of the target, along x or y, in order; three or more.
std::vector<ImageLine> RowsOf(const TargetView& view) {
  const double spacing = SpacingOf(view.corners);
  std::vector<ImageLine> lines;
  if (!(spacing > 0) || !std::isfinite(spacing)) return lines;
  for (const int along : {0, 1}) {
    std::map<long long, std::map<double, ImagePoint>> rows;
    for (const DetectedCorner& corner : view.corners)
      rows[std::llround(corner.in_target[1 - along] / (0.25 * spacing))][corner.in_target[along]] =
          {corner.pixel[0], corner.pixel[1]};
    for (const auto& [row, corners] : rows) {
      ImageLine line;
      for (const auto& [place, pixel] : corners) line.push_back(pixel);
      if (line.size() >= 3) lines.push_back(std::move(line));
    }
  }
  return lines;
}

// Squared distances of points from the straight line nearest to them (total least squares).
struct Straightness {
  double squares = 0;
  std::size_t count = 0;

  void Add(const ImageLine& line) {
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const ImagePoint& point : line) middle += Eigen::Vector2d(point.x, point.y);
    middle /= static_cast<double>(line.size());
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const ImagePoint& point : line) {
      const Eigen::Vector2d d = Eigen::Vector2d(point.x, point.y) - middle;
      spread += d * d.transpose();
    }
    squares += Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()[0];
    count += line.size();
  }
  double Rms() const {
    return count == 0 ? 0 : std::sqrt(std::max(0.0, squares) / static_cast<double>(count));
  }
};

ImagePoint Rectified(const Camera& from, const CameraIntrinsics& to, const ImagePoint& pixel,
                     double widest) {
  const auto ray = from.Unproject({pixel.x, pixel.y});
  if (!ray || !(ray->z() > std::cos(widest))) return {kNotKnown, kNotKnown};
  return {to.parameters[0] * ray->x() / ray->z() + to.parameters[2],
          to.parameters[1] * ray->y() / ray->z() + to.parameters[3]};
}

// The views whose rows are shown: the image's, or those with corners farthest from the centre.
std::vector<const TargetView*> Shown(const Detections& detections, std::size_t camera,
                                     const Camera& model, const std::string& image_name) {
  constexpr std::size_t kMost = 2;
  std::vector<std::pair<double, const TargetView*>> views;
  for (const TargetView& view : detections.views) {
    if (view.camera != camera) continue;
    if (!image_name.empty() && view.image == image_name) return {&view};
    double far = 0;
    for (const DetectedCorner& corner : view.corners)
      far += std::hypot(corner.pixel[0] - model.Intrinsics().parameters[2],
                        corner.pixel[1] - model.Intrinsics().parameters[3]);
    if (!view.corners.empty())
      views.emplace_back(far / static_cast<double>(view.corners.size()), &view);
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<const TargetView*> shown;
  for (std::size_t i = 0; i < std::min(views.size(), kMost); ++i) shown.push_back(views[i].second);
  return shown;
}

// Straight lines of the view, and how the camera sees them.
void AddGrid(const Camera& camera, const CameraIntrinsics& view, UndistortionPicture* picture) {
  const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    ImageLine before, after;
    for (int i = 0; i <= 60; ++i) {
      const Eigen::Vector2d at = a + (b - a) * i / 60;
      const Eigen::Vector3d ray((at.x() - view.parameters[2]) / view.parameters[0],
                                (at.y() - view.parameters[3]) / view.parameters[1], 1);
      const auto pixel = camera.Project(ray);
      before.push_back(pixel ? ImagePoint{pixel->x(), pixel->y()}
                             : ImagePoint{kNotKnown, kNotKnown});
      after.push_back({at.x(), at.y()});
    }
    picture->before.grid.push_back(std::move(before));
    picture->after.grid.push_back(std::move(after));
  };
  const double right = view.width - 1, bottom = view.height - 1;
  const double step = right / 16;
  for (double x = 0; x <= right + 0.5; x += step) add({x, 0}, {x, bottom});
  const int rows = std::max(1, static_cast<int>(std::lround(bottom / step)));
  for (int i = 0; i <= rows; ++i) add({0, bottom * i / rows}, {right, bottom * i / rows});
}

}  // namespace

std::optional<std::size_t> FarthestView(const Detections& detections, std::size_t camera,
                                        const Camera& model) {
  const std::vector<const TargetView*> shown = Shown(detections, camera, model, "");
  if (shown.empty()) return std::nullopt;
  return static_cast<std::size_t>(shown.front() - detections.views.data());
}

UndistortionPicture DescribeUndistortion(const Detections& detections, std::size_t camera,
                                         const Camera& model,
                                         const std::optional<ShownImage>& image) {
  RectifyOptions options;
  options.keep = RectifyKeep::kAll;
  // Large images are not shown at their size.
  const double shrink = std::min(1.0, 1100.0 / model.Width());
  options.width = std::max(2, static_cast<int>(model.Width() * shrink));
  options.height = std::max(2, static_cast<int>(model.Height() * shrink));
  const CameraIntrinsics view = RectifiedView(model, options);
  UndistortionPicture picture;
  picture.before = {"as the camera sees it", model.Width(), model.Height(), {}, {}, {}};
  picture.after = {"as a pinhole camera would", view.width, view.height, {}, {}, {}};
  if (image) {
    picture.before.image = image->image;
    picture.after.image = Rectifier(model, Camera(view)).Image(image->image);
  } else {
    AddGrid(model, view, &picture);
  }
  // Unprojecting all corners of hundreds of views would take seconds.
  const std::size_t every = detections.views.size() / 40 + 1;
  std::size_t number = 0;
  Straightness before, after;
  const std::vector<const TargetView*> shown =
      Shown(detections, camera, model, image ? image->view : "");
  for (const TargetView& view_of : detections.views) {
    if (view_of.camera != camera) continue;
    const bool is_shown = std::find(shown.begin(), shown.end(), &view_of) != shown.end() &&
                          (!image || view_of.image == image->view);
    if (number++ % every != 0 && !is_shown) continue;
    for (const ImageLine& row : RowsOf(view_of)) {
      ImageLine straight;
      bool whole = true;
      for (const ImagePoint& pixel : row) {
        straight.push_back(Rectified(model, view, pixel, options.widest_rad));
        whole = whole && std::isfinite(straight.back().x);
      }
      if (whole) {
        before.Add(row);
        after.Add(straight);
      }
      if (!is_shown) continue;
      picture.before.marks.push_back(row);
      picture.after.marks.push_back(std::move(straight));
    }
  }
  picture.note = "focal length " + ReadableNumber(view.parameters[0] / shrink, 4) +
                 " px, to keep all pixels to " +
                 ReadableNumber(options.widest_rad * 180 / M_PI, 2) + "° from the axis";
  // In the camera's pixels on both sides.
  if (after.count > 0)
    picture.note += "; rows of corners are " + ReadableNumber(before.Rms(), 3) +
                    " px from straight lines before, " + ReadableNumber(after.Rms() / shrink, 3) +
                    " px after";
  return picture;
}

std::optional<BoardPicture> DescribeBoard(const Detections& detections,
                                          const CalibrationState& state) {
  if (state.corners.empty() && state.warp == std::array<double, 3>{}) return std::nullopt;
  std::map<int, DetectedCorner> described;
  for (const TargetView& view : detections.views)
    for (const DetectedCorner& corner : view.corners) described.emplace(corner.id, corner);
  if (described.size() < 3) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(described.size());
  Eigen::Matrix3Xd from(3, count), to(3, count);
  Eigen::Index i = 0;
  const double height = described.begin()->second.in_target[2];
  for (const auto& [id, corner] : described) {
    if (std::fabs(corner.in_target[2] - height) > 1e-9) return std::nullopt;
    from.col(i) = Eigen::Vector3d(corner.in_target.data());
    to.col(i++) = PlaceOf(state, corner);
  }
  const Eigen::Matrix4d described_from_found = Eigen::umeyama(to, from, false);
  BoardPicture picture;
  for (i = 0; i < count; ++i) {
    const Eigen::Vector3d found = (described_from_found * to.col(i).homogeneous()).head<3>();
    const Eigen::Vector3d moved = found - from.col(i);
    picture.corners.push_back({from(0, i), from(1, i), moved.x(), moved.y(), moved.z()});
  }
  return picture;
}

std::vector<ImageLine> QuadsOf(const TargetLayout& target,
                               const std::vector<DetectedCorner>& corners,
                               std::vector<int>* names) {
  std::map<int, ImagePoint> seen;
  for (const DetectedCorner& corner : corners) seen[corner.id] = {corner.pixel[0], corner.pixel[1]};
  std::vector<ImageLine> quads;
  const auto add = [&](std::initializer_list<int> ids, int name) {
    ImageLine quad;
    for (const int id : ids)
      if (const auto at = seen.find(id); at != seen.end()) quad.push_back(at->second);
    if (quad.size() != ids.size()) return;
    quads.push_back(std::move(quad));
    if (names) names->push_back(name);
  };
  if (names) names->clear();
  if (target.corners_per_tag == 4) {
    for (std::size_t tag = 0; tag < target.Tags(); ++tag) {
      const TargetCorner* corner = &target.corners[4 * tag];
      add({corner[0].id, corner[1].id, corner[2].id, corner[3].id}, static_cast<int>(tag));
    }
    return quads;
  }
  // Single corners: every other square between four of them.
  std::vector<DetectedCorner> all;
  for (const TargetCorner& corner : target.corners)
    all.push_back({corner.id, corner.in_target, {}});
  const double spacing = SpacingOf(all);
  if (!(spacing > 0) || !std::isfinite(spacing)) return quads;
  std::map<std::pair<long long, long long>, int> grid;
  for (const TargetCorner& corner : target.corners)
    grid[{std::llround(corner.in_target[0] / spacing),
          std::llround(corner.in_target[1] / spacing)}] = corner.id;
  int name = 0;
  for (const auto& [place, id] : grid) {
    const auto [x, y] = place;
    if ((x + y) % 2 != 0) continue;
    const auto right = grid.find({x + 1, y}), below = grid.find({x, y + 1}),
               across = grid.find({x + 1, y + 1});
    if (right == grid.end() || below == grid.end() || across == grid.end()) continue;
    add({id, right->second, across->second, below->second}, name++);
  }
  return quads;
}

}  // namespace graticule
