#pragma once

#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "graticule/solver/diagnose.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// Covariance blocks of some variables, in their tangent spaces (units of the tangent's fields,
/// body side).
class Marginals {
 public:
  /// Row-major, tangent size of a x tangent size of b.  A fixed or anchored variable has zeros,
  /// the block of a key with itself is symmetric to the last bit.  Throws Error if the pair was not
  /// asked for.
  const std::vector<double>& Covariance(const Key& a, const Key& b) const;
  const std::vector<double>& Covariance(const Key& key) const { return Covariance(key, key); }
  /// What was held fixed to remove the gauge: covariances are relative to these.
  const std::vector<Key>& Anchors() const { return anchors_; }

 private:
  friend std::variant<Marginals, Diagnosis> ComputeMarginals(const Graph&, const Values&,
                                                             const std::vector<Key>&, bool);
  std::map<std::pair<Key, Key>, std::vector<double>> blocks_;
  std::vector<Key> anchors_;
};

/// Marginal covariances of `keys` at `values`: blocks of the inverse of J' J, with J the whitened
/// Jacobian (each factor scaled by the root of its loss' weight).  The losses are the graph's own:
/// after a solve with SolveOptions::loss, Graph::SetLosses puts that one in their place.  With
/// `joint`, also the blocks between the keys.  Where the problem is ill-posed: which keys are
/// loose, along which fields.  Throws Error as Solve does.
std::variant<Marginals, Diagnosis> ComputeMarginals(const Graph& graph, const Values& values,
                                                    const std::vector<Key>& keys,
                                                    bool joint = false);

}  // namespace graticule
