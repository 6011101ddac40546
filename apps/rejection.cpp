#include "rejection.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "console.hpp"

namespace graticule::apps {
namespace {

constexpr std::size_t kPrinted = 10;

}  // namespace

RejectionSummary Summarise(const Graph& graph, const RejectionReport& rejection) {
  RejectionSummary summary;
  summary.method = ToString(rejection.method);
  summary.suspects = rejection.suspects.size();
  summary.trusted = rejection.factors - summary.suspects;
  summary.suspect_sources = rejection.suspect_sources;
  summary.inlier_quantile = rejection.inlier_quantile;
  summary.inlier_noise_scale = rejection.inlier_noise_scale;
  summary.seconds = rejection.seconds;
  for (const RejectionReport::Factor& rejected : rejection.rejected) {
    const FactorView factor = graph.FactorAt(rejected.id);
    RejectedFactor row;
    row.id = rejected.id;
    row.type = factor.type->name;
    row.source = factor.source;
    for (const VariableId id : factor.variables) row.keys.push_back(graph.KeyOf(id));
    row.chi2 = rejected.chi2;
    row.limit = rejected.limit;
    summary.rejected.push_back(std::move(row));
  }
  return summary;
}

void PrintRejection(const RejectionSummary& rejection) {
  std::string sources;
  for (const auto& [source, count] : rejection.suspect_sources)
    sources += fmt::format("{}{} {}", sources.empty() ? "" : ", ", count,
                           source.empty() ? "without a source" : source);
  fmt::print("  suspect    {} of {} factors ({}); the others are trusted\n", rejection.suspects,
             rejection.suspects + rejection.trusted, sources);
  fmt::print("  rejected   {} by {} in {}: {} the {} quantile", rejection.rejected.size(),
             rejection.method, Seconds(rejection.seconds),
             rejection.method == ToString(Rejection::kPcm)
                 ? "not in the largest sets that agree pair by pair within"
                 : "chi2 beyond",
             rejection.inlier_quantile);
  if (rejection.inlier_noise_scale != 1)
    fmt::print(", noise times {:.3g}", rejection.inlier_noise_scale);
  fmt::print("\n");
  for (std::size_t i = 0; i < std::min(kPrinted, rejection.rejected.size()); ++i) {
    const RejectedFactor& factor = rejection.rejected[i];
    std::string keys;
    for (std::size_t k = 0; k < std::min<std::size_t>(factor.keys.size(), 4); ++k)
      keys += " " + factor.keys[k].ToString();
    fmt::print("             {:<10.4g} {}{}{}{}\n", factor.chi2, factor.type, keys,
               factor.keys.size() > 4 ? " ..." : "",
               factor.source.empty() ? "" : ", " + factor.source);
  }
  if (rejection.rejected.size() > kPrinted)
    fmt::print("             ... and {} more, all of them in --json and --report\n",
               rejection.rejected.size() - kPrinted);
}

}  // namespace graticule::apps
