#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "graticule/solver/bayes_tree.hpp"
#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/marginalise.hpp"
#include "graticule/solver/online.hpp"
#include "graticule/solver/snapshots.hpp"

namespace graticule {

/// What an Online keeps between calls.
struct Online::Machine {
  /// Whether a factor counts.
  enum Standing : char { kCounts, kRemoved, kMarginalised };

  Graph graph;  // all that was ever added
  OnlineOptions options;
  Evaluation evaluation;
  GaussianTerms terms;  // what marginalised variables said
  BayesTree tree;
  std::vector<double> points;       // where factors are linearised; laid out as the graph's values
  std::vector<double> estimate;     // points plus steps
  std::vector<char> is_held;        // by variable: it is the anchor, or has left
  std::vector<char> has_left;       // by variable
  std::vector<char> standing;       // by factor: a Standing
  std::vector<VariableId> movable;  // taken in, neither fixed nor left
  std::map<std::string, std::deque<VariableId>> by_family;  // taken in and not left, where lagged
  BayesTree::Changes changes;                               // since the last update
  std::vector<VariableId> unpublished;                      // their estimate has changed
  std::size_t absolutes = 0;  // taken in: what says where the graph is
  bool is_whole = true;       // nothing has left or been removed
  bool is_broken = false;     // the tree is to be made anew: between updates, the last failed
  int updates = 0;
  int next_term = 0;
  VariableId variables = 0;  // taken in
  FactorId factors = 0;      // taken in

  Snapshots snapshots;
  mutable std::mutex latest_mutex;  // held for the copy of a pointer only
  std::shared_ptr<const Values> latest;

  Machine(Registry types, OnlineOptions wanted);

  bool HasLeft(VariableId id) const { return id < has_left.size() && has_left[id]; }
  void CheckStays(VariableId id) const;
  Standing StandingOf(FactorId id) const {
    return id < standing.size() ? static_cast<Standing>(standing[id]) : kCounts;
  }

  /// Update, but for publishing.
  void Step(OnlineReport* report);
  void TakeIn(OnlineReport* report);
  void Publish();
  /// The graph of what these two say stays in it, at the estimate.
  template <class KeepsVariable, class KeepsFactor>
  Graph Part(KeepsVariable&& keeps_variable, KeepsFactor&& keeps_factor) const;
  Graph Remaining() const;
  Graph Recorded() const;
  void Freeze(const std::vector<VariableId>& ids);
  void Marginalise(const std::vector<VariableId>& ids);
  void Remove(FactorId id);

 private:
  void FindAbsolutes();
  void ReviewAnchor();
  void MoveTo(VariableId id);
  void Relinearise();
  void StopMoving(const std::vector<VariableId>& ids);
  std::vector<VariableId> Lagging() const;
};

}  // namespace graticule
