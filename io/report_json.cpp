#include "graticule/io/report_json.hpp"

#include <nlohmann/json.hpp>

#include "graticule/io/json_text.hpp"

namespace graticule {
namespace {

using Json = nlohmann::ordered_json;

Json Seconds(const Timing& timing) {
  return {{"load", timing.load.wall},    {"initialise", timing.initialise.wall},
          {"build", timing.build.wall},  {"preprocess", timing.preprocess},
          {"evaluate", timing.evaluate}, {"linear_solve", timing.linear_solve},
          {"solve", timing.solve.wall},  {"write", timing.write.wall},
          {"total", timing.total.wall}};
}

Json CpuSeconds(const Timing& timing) {
  return {{"load", timing.load.cpu},   {"initialise", timing.initialise.cpu},
          {"build", timing.build.cpu}, {"solve", timing.solve.cpu},
          {"write", timing.write.cpu}, {"total", timing.total.cpu}};
}

Json Shares(const Report& report) {
  Json shares = Json::array();
  for (const CostShare& share : report.shares)
    shares.push_back({{"type", share.type},
                      {"source", share.source},
                      {"factors", share.factors},
                      {"residuals", share.residuals},
                      {"initial_cost", share.initial_cost},
                      {"final_cost", share.final_cost}});
  return shares;
}

Json Worst(const Report& report) {
  Json worst = Json::array();
  for (const WorstFactor& factor : report.worst) {
    Json keys = Json::array();
    for (const Key& key : factor.keys) keys.push_back(key.ToString());
    worst.push_back({{"factor", factor.id},
                     {"type", factor.type},
                     {"source", factor.source},
                     {"keys", std::move(keys)},
                     {"chi2", factor.chi2},
                     {"residuals", factor.residuals},
                     {"weight", factor.weight}});
  }
  return worst;
}

Json Rejection(const RejectionSummary& rejection) {
  Json sources = Json::object(), rejected = Json::array();
  for (const auto& [source, count] : rejection.suspect_sources) sources[source] = count;
  for (const RejectedFactor& factor : rejection.rejected) {
    Json keys = Json::array();
    for (const Key& key : factor.keys) keys.push_back(key.ToString());
    rejected.push_back({{"factor", factor.id},
                        {"type", factor.type},
                        {"source", factor.source},
                        {"keys", std::move(keys)},
                        {"chi2", factor.chi2},
                        {"limit", factor.limit}});
  }
  return {{"method", rejection.method},
          {"trusted", rejection.trusted},
          {"suspects", rejection.suspects},
          {"suspect_sources", std::move(sources)},
          {"inlier_quantile", rejection.inlier_quantile},
          {"inlier_noise_scale", rejection.inlier_noise_scale},
          {"seconds", rejection.seconds},
          {"rejected", std::move(rejected)}};
}

Json History(const Report& report) {
  Json history = Json::array();
  for (const Iteration& step : report.iterations)
    history.push_back({{"number", step.number},
                       {"accepted", step.accepted},
                       {"reused_factor", step.reused_factor},
                       {"objective", step.objective},
                       {"objective_change", step.objective_change},
                       {"gradient_max_norm", step.gradient_max_norm},
                       {"step_norm", step.step_norm},
                       {"trust_region_radius", step.trust_region_radius},
                       {"linear_iterations", step.linear_iterations},
                       {"seconds", step.seconds}});
  return history;
}

Json CertificateJson(const CertificateSummary& certificate) {
  Json json;
  json["verdict"] = certificate.verdict;
  json["text"] = certificate.text;
  json["reasons"] = certificate.reasons;
  if (certificate.is_applicable) {
    json["cost"] = certificate.cost;
    json["lower_bound"] = certificate.lower_bound;
    json["gap"] = certificate.gap;
    json["relative_gap"] = certificate.relative_gap;
    json["eigenvalue"] =
        certificate.verdict == "refused" ? Json(certificate.eigenvalue) : Json(nullptr);
    json["exact_factors"] = certificate.exact_factors;
    json["factors"] = certificate.factors;
  }
  json["seconds"] = certificate.seconds;
  json["improved"] = certificate.improved;
  json["attempts"] = Json::array();
  for (const CertificateSummary::Attempt& attempt : certificate.attempts)
    json["attempts"].push_back({{"from", attempt.from},
                                {"cost", attempt.cost},
                                {"verdict", attempt.verdict},
                                {"seconds", attempt.seconds}});
  return json;
}

Json SecondLook(const SecondLookSummary& look) {
  const auto solve = [](const SecondLookSummary::Solve& solve) -> Json {
    return {{"start", solve.start},
            {"termination", solve.termination},
            {"objective", solve.objective},
            {"iterations", solve.iterations},
            {"seconds", solve.seconds}};
  };
  return {{"text", look.text},
          {"reduced_chi2", look.reduced_chi2},
          {"first", solve(look.first)},
          {"verdict", look.verdict.empty() ? Json(nullptr) : Json(look.verdict)},
          {"certificate_seconds", look.certificate_seconds},
          {"second", look.second ? solve(*look.second) : Json(nullptr)},
          {"improved", look.improved},
          {"stopped", look.was_stopped}};
}

Json Object(const std::vector<std::pair<std::string, std::string>>& members) {
  Json object = Json::object();
  for (const auto& [name, value] : members) object[name] = value;
  return object;
}

Json Repaired(const std::optional<RepairedInformation>& repaired) {
  if (!repaired) return nullptr;
  return {{"count", repaired->count},
          {"of", repaired->of},
          {"smallest_eigenvalue", repaired->smallest_eigenvalue},
          {"largest_change", repaired->largest_change},
          {"first", repaired->first}};
}

Json Summary(const ErrorSummary& error) {
  return {{"rmse", error.rmse}, {"mean", error.mean}, {"max", error.max}};
}

Json Errors(const PoseError& error) {
  return {{"count", error.translation_m.count},
          {"translation_m", Summary(error.translation_m)},
          {"rotation_deg", Summary(error.rotation_deg)}};
}

Json Family(const FamilyAccuracy& accuracy) {
  return {{"poses", accuracy.poses},
          {"matched", accuracy.matched},
          {"alignment", accuracy.alignment},
          {"scale", accuracy.scale},
          {"ate", Errors(accuracy.ate)},
          {"rpe_step", Errors(accuracy.rpe_step)},
          {"rpe_distance", Errors(accuracy.rpe_distance)}};
}

Json AgainstTruth(const std::optional<Accuracy>& accuracy) {
  if (!accuracy) return nullptr;
  Json json = {{"truth", accuracy->truth},
               {"rpe_distance_m", accuracy->rpe_distance_m},
               {"together", Family(accuracy->together)},
               {"families", Json::object()}};
  for (const FamilyAccuracy& family : accuracy->families)
    json["families"][family.family] = Family(family);
  return json;
}

}  // namespace

std::string RepairedJson(const std::optional<RepairedInformation>& repaired) {
  return JsonText(Repaired(repaired));
}

std::string AccuracyJson(const std::optional<Accuracy>& accuracy) {
  return JsonText(AgainstTruth(accuracy));
}

std::string ReportJson(const Report& report, const ReportContext& context) {
  Json json;
  json["schema"] = "graticule-report/1";
  if (!context.file.empty()) json["file"] = context.file;
  if (!context.format.empty()) json["format"] = context.format;
  if (!context.configuration.empty()) json["configuration"] = context.configuration;
  if (!context.initialisation.empty()) json["initialisation"] = context.initialisation;
  if (!context.outputs.empty()) json["outputs"] = context.outputs;
  if (!context.extras.empty()) json["extras"] = Object(context.extras);

  json["termination"] = ToString(report.termination);
  json["message"] = report.message;
  json["initial_cost"] = report.initial_cost;
  json["final_cost"] = report.final_cost;
  json["initial_objective"] = report.initial_objective;
  json["final_objective"] = report.final_objective;
  json["chi2"] = report.Chi2();
  json["degrees_of_freedom"] = report.degrees_of_freedom;
  json["reduced_chi2"] = report.ReducedChi2();
  json["iterations"] = report.Steps();

  if (context.second_look) json["second_look"] = SecondLook(*context.second_look);
  if (context.certificate) json["certificate"] = CertificateJson(*context.certificate);

  json["variables"] = report.variables;
  json["fixed_variables"] = report.fixed_variables;
  json["parameters"] = report.parameters;
  json["factors"] = report.factors;
  json["residuals"] = report.residuals;

  json["seconds"] = Seconds(report.timing);
  json["cpu_seconds"] = CpuSeconds(report.timing);
  json["threads"] = report.threads;
  json["peak_memory_bytes"] =
      context.peak_memory_bytes ? Json(context.peak_memory_bytes) : Json(nullptr);
  json["linear_solver"] = report.linear_solver;

  json["anchors"] = report.anchors;
  json["warnings"] = report.warnings;
  json["repaired_information"] = Repaired(context.repaired);
  json["accuracy"] = AgainstTruth(context.accuracy);
  json["cost_by_type"] = Shares(report);
  json["worst_factors"] = Worst(report);
  if (context.rejection) json["rejection"] = Rejection(*context.rejection);
  json["history"] = History(report);
  json["options"] = Object(report.options);
  json["provenance"] = Object(report.provenance);
  return JsonText(json, 2) + "\n";
}

}  // namespace graticule
