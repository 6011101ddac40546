// What of picture_data.hpp follows from a camera's model: coverage, distortion, cross sections.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "graticule/io/plot_style.hpp"
#include "graticule/problems/calibration/picture_data.hpp"

namespace graticule {
namespace {

constexpr double kDegrees = 180 / M_PI;

Eigen::Vector2d CentreOf(const Camera& camera) {
  const std::vector<double>& p = camera.Intrinsics().parameters;
  return {p[2], p[3]};
}

Eigen::Vector2d FarthestCorner(const Camera& camera) {
  Eigen::Vector2d farthest = CentreOf(camera);
  double most = -1;
  for (const double x : {0.0, camera.Width() - 1.0})
    for (const double y : {0.0, camera.Height() - 1.0})
      if (const double far = (Eigen::Vector2d(x, y) - CentreOf(camera)).norm(); far > most) {
        most = far;
        farthest = {x, y};
      }
  return farthest;
}

Eigen::Vector3d RayAt(double angle, double turn) {
  return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
}

// The widest angle that has its image inside of the camera's.
double WidestInside(const Camera& camera) {
  double widest = 0;
  for (const double x : {0.0, 0.5, 1.0})
    for (const double y : {0.0, 0.5, 1.0})
      if (const auto ray = camera.Unproject({x * (camera.Width() - 1), y * (camera.Height() - 1)}))
        widest = std::max(widest, std::acos(std::clamp(ray->z(), -1.0, 1.0)));
      else
        return camera.MaxAngle();
  return widest;
}

// Andrew's monotone chain.
ImageLine HullOf(std::vector<ImagePoint> points) {
  std::sort(points.begin(), points.end(), [](const ImagePoint& a, const ImagePoint& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  if (points.size() < 3) return points;
  ImageLine hull;
  const auto chain = [&](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= base + 2) {
        const ImagePoint &a = hull[hull.size() - 2], &b = hull.back();
        if ((b.x - a.x) * (p->y - a.y) - (b.y - a.y) * (p->x - a.x) > 0) break;
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  return hull;
}

}  // namespace

CoveragePicture DescribeCoverage(const Detections& detections, std::size_t camera,
                                 const Camera& model) {
  CoveragePicture picture;
  picture.width = model.Width();
  picture.height = model.Height();
  picture.centre = {CentreOf(model).x(), CentreOf(model).y()};
  for (const TargetView& view : detections.views) {
    if (view.camera != camera || view.corners.empty()) continue;
    ImageLine seen;
    for (const DetectedCorner& corner : view.corners)
      seen.push_back({corner.pixel[0], corner.pixel[1]});
    picture.corners.insert(picture.corners.end(), seen.begin(), seen.end());
    picture.outlines.push_back(HullOf(std::move(seen)));
  }
  const double widest = WidestInside(model);
  const double step = widest * kDegrees < 25 ? 5 : 10;
  for (double angle = step; angle < widest * kDegrees; angle += step) {
    CoveragePicture::Ring ring;
    ring.angle_deg = angle;
    ImageLine line;
    bool inside = false;
    for (int i = 0; i <= 180; ++i) {
      const auto pixel = model.Project(RayAt(angle / kDegrees, 2 * M_PI * i / 180));
      line.push_back(pixel ? ImagePoint{pixel->x(), pixel->y()} : ImagePoint{kNotKnown, kNotKnown});
      inside = inside || (pixel && pixel->x() >= 0 && pixel->y() >= 0 &&
                          pixel->x() < model.Width() && pixel->y() < model.Height());
    }
    ring.lines.push_back(std::move(line));
    if (inside) picture.rings.push_back(std::move(ring));
  }
  return picture;
}

DistortionCurve DescribeDistortion(const Camera& camera, const Eigen::MatrixXd& covariance) {
  DistortionCurve curve;
  curve.model = camera.Intrinsics().model;
  const double widest = std::min(WidestInside(camera), camera.MaxAngle());
  const int parameters = camera.Model().parameters;
  constexpr int kSteps = 90, kTurns = 8;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> by_parameters(2, parameters);
  double most_radius = 0, most_deviation = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = widest * i / kSteps;
    DistortionCurve::Point point;
    point.angle_deg = kDegrees * angle;
    // The mean over directions: what is not radial cancels.  Linear in the pixels, so that its
    // derivative is theirs; the centre moves with the image.
    Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(parameters);
    bool seen = true;
    for (int k = 0; k < kTurns && seen; ++k) {
      const double turn = 2 * M_PI * k / kTurns;
      const Eigen::RowVector2d outward(std::cos(turn), std::sin(turn));
      Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
      const auto pixel = camera.Project(RayAt(angle, turn), by_point.data(), by_parameters.data());
      seen = pixel.has_value();
      if (!seen) break;
      by_parameters.middleCols<2>(2) -= Eigen::Matrix2d::Identity();
      point.radius_px += outward.dot((*pixel - CentreOf(camera)).transpose()) / kTurns;
      slope += outward * by_parameters / kTurns;
    }
    if (!seen) break;
    if (covariance.rows() == parameters)
      point.deviation_px = std::sqrt(std::max(0.0, (slope * covariance).dot(slope)));
    most_radius = std::max(most_radius, point.radius_px);
    most_deviation = std::max(most_deviation, point.deviation_px);
    curve.points.push_back(point);
  }
  // The slope at the axis, since the focal length of some models is another thing.
  if (curve.points.size() > 1 && curve.points[1].angle_deg > 0)
    curve.focal_px = curve.points[1].radius_px / (curve.points[1].angle_deg / kDegrees);
  curve.exaggeration =
      most_deviation > 0 ? std::max(1.0, plot::RoundDown(0.04 * most_radius / most_deviation)) : 0;
  return curve;
}

CrossSection DescribeSection(const Camera& camera, const Eigen::MatrixXd& covariance,
                             const EreOptions& options) {
  CrossSection section;
  const Eigen::Vector2d from = CentreOf(camera), to = FarthestCorner(camera);
  constexpr int kSteps = 120;
  EreOptions raw = options;
  raw.gauge = EreGauge::kRaw;
  std::vector<EreOptions> kinds = {options};
  if (options.gauge != EreGauge::kRaw) kinds.push_back(raw);
  for (const EreOptions& kind : kinds) {
    Curve curve;
    curve.name = kind.gauge == EreGauge::kRaw                   ? "expected, raw"
                 : kind.gauge == EreGauge::kRotationCompensated ? "expected, rotation taken out"
                                                                : "expected, motion taken out";
    for (int i = 0; i <= kSteps; ++i) {
      const Eigen::Vector2d pixel = from + (to - from) * i / kSteps;
      if (const auto error = EreAt(camera, covariance, pixel, kind))
        curve.points.push_back({(pixel - from).norm(), *error});
    }
    section.curves.push_back(std::move(curve));
  }
  return section;
}

double SeenAlongSection(const Detections& detections, std::size_t camera, const Camera& model) {
  const Eigen::Vector2d centre = CentreOf(model);
  const Eigen::Vector2d along = (FarthestCorner(model) - centre).normalized();
  double farthest = 0;
  for (const TargetView& view : detections.views) {
    if (view.camera != camera) continue;
    for (const DetectedCorner& corner : view.corners) {
      const Eigen::Vector2d at = Eigen::Vector2d(corner.pixel[0], corner.pixel[1]) - centre;
      // Within 15 degrees of the section.
      if (at.dot(along) > 0.966 * at.norm()) farthest = std::max(farthest, at.norm());
    }
  }
  return farthest;
}

Curve SectionOf(const CalibrationDifference& difference, const Camera& first,
                const std::string& name) {
  const ImageField& field = difference.field;
  const Eigen::Vector2d from = CentreOf(first), to = FarthestCorner(first);
  Curve curve{name, {}};
  constexpr int kSteps = 120;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::Vector2d pixel = from + (to - from) * i / kSteps;
    // Bilinear between the nodes.
    const double x = pixel.x() / (field.width - 1) * static_cast<double>(field.columns - 1);
    const double y = pixel.y() / (field.height - 1) * static_cast<double>(field.rows - 1);
    if (!(x >= 0 && y >= 0 && x <= static_cast<double>(field.columns - 1) &&
          y <= static_cast<double>(field.rows - 1)))
      continue;
    const std::size_t c = std::min(static_cast<std::size_t>(x), field.columns - 2);
    const std::size_t r = std::min(static_cast<std::size_t>(y), field.rows - 2);
    const double u = x - static_cast<double>(c), v = y - static_cast<double>(r);
    const double value = (1 - v) * ((1 - u) * field.Value(c, r) + u * field.Value(c + 1, r)) +
                         v * ((1 - u) * field.Value(c, r + 1) + u * field.Value(c + 1, r + 1));
    if (std::isfinite(value)) curve.points.push_back({(pixel - from).norm(), value});
  }
  return curve;
}

}  // namespace graticule
