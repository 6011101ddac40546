#include "graticule/problems/calibration/picture_data.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kDegrees = 180 / M_PI;

// "fx:px k1": names with their units.
void AddParameters(const Camera& camera, const Posterior* posterior, std::size_t index,
                   CameraReport* report) {
  std::istringstream fields(camera.Model().fields);
  std::vector<double> deviations;
  if (posterior) deviations = posterior->Deviations("camera:" + std::to_string(index));
  std::size_t i = 0;
  for (std::string field; fields >> field; ++i) {
    ReportedNumber number;
    const std::size_t colon = field.find(':');
    number.name = field.substr(0, colon);
    if (colon != std::string::npos) number.unit = field.substr(colon + 1);
    number.value = camera.Intrinsics().parameters[i];
    if (i < deviations.size()) number.deviation = deviations[i];
    report->numbers.push_back(number);
  }
}

void AddPlaceOnRig(const Calibration& calibration, const Posterior* posterior, std::size_t index,
                   CameraReport* report) {
  if (index == 0) return;
  const Eigen::Isometry3d pose = IsometryOf(calibration.state.camera_from_rig[index]);
  const Eigen::AngleAxisd turn(pose.linear());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  std::vector<double> deviations(6, kNotKnown);
  if (posterior) deviations = posterior->Deviations("camera_from_rig:" + std::to_string(index));
  const char* names[] = {"x", "y", "z", "rx", "ry", "rz"};
  for (int i = 0; i < 6; ++i)
    report->numbers.push_back({std::string("camera_from_rig ") + names[i], i < 3 ? "m" : "rad",
                               i < 3 ? pose.translation()[i] : rotation[i - 3],
                               deviations[static_cast<std::size_t>(i)], true});
}

void MarkUnconstrained(const Posterior& posterior, std::size_t index, CameraReport* report) {
  std::vector<std::string> of = {"camera:" + std::to_string(index)};
  if (!report->camera.name.empty()) of.push_back(report->camera.name);
  for (const std::string& name : posterior.unconstrained)
    for (ReportedNumber& number : report->numbers)
      for (const std::string& camera : of)
        if (name == number.name + " of " + camera) number.constrained = false;
}

// Distance and tilt of what a view saw of its target.
void AddPlace(const CalibrationState& state, const TargetView& view, ReportedView* reported) {
  const auto& rig_from_target = state.rig_from_target[view.exposure];
  if (!rig_from_target || view.corners.empty()) return;
  const Eigen::Isometry3d pose =
      IsometryOf(state.camera_from_rig[view.camera]) * IsometryOf(*rig_from_target);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const DetectedCorner& corner : view.corners) middle += PlaceOf(state, corner);
  const Eigen::Vector3d at = pose * (middle / static_cast<double>(view.corners.size()));
  reported->distance_m = at.norm();
  const double facing = std::fabs(pose.linear().col(2).dot(at.normalized()));
  reported->tilt_deg = kDegrees * std::acos(std::min(1.0, facing));
}

void AddViews(const Detections& detections, const Calibration& calibration, std::size_t camera,
              const std::vector<double>& held_out_px, CameraReport* report) {
  double squares = 0, count = 0;
  report->worst_px = 0;
  for (std::size_t v = 0; v < detections.views.size(); ++v) {
    const TargetView& view = detections.views[v];
    if (view.camera != camera) continue;
    ReportedView reported;
    reported.image = view.image;
    const bool placed = calibration.state.rig_from_target[view.exposure].has_value();
    if (!placed) reported.note = "no pose explains it";
    if (view.exposure < held_out_px.size()) reported.held_out_px = held_out_px[view.exposure];
    AddPlace(calibration.state, view, &reported);
    const std::vector<Eigen::Vector2d> off = ViewResiduals(calibration.state, view);
    double of_view = 0;
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      CornerResidual residual;
      residual.view = report->views.size();
      residual.id = view.corners[i].id;
      residual.seen = {view.corners[i].pixel[0], view.corners[i].pixel[1]};
      residual.off = {off[i].x(), off[i].y()};
      residual.outlier =
          !calibration.use.empty() && !calibration.use[v].empty() && calibration.use[v][i] == 0;
      if (placed) report->residuals.corners.push_back(residual);
      if (residual.outlier) {
        ++reported.outliers;
        continue;
      }
      if (!off[i].allFinite()) continue;
      ++reported.corners;
      of_view += off[i].squaredNorm();
      reported.worst_px = std::fmax(reported.worst_px, off[i].norm());
    }
    if (reported.corners > 0)
      reported.rms_px = std::sqrt(of_view / static_cast<double>(reported.corners));
    squares += of_view;
    count += static_cast<double>(reported.corners);
    report->worst_px = std::fmax(report->worst_px, reported.worst_px);
    report->views.push_back(std::move(reported));
  }
  if (count > 0) report->rms_px = std::sqrt(squares / count);
}

void AddExpectedErrors(const Detections& detections, const Calibration& calibration,
                       std::size_t index, const Camera& camera, const DescribeOptions& options,
                       CameraReport* report) {
  const Eigen::MatrixXd covariance = options.posterior->OfCamera(index);
  EreOptions asked = options.ere;
  if (asked.gauge_pixels.empty())
    asked.gauge_pixels = SeenPixels(detections, index, calibration.use);
  const ImageField nodes = EmptyField(camera.Width(), camera.Height(), 65);
  std::vector<EreGauge> gauges = {asked.gauge};
  for (const EreGauge gauge : {EreGauge::kRotationCompensated, EreGauge::kRaw})
    if (gauge != asked.gauge && gauges.size() < 2) gauges.push_back(gauge);
  for (const EreGauge gauge : gauges) {
    EreOptions ere = asked;
    ere.gauge = gauge;
    ere.columns = static_cast<int>(nodes.columns);
    ere.rows = static_cast<int>(nodes.rows);
    EreMap map = EreGrid(camera, ere).Map(covariance);
    MarkReached(detections, index, calibration.use, &map);
    report->maps.push_back(DescribeEre(map, camera, ere, options.accuracy_px));
    // What counts is looked for where the options say.
    ere.columns = asked.columns;
    ere.rows = asked.rows;
    const EreMap coarse = EreGrid(camera, ere).Map(covariance);
    const ErePoint* worst = coarse.Worst();
    if (!worst) continue;
    if (gauge == asked.gauge) {
      report->max_ere_px = worst->ere_px;
      report->max_ere_at = {worst->pixel.x(), worst->pixel.y()};
    }
    const auto over = [&](int columns, int rows) {
      return report->maps.back().subtitle + "; over " + std::to_string(columns) + " x " +
             std::to_string(rows) + " pixels";
    };
    report->max_ere_variants.emplace_back(over(coarse.columns, coarse.rows), worst->ere_px);
    report->max_ere_variants.emplace_back(over(map.columns, map.rows), map.MaxPx());
  }
  EreMap reached = EreGrid(camera, asked).Map(covariance);
  MarkReached(detections, index, calibration.use, &reached);
  double where_seen = kNotKnown;
  for (const ErePoint& point : reached.points)
    if (point.has_ray && point.is_reached) where_seen = std::fmax(where_seen, point.ere_px);
  if (std::isfinite(where_seen))
    report->max_ere_variants.emplace_back("where corners were seen", where_seen);
  report->section = DescribeSection(camera, covariance, asked);
  report->section->limit_px = options.accuracy_px;
  report->section->seen_to_px = SeenAlongSection(detections, index, camera);
}

}  // namespace

CameraReport DescribeCamera(const Detections& detections, const Calibration& calibration,
                            std::size_t camera, const DescribeOptions& options) {
  CameraReport report;
  report.camera = calibration.state.cameras[camera];
  const Camera model(report.camera);
  AddParameters(model, options.posterior, camera, &report);
  AddPlaceOnRig(calibration, options.posterior, camera, &report);
  if (options.posterior) MarkUnconstrained(*options.posterior, camera, &report);
  AddViews(detections, calibration, camera, options.held_out_px, &report);
  report.sigma_px = calibration.sigma_px;
  report.residuals.width = report.camera.width;
  report.residuals.height = report.camera.height;
  if (options.posterior) {
    AddExpectedErrors(detections, calibration, camera, model, options, &report);
    report.distortion = DescribeDistortion(model, options.posterior->OfCamera(camera));
  } else {
    report.distortion = DescribeDistortion(model, {});
  }
  report.coverage = DescribeCoverage(detections, camera, model);
  for (const ImageLine& outline : report.coverage.outlines)
    for (const ImagePoint& pixel : outline)
      if (const auto ray = model.Unproject({pixel.x, pixel.y}))
        report.distortion->seen_to_deg = std::max(
            report.distortion->seen_to_deg, kDegrees * std::acos(std::clamp(ray->z(), -1.0, 1.0)));
  report.undistortion =
      DescribeUndistortion(detections, camera, model,
                           camera < options.images.size() ? options.images[camera] : std::nullopt);
  return report;
}

ErrorMap DescribeEre(const EreMap& map, const Camera& camera, const EreOptions& options,
                     double accuracy_px) {
  ErrorMap error;
  error.title = "Expected reprojection error";
  error.subtitle = options.gauge == EreGauge::kRaw ? "raw: the camera's frame as the model has it"
                   : options.gauge == EreGauge::kRotationCompensated
                       ? "a rotation of the camera's frame taken out"
                       : "a motion of the camera's frame taken out";
  if (std::isfinite(options.range_m))
    error.subtitle += ", at " + ReadableNumber(options.range_m, 3) + " m";
  error.field.width = camera.Width();
  error.field.height = camera.Height();
  error.field.columns = static_cast<std::size_t>(map.columns);
  error.field.rows = static_cast<std::size_t>(map.rows);
  error.limit_px = accuracy_px;
  for (const ErePoint& point : map.points) {
    error.field.values.push_back(point.has_ray ? point.ere_px : kNotKnown);
    error.seen.push_back(point.is_reached);
  }
  if (const ErePoint* worst = map.Worst()) {
    error.max_px = worst->ere_px;
    error.max_at = {worst->pixel.x(), worst->pixel.y()};
  }
  return error;
}

ErrorMap DescribeDifference(const CalibrationDifference& difference, const std::string& name,
                            double limit_px) {
  ErrorMap map;
  map.title = "Difference to " + name;
  const Eigen::AngleAxisd turn(difference.second_from_first.linear());
  const double shift = difference.second_from_first.translation().norm();
  map.subtitle = "after a rotation of " + ReadableNumber(kDegrees * turn.angle(), 3) + "°";
  if (shift > 0) map.subtitle += " and a shift of " + ReadableNumber(1e3 * shift, 3) + " mm";
  if (turn.angle() == 0 && shift == 0) map.subtitle = "nothing taken out";
  if (difference.unseen > 0)
    map.subtitle += "; " + ReadableCount(difference.unseen) + " rays have no image there";
  map.field = difference.field;
  map.mean_px = difference.mean_px;
  map.limit_px = limit_px;
  if (difference.nodes > 0) {
    map.max_px = difference.max_px;
    map.max_at = {difference.max_at.x(), difference.max_at.y()};
  }
  return map;
}

TriedModel DescribeTrial(const ModelTrial& trial, bool chosen) {
  TriedModel tried;
  tried.name = trial.model;
  tried.board = BoardShapeName(trial.board);
  tried.parameters = trial.parameters;
  tried.converged = trial.converged;
  tried.chosen = chosen;
  tried.failure = trial.failure;
  if (!trial.failure.empty()) return tried;
  tried.rms_px = trial.rms_px;
  tried.held_out_mean_px = trial.held_out.mean_px;
  tried.held_out_rms_px = trial.held_out.rms_px;
  tried.percentile_995_px = trial.held_out.percentile_995_px;
  tried.max_px = trial.held_out.max_px;
  tried.difference_px = trial.difference_px;
  tried.standard_error_px = trial.standard_error_px;
  tried.bic = trial.bic;
  return tried;
}

void DescribeSelection(const ModelSelection& selection, CalibrationReport* report) {
  for (const ModelTrial& shape : selection.shapes) {
    report->shapes.push_back(DescribeTrial(shape, shape.board == selection.options.board));
    report->shapes.back().bic = kNotKnown;  // judged by held-out error alone
  }
  for (std::size_t i = 0; i < selection.trials.size(); ++i)
    report->models.push_back(DescribeTrial(selection.trials[i], i == selection.chosen));
}

ReportedError DescribeError(const std::string& name, const ReprojectionError& error) {
  ReportedError reported;
  reported.name = name;
  reported.views = error.views;
  reported.corners = error.corners;
  reported.unseen = error.unseen;
  if (error.corners == 0) return reported;
  reported.mean_px = error.mean_px;
  reported.rms_px = error.rms_px;
  reported.median_px = error.median_px;
  reported.percentile_995_px = error.percentile_995_px;
  reported.max_px = error.max_px;
  return reported;
}

}  // namespace graticule
