#include "graticule/io/calibration_report.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/html.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

std::string Px(double value, int digits = 3) {
  return std::isfinite(value) ? ReadableNumber(value, digits) + " px" : "–";
}

std::string NameOf(const CameraReport& camera, std::size_t index) {
  return camera.camera.name.empty() ? "cam" + std::to_string(index) : camera.camera.name;
}

// For the name of a file.
std::string Plain(const std::string& text) {
  std::string plain;
  for (const char c : text)
    plain += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'
                 ? c
                 : '-';
  return plain;
}

const CameraReport* WorstOf(const CalibrationReport& report) {
  const CameraReport* worst = nullptr;
  for (const CameraReport& camera : report.cameras)
    if (std::isfinite(camera.max_ere_px) && (!worst || camera.max_ere_px > worst->max_ere_px))
      worst = &camera;
  return worst;
}

// A number with as many digits as its deviation leaves: the last but one of them is certain.
std::string Value(const ReportedNumber& number) {
  if (!(number.deviation > 0) || !std::isfinite(number.deviation) || number.value == 0)
    return ReadableNumber(number.value, 6);
  const double digits = std::floor(std::log10(std::fabs(number.value))) -
                        std::floor(std::log10(number.deviation)) + 2;
  return ReadableNumber(number.value, static_cast<int>(std::clamp(digits, 2.0, 12.0)));
}

std::string NumberTable(const CameraReport& camera) {
  std::vector<std::vector<html::Cell>> rows;
  for (const ReportedNumber& number : camera.numbers) {
    const double relative = std::fabs(number.deviation / number.value);
    rows.push_back(
        {{number.name, "name"},
         {Value(number)},
         {number.constrained ? ReadableNumber(number.deviation, 2) : "not constrained",
          number.constrained ? "" : "bad"},
         {std::isfinite(relative) && number.constrained ? ReadableNumber(100 * relative, 2) + " %"
                                                        : "–"},
         {number.unit}});
  }
  return html::Table({{"parameter", false, ""},
                      {"value", true, ""},
                      {"standard deviation", true, "with the corners' noise as the residuals say"},
                      {"relative", true, ""},
                      {"unit", false, ""}},
                     rows);
}

std::string ViewTable(const CameraReport& camera) {
  double largest = 0;
  for (const ReportedView& view : camera.views)
    if (std::isfinite(view.rms_px)) largest = std::max(largest, view.rms_px);
  std::vector<std::vector<html::Cell>> rows;
  for (const ReportedView& view : camera.views)
    rows.push_back(
        {{view.image, "key"},
         {ReadableCount(view.corners)},
         {view.outliers > 0 ? ReadableCount(view.outliers) : "", "bad"},
         {ReadableNumber(view.rms_px, 3), "",
          std::isfinite(view.rms_px) && largest > 0 ? view.rms_px / largest : -1},
         {ReadableNumber(view.worst_px, 3)},
         {ReadableNumber(view.held_out_px, 3)},
         {std::isfinite(view.distance_m) ? ReadableNumber(view.distance_m, 3) : "–"},
         {std::isfinite(view.tilt_deg) ? ReadableNumber(std::round(view.tilt_deg), 3) : "–"},
         {view.note, view.note.empty() ? "" : "bad"}});
  return html::Table({{"view", false, ""},
                      {"corners", true, "that count"},
                      {"set aside", true, ""},
                      {"rms [px]", true, ""},
                      {"worst [px]", true, ""},
                      {"held out [px]", true, "mean error of a calibration without the view"},
                      {"distance [m]", true, "of the middle of what was seen"},
                      {"tilt [deg]", true, "of the target against the ray to its middle"},
                      {"", false, ""}},
                     rows);
}

std::string OutlierTable(const CameraReport& camera) {
  std::vector<const CornerResidual*> outliers;
  for (const CornerResidual& corner : camera.residuals.corners)
    if (corner.outlier) outliers.push_back(&corner);
  if (outliers.empty()) return {};
  const auto length = [](const CornerResidual* corner) {
    const double px = std::hypot(corner->off.x, corner->off.y);
    return std::isfinite(px) ? px : HUGE_VAL;
  };
  std::stable_sort(outliers.begin(), outliers.end(),
                   [&](const auto* a, const auto* b) { return length(a) > length(b); });
  constexpr std::size_t kMost = 200;
  std::vector<std::vector<html::Cell>> rows;
  for (std::size_t i = 0; i < std::min(outliers.size(), kMost); ++i) {
    const CornerResidual& corner = *outliers[i];
    rows.push_back(
        {{corner.view < camera.views.size() ? camera.views[corner.view].image : "", "key"},
         {std::to_string(corner.id)},
         {ReadableNumber(corner.seen.x, 6)},
         {ReadableNumber(corner.seen.y, 6)},
         {ReadableNumber(std::hypot(corner.off.x, corner.off.y), 3)}});
  }
  const std::string table = html::Table({{"view", false, ""},
                                         {"corner", true, ""},
                                         {"x [px]", true, ""},
                                         {"y [px]", true, ""},
                                         {"off by [px]", true, ""}},
                                        rows);
  return html::Details(
      ReadableCount(outliers.size()) +
          (outliers.size() == 1 ? " corner was set aside" : " corners were set aside") +
          (outliers.size() > kMost ? "; the worst of them:" : ""),
      table);
}

std::string VariantTable(const CameraReport& camera) {
  if (camera.max_ere_variants.empty()) return {};
  std::vector<std::vector<html::Cell>> rows;
  for (const auto& [name, px] : camera.max_ere_variants)
    rows.push_back({{name}, {ReadableNumber(px, 3)}});
  return html::Table({{"largest expected error", false, ""}, {"px", true, ""}}, rows);
}

std::string CameraSection(const CameraReport& camera, std::size_t index) {
  std::string body;
  const CameraIntrinsics& c = camera.camera;
  body += html::Paragraph(c.model + ", " + std::to_string(c.width) + " x " +
                              std::to_string(c.height) + " pixels; corners to " +
                              Px(camera.sigma_px) + " on either axis, as the residuals say",
                          "soft");
  body += NumberTable(camera);
  if (camera.suggestion) body += html::Figure(DrawSuggestion(*camera.suggestion));
  std::string maps;
  for (const ErrorMap& map : camera.maps) maps += html::Figure(DrawErrorMap(map));
  body += "<div class=\"pair\">\n" + maps + "</div>\n" + VariantTable(camera);
  body += "<div class=\"pair\">\n" + html::Figure(DrawResiduals(camera.residuals)) +
          html::Figure(DrawCoverage(camera.coverage)) + "</div>\n";
  if (camera.undistortion) body += html::Figure(DrawUndistortion(*camera.undistortion));
  std::string curves;
  if (camera.section) curves += html::Figure(DrawCrossSection(*camera.section));
  if (camera.distortion) curves += html::Figure(DrawDistortion(*camera.distortion));
  std::vector<ViewBar> bars;
  for (const ReportedView& view : camera.views)
    bars.push_back({view.image, view.rms_px, view.held_out_px, view.outliers});
  curves += html::Figure(DrawResidualHistogram(camera.residuals.corners, camera.sigma_px));
  curves += html::Figure(DrawViewBars(bars));
  body += "<div class=\"pair\">\n" + curves + "</div>\n";
  body += OutlierTable(camera);
  body += html::Details(ReadableCount(camera.views.size()) + " views", ViewTable(camera));
  return html::Section("Camera " + NameOf(camera, index), body);
}

std::string ErrorTable(const std::vector<ReportedError>& errors) {
  if (errors.empty()) return {};
  std::vector<std::vector<html::Cell>> rows;
  for (const ReportedError& error : errors)
    rows.push_back({{error.name, "name"},
                    {ReadableCount(error.views)},
                    {ReadableCount(error.corners)},
                    {ReadableCount(error.unseen), error.unseen > 0 ? "bad" : ""},
                    {ReadableNumber(error.mean_px, 3)},
                    {ReadableNumber(error.rms_px, 3)},
                    {ReadableNumber(error.median_px, 3)},
                    {ReadableNumber(error.percentile_995_px, 3)},
                    {ReadableNumber(error.max_px, 3)}});
  return html::Section("Reprojection errors",
                       html::Table({{"of", false, ""},
                                    {"views", true, ""},
                                    {"corners", true, ""},
                                    {"no image", true, "corners that the model has no image of"},
                                    {"mean [px]", true, ""},
                                    {"rms [px]", true, ""},
                                    {"median [px]", true, ""},
                                    {"99.5 % [px]", true, ""},
                                    {"max [px]", true, ""}},
                                   rows));
}

std::string TriedTable(const std::vector<TriedModel>& models) {
  std::vector<std::vector<html::Cell>> rows;
  for (const TriedModel& model : models)
    rows.push_back(
        {{model.name, model.chosen ? "name best" : "name"},
         {model.board},
         {std::to_string(model.parameters)},
         {ReadableNumber(model.rms_px, 4)},
         {ReadableNumber(model.held_out_mean_px, 4)},
         {ReadableNumber(model.held_out_rms_px, 4)},
         {ReadableNumber(model.percentile_995_px, 3)},
         {ReadableNumber(model.difference_px, 2)},
         {ReadableNumber(model.standard_error_px, 2)},
         {std::isfinite(model.bic) ? ReadableNumber(std::round(model.bic), 6) : "–"},
         {model.failure.empty() ? model.converged ? "" : "did not converge" : model.failure,
          "bad"}});
  return html::Table({{"model", false, ""},
                      {"board", false, ""},
                      {"parameters", true, "of each camera"},
                      {"rms [px]", true, "of the views that it was made from"},
                      {"held out, mean", true, "of views that it was not made from [px]"},
                      {"held out, rms", true, "[px]"},
                      {"99.5 %", true, "held out [px]"},
                      {"to the best", true, "difference of the mean to the least [px]"},
                      {"standard error", true, "of that difference [px]"},
                      {"BIC", true, "less the best one's: evidence that is lost"},
                      {"", false, ""}},
                     rows);
}

std::string ModelSection(const CalibrationReport& report) {
  std::string body;
  if (!report.models.empty())
    body += html::Figure(DrawModels("Camera models", report.models)) + TriedTable(report.models);
  if (!report.shapes.empty())
    body +=
        html::Figure(DrawModels("Shapes of the board", report.shapes)) + TriedTable(report.shapes);
  return body.empty() ? body : html::Section("Models that were tried", body);
}

std::string Header(const CalibrationReport& report) {
  const char* css = report.verdict == CalibrationVerdict::kMet      ? "verdict good"
                    : report.verdict == CalibrationVerdict::kNotMet ? "verdict fair"
                                                                    : "verdict bad";
  const char* word = report.verdict == CalibrationVerdict::kMet && report.accuracy_px <= 0
                         ? "calibrated"
                     : report.verdict == CalibrationVerdict::kMet    ? "accurate enough"
                     : report.verdict == CalibrationVerdict::kNotMet ? "not accurate enough"
                                                                     : "not constrained";
  std::string header = "<h1>" + EscapeXml(report.title) + "</h1>\n";
  header += html::Paragraph(word, css) + html::Paragraph(CalibrationVerdictText(report));
  if (!report.advice.empty())
    header += html::Paragraph("What to photograph next:") + html::List(report.advice);
  std::vector<html::Card> cards;
  if (const CameraReport* worst = WorstOf(report))
    cards.push_back({"largest expected error", Px(worst->max_ere_px),
                     "at (" + ReadableNumber(std::round(worst->max_ere_at.x)) + ", " +
                         ReadableNumber(std::round(worst->max_ere_at.y)) + ")" +
                         (report.cameras.size() > 1 ? " of " + worst->camera.name : "")});
  for (const ReportedError& error : report.errors)
    cards.push_back({error.name, Px(error.rms_px) + " rms", "worst " + Px(error.max_px)});
  std::size_t views = 0, outliers = 0, corners = 0;
  for (const CameraReport& camera : report.cameras)
    for (const ReportedView& view : camera.views) {
      ++views;
      corners += view.corners;
      outliers += view.outliers;
    }
  cards.push_back({"views", ReadableCount(views),
                   ReadableCount(corners) + " corners, " + ReadableCount(outliers) + " set aside"});
  if (!report.cameras.empty()) cards.push_back({"model", report.cameras[0].camera.model, ""});
  return header + html::Cards(cards);
}

}  // namespace

std::string CalibrationVerdictText(const CalibrationReport& report) {
  if (!report.verdict_text.empty()) return report.verdict_text;
  if (report.verdict == CalibrationVerdict::kUnconstrained) {
    std::string text = "These views do not constrain ";
    if (report.unconstrained.empty()) text += "the calibration";
    for (std::size_t i = 0; i < report.unconstrained.size(); ++i)
      text += (i == 0                                 ? ""
               : i + 1 == report.unconstrained.size() ? " and "
                                                      : ", ") +
              report.unconstrained[i];
    return text + ".";
  }
  const CameraReport* worst = WorstOf(report);
  if (!worst) return "No error is expected: nothing is known of the parameters' covariance.";
  std::string text = "The largest expected reprojection error is " + Px(worst->max_ere_px) +
                     ", at (" + ReadableNumber(std::round(worst->max_ere_at.x)) + ", " +
                     ReadableNumber(std::round(worst->max_ere_at.y)) + ")";
  if (report.cameras.size() > 1) text += " of " + worst->camera.name;
  if (!(report.accuracy_px > 0)) return text + ".";
  text += report.verdict == CalibrationVerdict::kMet ? ": within the " : ": above the ";
  return text + Px(report.accuracy_px) + " asked for.";
}

std::string CalibrationReportHtml(const CalibrationReport& report) {
  std::vector<std::vector<html::Cell>> facts, timings;
  for (const auto& [name, value] : report.facts) facts.push_back({{name, "name"}, {value}});
  for (const auto& [name, seconds] : report.timings)
    timings.push_back({{name, "name"}, {ReadableSeconds(seconds)}});
  std::string body;
  if (!report.warnings.empty()) body += html::Section("Warnings", html::List(report.warnings));
  if (!facts.empty()) body += html::Table({{"", false, ""}, {"", false, ""}}, facts);
  body += ErrorTable(report.errors);
  for (std::size_t i = 0; i < report.cameras.size(); ++i)
    body += CameraSection(report.cameras[i], i);
  if (report.board) body += html::Section("Board", html::Figure(DrawBoard(*report.board)));
  body += ModelSection(report);
  if (!timings.empty())
    body += html::Section("Time", html::Table({{"", false, ""}, {"wall", true, ""}}, timings));
  return html::Page(report.title, Header(report), body);
}

std::vector<NamedPicture> CalibrationPictures(const CalibrationReport& report) {
  std::vector<NamedPicture> pictures;
  for (std::size_t i = 0; i < report.cameras.size(); ++i) {
    const CameraReport& camera = report.cameras[i];
    const std::string prefix = Plain(NameOf(camera, i)) + "-";
    for (std::size_t k = 0; k < camera.maps.size(); ++k)
      pictures.push_back(
          {prefix + "error-map-" + std::to_string(k + 1), DrawErrorMap(camera.maps[k])});
    pictures.push_back({prefix + "residuals", DrawResiduals(camera.residuals)});
    pictures.push_back({prefix + "residual-histogram",
                        DrawResidualHistogram(camera.residuals.corners, camera.sigma_px)});
    std::vector<ViewBar> bars;
    for (const ReportedView& view : camera.views)
      bars.push_back({view.image, view.rms_px, view.held_out_px, view.outliers});
    pictures.push_back({prefix + "views", DrawViewBars(bars)});
    pictures.push_back({prefix + "coverage", DrawCoverage(camera.coverage)});
    if (camera.undistortion)
      pictures.push_back({prefix + "undistortion", DrawUndistortion(*camera.undistortion)});
    if (camera.section) pictures.push_back({prefix + "section", DrawCrossSection(*camera.section)});
    if (camera.distortion)
      pictures.push_back({prefix + "distortion", DrawDistortion(*camera.distortion)});
    if (camera.suggestion)
      pictures.push_back({prefix + "suggestion", DrawSuggestion(*camera.suggestion)});
  }
  if (report.board) pictures.push_back({"board", DrawBoard(*report.board)});
  if (!report.models.empty())
    pictures.push_back({"models", DrawModels("Camera models", report.models)});
  if (!report.shapes.empty())
    pictures.push_back({"shapes", DrawModels("Shapes of the board", report.shapes)});
  return pictures;
}

}  // namespace graticule
