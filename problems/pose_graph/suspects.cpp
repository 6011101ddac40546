#include "graticule/problems/pose_graph/suspects.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

void Check(const Graph& graph, const SuspectOptions& options) {
  std::set<std::string_view> sources;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) sources.insert(graph.FactorAt(id).source);
  const std::vector<std::string_view> known(sources.begin(), sources.end());
  for (const auto* list : {&options.trust, &options.suspect})
    for (const std::string& name : *list) {
      if (sources.count(name)) continue;
      std::string all;
      for (const std::string_view source : known)
        if (!source.empty()) all += (all.empty() ? "" : ", ") + std::string(source);
      throw Error("no factor has the source '" + name.substr(0, 60) + "'" +
                      DidYouMean(name, known) + "; there are " + (all.empty() ? "none" : all),
                  ErrorKind::kUsage);
    }
  for (const std::string& name : options.trust)
    if (std::find(options.suspect.begin(), options.suspect.end(), name) != options.suspect.end())
      throw Error("the source '" + name + "' cannot be both trusted and suspect",
                  ErrorKind::kUsage);
}

}  // namespace

bool IsOdometry(const Graph& graph, const FactorView& factor) {
  if (!factor.source.empty()) return factor.source == "odometry";
  const Key& a = graph.KeyOf(factor.variables[0]);
  const Key& b = graph.KeyOf(factor.variables[1]);
  return a.Family() == b.Family() && (a.Number() + 1 == b.Number() || b.Number() + 1 == a.Number());
}

std::vector<FactorId> ChooseSuspects(const Graph& graph, const SuspectOptions& options) {
  Check(graph, options);
  const auto named = [](const std::vector<std::string>& list, std::string_view source) {
    return std::find(list.begin(), list.end(), source) != list.end();
  };
  std::vector<bool> is_between;
  for (const FactorType& type : graph.UsedFactorTypes())
    is_between.push_back(PoseRoleOf(type.name) == PoseRole::kBetween);
  std::vector<FactorId> suspects;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    if (named(options.trust, factor.source)) continue;
    if (named(options.suspect, factor.source) ||
        (is_between[graph.FactorTypeIndex(id)] && !IsOdometry(graph, factor)))
      suspects.push_back(id);
  }
  return suspects;
}

}  // namespace graticule
