#include "graticule/problems/mapping/mission_replay.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

MissionReplay::MissionReplay(const Mission& mission, double every_s)
    : mission_(mission), every_s_(every_s), online_(mission.graph.Types()) {
  if (!(every_s > 0)) throw Error("expected a time above 0 from graph to graph", ErrorKind::kUsage);
  const Graph& graph = mission.graph;
  const std::size_t count = mission.nodes.size();
  node_of_.assign(graph.VariableCount(), count);
  for (std::size_t i = 0; i < count; ++i) node_of_[mission.nodes[i].variable] = i;
  online_of_.assign(graph.VariableCount(), 0);
  comes_with_.resize(count);
  others_with_.resize(count);
  std::vector<char> is_known(graph.VariableCount(), 0);
  for (FactorId id = 0; id < graph.FactorCount() && count > 0; ++id) {
    std::size_t last = 0;
    for (const VariableId variable : graph.VariablesOf(id))
      if (node_of_[variable] < count) last = std::max(last, node_of_[variable]);
    comes_with_[last].push_back(id);
  }
  // What is no node (a landmark) comes with its first factor.
  for (std::size_t i = 0; i < count; ++i)
    for (const FactorId id : comes_with_[i])
      for (const VariableId variable : graph.VariablesOf(id))
        if (node_of_[variable] == count && !is_known[variable]) {
          is_known[variable] = 1;
          others_with_[i].push_back(variable);
        }
}

// From the latest node that a factor ties it to, where that is now.
std::vector<double> MissionReplay::GuessOf(std::size_t node) const {
  const VariableId variable = mission_.nodes[node].variable;
  const Graph& graph = mission_.graph;
  std::vector<double> guess(graph.ValueOf(variable).begin(), graph.ValueOf(variable).end());
  std::size_t latest = node;
  for (const FactorId id : comes_with_[node]) {
    const FactorView factor = graph.FactorAt(id);
    if (factor.variables.size() != 2 || factor.measurement.size() != 3) continue;
    const bool forward = factor.variables[1] == variable;
    const std::size_t other = node_of_[factor.variables[forward ? 0 : 1]];
    if (other >= node || (latest < node && other < latest)) continue;
    latest = other;
    double a_from_b[3];
    if (forward)
      CopyPose(true, factor.measurement.data(), a_from_b);
    else
      Invert(true, factor.measurement.data(), a_from_b);
    Compose(true, current_.data() + 3 * other, a_from_b, guess.data());
  }
  return guess;
}

void MissionReplay::Enter(std::size_t node) {
  const Graph& graph = mission_.graph;
  const VariableId variable = mission_.nodes[node].variable;
  const std::vector<double> guess = GuessOf(node);
  current_.insert(current_.end(), guess.begin(), guess.end());
  online_of_[variable] = online_.Add(graph.KeyOf(variable), graph.TypeOf(variable).name, guess,
                                     graph.IsFixed(variable));
  for (const VariableId other : others_with_[node])
    online_of_[other] = online_.Add(graph.KeyOf(other), graph.TypeOf(other).name,
                                    {graph.ValueOf(other).begin(), graph.ValueOf(other).end()},
                                    graph.IsFixed(other));
  for (const FactorId id : comes_with_[node]) online_.Add(graph.FactorRecord(id));
}

bool MissionReplay::Next(MissionStep* step) {
  const std::size_t count = mission_.nodes.size();
  if (entered_ == count) return false;
  const double begin = mission_.TimeOf(mission_.nodes.front());
  // The first multiple of the period at which something more has come.
  const double next = mission_.TimeOf(mission_.nodes[entered_]);
  const double multiple = std::max(1.0, std::ceil((next - begin) / every_s_));
  // At that itself, where the multiple is rounded to less.
  const double end = std::max(begin + every_s_ * multiple, next);
  while (entered_ < count && mission_.TimeOf(mission_.nodes[entered_]) <= end) Enter(entered_++);
  entered_ == count ? online_.UpdateExactly() : online_.Update();
  const auto latest = online_.Latest();
  step->time = end;
  step->nodes = entered_;
  step->world_from_robot.clear();
  for (std::size_t i = 0; i < entered_; ++i) {
    const double* value = (*latest)[online_of_[mission_.nodes[i].variable]].data();
    std::copy_n(value, 3, current_.data() + 3 * i);
    step->world_from_robot.push_back({value[0], value[1], value[2]});
  }
  return true;
}

}  // namespace graticule
