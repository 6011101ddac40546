#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/calibration_report.hpp"
#include "graticule/io/json_text.hpp"

namespace graticule {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no numbers that are not finite.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json Point(const ImagePoint& point) { return {Number(point.x), Number(point.y)}; }

const char* WordOf(CalibrationVerdict verdict) {
  return verdict == CalibrationVerdict::kMet      ? "met"
         : verdict == CalibrationVerdict::kNotMet ? "not_met"
                                                  : "unconstrained";
}

Json Of(const ReportedError& error) {
  return {{"name", error.name},
          {"views", error.views},
          {"corners", error.corners},
          {"without_image", error.unseen},
          {"mean_px", Number(error.mean_px)},
          {"rms_px", Number(error.rms_px)},
          {"median_px", Number(error.median_px)},
          {"percentile_99_5_px", Number(error.percentile_995_px)},
          {"max_px", Number(error.max_px)}};
}

Json Of(const TriedModel& model) {
  Json json = {{"model", model.name},
               {"board", model.board},
               {"parameters", model.parameters},
               {"chosen", model.chosen},
               {"converged", model.converged},
               {"rms_px", Number(model.rms_px)},
               {"held_out_mean_px", Number(model.held_out_mean_px)},
               {"held_out_rms_px", Number(model.held_out_rms_px)},
               {"held_out_99_5_px", Number(model.percentile_995_px)},
               {"held_out_max_px", Number(model.max_px)},
               {"difference_px", Number(model.difference_px)},
               {"standard_error_px", Number(model.standard_error_px)},
               {"bic", Number(model.bic)}};
  if (!model.failure.empty()) json["failure"] = model.failure;
  return json;
}

Json Of(const ErrorMap& map) {
  Json values = Json::array(), seen = Json::array();
  for (const double value : map.field.values) values.push_back(Number(value));
  for (const std::uint8_t one : map.seen) seen.push_back(one != 0);
  return {{"title", map.title},
          {"kind", map.subtitle},
          {"max_px", Number(map.max_px)},
          {"max_at", Point(map.max_at)},
          {"mean_px", Number(map.mean_px)},
          {"columns", map.field.columns},
          {"rows", map.field.rows},
          {"px", values},
          {"seen", seen}};
}

Json Of(const ReportedView& view) {
  Json json = {{"image", view.image},
               {"corners", view.corners},
               {"outliers", view.outliers},
               {"rms_px", Number(view.rms_px)},
               {"worst_px", Number(view.worst_px)},
               {"held_out_px", Number(view.held_out_px)},
               {"distance_m", Number(view.distance_m)},
               {"tilt_deg", Number(view.tilt_deg)}};
  if (!view.note.empty()) json["note"] = view.note;
  return json;
}

Json Curves(const CrossSection& section) {
  Json curves = Json::array();
  for (const Curve& curve : section.curves) {
    Json points = Json::array();
    for (const Curve::Point& point : curve.points)
      points.push_back({Number(point.x), Number(point.y)});
    curves.push_back({{"name", curve.name}, {"points", points}});
  }
  return curves;
}

Json Of(const CameraReport& camera) {
  Json json = {{"name", camera.camera.name},
               {"model", camera.camera.model},
               {"width", camera.camera.width},
               {"height", camera.camera.height},
               {"rms_px", Number(camera.rms_px)},
               {"worst_px", Number(camera.worst_px)},
               {"sigma_px", Number(camera.sigma_px)},
               {"max_ere_px", Number(camera.max_ere_px)},
               {"max_ere_at", Point(camera.max_ere_at)}};
  json["max_ere_variants"] = Json::object();
  for (const auto& [name, px] : camera.max_ere_variants)
    json["max_ere_variants"][name] = Number(px);
  for (const ReportedNumber& number : camera.numbers)
    json["parameters"].push_back({{"name", number.name},
                                  {"unit", number.unit},
                                  {"value", Number(number.value)},
                                  {"deviation", Number(number.deviation)},
                                  {"constrained", number.constrained}});
  json["views"] = Json::array();
  for (const ReportedView& view : camera.views) json["views"].push_back(Of(view));
  json["outliers"] = Json::array();
  for (const CornerResidual& corner : camera.residuals.corners)
    if (corner.outlier)
      json["outliers"].push_back(
          {{"image", corner.view < camera.views.size() ? camera.views[corner.view].image : ""},
           {"corner", corner.id},
           {"seen", Point(corner.seen)},
           {"off_px", Point(corner.off)}});
  json["maps"] = Json::array();
  for (const ErrorMap& map : camera.maps) json["maps"].push_back(Of(map));
  if (camera.section) json["section"] = Curves(*camera.section);
  if (camera.suggestion)
    json["suggestion"] = {{"advice", camera.suggestion->advice},
                          {"max_px_after", Number(camera.suggestion->max_px_after)}};
  return json;
}

}  // namespace

std::string CalibrationReportJson(const CalibrationReport& report) {
  Json json = {{"schema", "graticule-calibration/1"},
               {"title", report.title},
               {"verdict", WordOf(report.verdict)},
               {"verdict_text", CalibrationVerdictText(report)},
               {"accuracy_px", report.accuracy_px > 0 ? Json(report.accuracy_px) : Json(nullptr)},
               {"unconstrained", report.unconstrained},
               {"advice", report.advice}};
  json["facts"] = Json::object();
  for (const auto& [name, value] : report.facts) json["facts"][name] = value;
  for (const char* list : {"errors", "cameras", "models", "shapes", "board"})
    json[list] = Json::array();
  for (const ReportedError& error : report.errors) json["errors"].push_back(Of(error));
  for (const CameraReport& camera : report.cameras) json["cameras"].push_back(Of(camera));
  for (const TriedModel& model : report.models) json["models"].push_back(Of(model));
  for (const TriedModel& model : report.shapes) json["shapes"].push_back(Of(model));
  if (report.board)
    for (const BoardPicture::Corner& corner : report.board->corners)
      json["board"].push_back(
          {{"described_m", {corner.x, corner.y}}, {"moved_m", {corner.dx, corner.dy, corner.dz}}});
  json["timings_s"] = Json::object();
  for (const auto& [name, seconds] : report.timings) json["timings_s"][name] = Number(seconds);
  json["warnings"] = report.warnings;
  return JsonText(json, 2) + "\n";
}

}  // namespace graticule
