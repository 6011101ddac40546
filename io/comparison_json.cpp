#include <nlohmann/json.hpp>

#include "graticule/io/comparison.hpp"
#include "graticule/io/report_json.hpp"

namespace graticule {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

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
  json["ate_m"] = OrNull(run.ate_m);
  json["rpe_m"] = OrNull(run.rpe_m);
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
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace graticule
