#pragma once

// Graphs that grow: what the tests of Online share.

#include <algorithm>
#include <vector>

#include "graticule/solver/online.hpp"
#include "graticule/solver/solve.hpp"
#include "problems.hpp"

namespace graticule::testing {

/// Every update is a Gauss-Newton step of the whole problem.
inline OnlineOptions WithoutShortCuts() {
  OnlineOptions options;
  options.relinearise_above = 0;
  options.relinearise_every = 1;
  options.propagate_above = 0;
  return options;
}

inline Numbers ValueOf(const Graph& graph, VariableId id) {
  return {graph.ValueOf(id).begin(), graph.ValueOf(id).end()};
}

/// The minimum to the last digits.  Solve cannot tell values that are 1e-8 apart, for their costs
/// are the same number: dense Gauss-Newton steps, made of nothing of the solver's own, end it.
inline Values Minimum(const Graph& graph) {
  Values values = Solve(graph).values;
  for (int i = 0; i < 4; ++i) {
    const Dense dense = Linearise(graph, values, {});
    const Eigen::VectorXd step = dense.jacobian.householderQr().solve(-dense.residual);
    const Values from = values;
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      if (dense.first[id] >= 0)
        graph.TypeOf(id).Plus(from[id].data(), step.data() + dense.first[id], values.Mutable(id));
  }
  return values;
}

/// A variable at a time, with every factor that it completes.
template <class AfterEach>
void Replay(const Graph& graph, Online* online, AfterEach&& after_each) {
  std::vector<std::vector<FactorId>> arrivals(graph.VariableCount());
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    VariableId last = 0;
    for (const VariableId variable : graph.VariablesOf(id)) last = std::max(last, variable);
    arrivals[last].push_back(id);
  }
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    online->Add(graph.KeyOf(id), graph.TypeOf(id).name, ValueOf(graph, id), graph.IsFixed(id));
    for (const FactorId factor : arrivals[id]) online->Add(graph.FactorRecord(factor));
    after_each(id, online->Update());
  }
}

inline void Replay(const Graph& graph, Online* online) {
  Replay(graph, online, [](VariableId, const OnlineReport&) {});
}

inline double ObjectiveOf(const Graph& graph, const Values& values) {
  return Objectives(graph, {&values})[0];
}

/// Chords across a loop, so that the tree branches.
inline Graph WithChords(Graph graph, bool planar) {
  const auto count = static_cast<unsigned>(graph.VariableCount());
  for (unsigned i = 0; i < count; i += 3) {
    const unsigned j = (i * 7 + 11) % count;
    if (i == j) continue;
    const Numbers a = Circle(count)[i], b = Circle(count)[j];
    if (planar)
      graph.Add(BetweenSe2Factor(Key("pose", i), Key("pose", j), Relative(a, b),
                                 Noise::Sigmas({0.2, 0.2, 0.1}), "loop"));
  }
  return graph;
}

}  // namespace graticule::testing
