#include <nlohmann/json.hpp>

#include "graticule/io/comparison.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/report_json.hpp"

namespace graticule {
namespace {

using Json = nlohmann::ordered_json;

Json RunJson(const ComparisonRun& run) {
  Json json;
  json["file"] = run.file;
  json["configuration"] = run.configuration;
  json["error"] = run.error.empty() ? Json(nullptr) : Json(run.error);
  if (!run.error.empty()) return json;

  // The figures stand beside the run as they stand in a report of its own, but times are medians.
  Report report = run.report;
  report.timing = run.median;
  ReportContext context;
  context.peak_memory_bytes = run.peak_memory_bytes;
  context.repaired = run.repaired;
  context.accuracy = run.accuracy;
  const Json whole = Json::parse(ReportJson(report, context));
  for (const char* name : {"termination", "initial_cost", "final_cost", "final_objective",
                           "reduced_chi2", "iterations"})
    json[name] = whole[name];
  json["best_known"] = run.best_known;
  json["gap"] = run.gap;
  json["repeats"] = run.repeats;
  json["seconds"] = whole["seconds"];
  json["cpu_seconds"] = whole["cpu_seconds"];
  json["min_total_seconds"] = run.min_total_s;
  json["max_total_seconds"] = run.max_total_s;
  json["peak_memory_bytes"] = whole["peak_memory_bytes"];
  json["repaired_information"] = whole["repaired_information"];
  const FamilyAccuracy all = run.accuracy ? run.accuracy->together : FamilyAccuracy();
  json["ate_m"] = all.ate.translation_m.rmse;
  json["ate_deg"] = all.ate.rotation_deg.rmse;
  json["rpe_m"] = all.rpe_step.translation_m.rmse;
  json["rpe_deg"] = all.rpe_step.rotation_deg.rmse;
  json["accuracy"] = whole["accuracy"];
  json["report"] = Json::parse(ReportJson(run.report, context));
  return json;
}

}  // namespace

std::string ComparisonJson(const Comparison& comparison) {
  Json json;
  json["schema"] = "graticule-comparison/1";
  json["runs"] = Json::array();
  for (const ComparisonRun& run : comparison.runs) json["runs"].push_back(RunJson(run));
  json["provenance"] = Json::object();
  for (const auto& [name, value] : comparison.provenance) json["provenance"][name] = value;
  return JsonText(json, 2) + "\n";
}

}  // namespace graticule
