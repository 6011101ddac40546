#include "graticule/problems/calibration/placement.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

Eigen::AlignedBox3d BoxOf(const TargetLayout& target) {
  Eigen::AlignedBox3d box;
  for (const TargetCorner& corner : target.corners)
    box.extend(Eigen::Vector3d(corner.in_target.data()));
  return box;
}

// Pixels a radian around a ray: the square root of the area that a solid angle has.
double PixelsPerRadian(const Camera& camera, const Eigen::Vector3d& ray) {
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  if (!camera.Project(ray, by_point.data(), nullptr)) return 0;
  Eigen::Matrix<double, 3, 2> tangent;
  tangent.col(0) = ray.unitOrthogonal();
  tangent.col(1) = ray.cross(tangent.col(0));
  return std::sqrt(std::abs((by_point * tangent).determinant()));
}

double ShortestEdge(const DetectedCorner* corners, std::size_t count) {
  double shortest = HUGE_VAL;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& a = corners[i].pixel;
    const auto& b = corners[(i + 1) % count].pixel;
    shortest = std::min(shortest, std::hypot(b[0] - a[0], b[1] - a[1]));
  }
  return shortest;
}

}  // namespace

Eigen::Vector3d TargetLayout::Centre() const { return BoxOf(*this).center(); }
double TargetLayout::Width() const { return BoxOf(*this).sizes().maxCoeff(); }

TargetLayout LayoutOf(const Target& target) {
  TargetLayout layout;
  layout.corners = CornersOf(target);
  const bool has_tags =
      target.kind == TargetKind::kTagMosaic || target.kind == TargetKind::kAprilGrid;
  layout.corners_per_tag = has_tags ? 4 : 1;
  layout.printed_towards_z = HasYUp(target);
  return layout;
}

std::optional<Se3Array> PlaceTarget(const Camera& camera, const TargetLayout& target,
                                    const Placement& placement) {
  const Eigen::Vector2d pixel(placement.across * camera.Width() - 0.5,
                              placement.down * camera.Height() - 0.5);
  const auto ray = camera.Unproject(pixel);
  if (!ray) return std::nullopt;
  const double density = PixelsPerRadian(camera, *ray);
  if (!(density > 0)) return std::nullopt;
  // A board nearer than an eighth of its width leaves no room for the hand that holds it.
  const double half_angle =
      std::min(placement.size * camera.Width() / density / 2, std::atan2(4., 1.));
  const double distance = target.Width() / 2 / std::tan(half_angle);

  // Facing the camera: its normal along the ray, its rows level.
  Eigen::Matrix3d facing;
  const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(*ray);
  facing.col(0) = right.norm() > 1e-6 ? right.normalized() : Eigen::Vector3d::UnitX();
  facing.col(1) = ray->cross(facing.col(0));
  facing.col(2) = *ray;
  Eigen::Isometry3d camera_from_target = Eigen::Isometry3d::Identity();
  camera_from_target.linear() =
      Eigen::AngleAxisd(placement.roll, *ray).toRotationMatrix() * facing *
      (Eigen::AngleAxisd(placement.tilt_sideways, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(placement.tilt_up, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  if (target.printed_towards_z)
    camera_from_target.linear() *= Eigen::Vector3d(1, -1, -1).asDiagonal();
  camera_from_target.translation() =
      distance * *ray - camera_from_target.linear() * target.Centre();
  return PoseOf(camera_from_target);
}

std::vector<DetectedCorner> VisibleCorners(const Camera& camera, const TargetLayout& target,
                                           const Se3Array& camera_from_target,
                                           const std::array<double, 3>& warp,
                                           const Detectability& detectability) {
  const Eigen::Isometry3d pose = IsometryOf(camera_from_target);
  const Eigen::Vector3d normal = pose.linear().col(2) * (target.printed_towards_z ? 1 : -1);
  std::vector<DetectedCorner> seen;
  seen.reserve(target.corners.size());
  const double margin = detectability.margin_px - 0.5;
  for (std::size_t first = 0; first + target.corners_per_tag <= target.corners.size();
       first += target.corners_per_tag) {
    const std::size_t before = seen.size();
    for (std::size_t i = first; i < first + target.corners_per_tag; ++i) {
      const TargetCorner& corner = target.corners[i];
      Eigen::Vector3d place(corner.in_target.data());
      const double x = place.x(), y = place.y();
      place.z() += warp[0] * x * x + warp[1] * y * y + warp[2] * x * y;
      const Eigen::Vector3d in_camera = pose * place;
      if (!(normal.dot(in_camera) < 0)) break;
      const auto pixel = camera.Project(in_camera);
      if (!pixel || !(pixel->x() >= margin && pixel->x() <= camera.Width() - 1 - margin &&
                      pixel->y() >= margin && pixel->y() <= camera.Height() - 1 - margin))
        break;
      seen.push_back({corner.id, corner.in_target, {pixel->x(), pixel->y()}});
    }
    bool whole = seen.size() - before == target.corners_per_tag;
    if (whole && target.corners_per_tag > 2)
      whole = ShortestEdge(&seen[before], target.corners_per_tag) >= detectability.min_edge_px;
    if (!whole) seen.resize(before);
  }
  return seen;
}

}  // namespace graticule
