#include "graticule/io/accuracy_html.hpp"

#include "graticule/io/html.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

std::string Number(double value) { return ReadableNumber(value, 3); }

std::vector<html::Cell> Row(const std::string& run, const FamilyAccuracy& accuracy) {
  std::vector<html::Cell> row = {{accuracy.family.empty() ? "together" : accuracy.family, "name"}};
  if (!run.empty()) row.push_back({run, "name"});
  row.push_back({ReadableCount(accuracy.matched)});
  for (const ErrorSummary* error : {&accuracy.ate.translation_m, &accuracy.ate.rotation_deg})
    for (const double value : {error->rmse, error->mean, error->max})
      row.push_back({Number(value)});
  for (const PoseError* error : {&accuracy.rpe_step, &accuracy.rpe_distance})
    for (const ErrorSummary* part : {&error->translation_m, &error->rotation_deg})
      row.push_back({Number(part->rmse)});
  return row;
}

}  // namespace

std::string AccuracyHtml(const std::vector<std::pair<std::string, const Accuracy*>>& runs) {
  if (runs.empty()) return {};
  const Accuracy& first = *runs[0].second;
  const std::string over = ReadableNumber(first.rpe_distance_m, 4) + " m";
  std::vector<html::Column> columns = {{"poses"}};
  if (!runs[0].first.empty()) columns.push_back({"configuration"});
  columns.push_back({"matched", true, "poses whose truth is known"});
  for (const char* unit : {"m", "deg"}) {
    const char* hint = "absolute trajectory error, after alignment";
    columns.push_back({std::string("ATE [") + unit + "]", true, std::string(hint) + ", rmse"});
    columns.push_back({"mean", true, hint});
    columns.push_back({"max", true, hint});
  }
  for (const std::string& pair : {std::string("a step"), "over " + over}) {
    columns.push_back({"RPE " + pair + " [m]", true, "relative pose error, rmse"});
    columns.push_back({"[deg]", true, "relative pose error, rmse"});
  }
  // Family by family: what is to be compared stands together.
  std::vector<std::vector<html::Cell>> rows;
  for (const auto& [name, accuracy] : runs) rows.push_back(Row(name, accuracy->together));
  for (std::size_t i = 0; i < first.families.size(); ++i)
    for (const auto& [name, accuracy] : runs)
      if (i < accuracy->families.size()) rows.push_back(Row(name, accuracy->families[i]));
  std::string note = "Truth: " + AccuracyTitle(first) + ".";
  if (!first.families.empty()) note += "  Each family is aligned by itself, together as one.";
  return html::Paragraph(note, "soft") + html::Table(columns, rows);
}

}  // namespace graticule
