#pragma once

#include <functional>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// Watches a solve.  Called after each iteration, from the thread that called Solve.
struct Observer {
  /// Returns false to stop: the best values so far are the result.
  std::function<bool(const Iteration&)> on_iteration;
};

struct Solution {
  Values values;
  Report report;
};

/// Minimises 0.5 sum rho(r' W r) over the free variables, from the graph's own values.  The graph
/// is not changed: `graph.SetValues(solution.values)` to go on from there.
///
/// Throws Error: kMissingType where a factor's type is not known here; kIllPosed where, with
/// anchor automatic, a variable has no factor, or the graph is in several pieces that nothing holds
/// together; kInput where a factor's data are wrong; kUsage where options do not go together.
/// Everything numerical (no convergence, a factor that returns nan) is in the report.  Same input,
/// same digits.
Solution Solve(const Graph& graph, const SolveOptions& options = {}, const Observer& watch = {});

/// r' W r of every factor at these values (default: the graph's own), by FactorId.  A factor that
/// cannot be evaluated has nan.  Throws Error as Solve does.
std::vector<double> FactorChi2(const Graph& graph, const Values& values);

/// 0.5 sum rho(r' W r), what Solve minimises, at each of several values: cheaper than one by one.
/// nan where a factor cannot be evaluated.  With `only_the_least`, a sum is given up where it
/// passes the least before it: what is returned is then that much of it.  Throws Error as Solve
/// does.
std::vector<double> Objectives(const Graph& graph, const std::vector<const Values*>& values,
                               bool only_the_least = false);

}  // namespace graticule
