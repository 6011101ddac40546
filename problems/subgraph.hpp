#pragma once

#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// Copies factors of one graph into others that begin with all its variables and no factor.  The
/// graph must outlive it and stay as it is; every type must be known or declared there.
class FactorCopier {
 public:
  explicit FactorCopier(const Graph& graph);

  /// A graph with all the variables, in the same order, and no factor.
  const Graph& Variables() const { return variables_; }
  /// Adds a factor to a copy of Variables(): with its noise's information times `weight` (above 0),
  /// and this loss.
  void Copy(FactorId id, double weight, const Loss& loss, Graph* to);

 private:
  const Graph& graph_;
  Graph variables_;
  std::vector<Graph::TypeId> types_;
  std::vector<double> scaled_;
};

/// The graph with those factors only for which `keep` is true; all variables stay.
Graph KeepFactors(const Graph& graph, const std::vector<bool>& keep);

}  // namespace graticule
