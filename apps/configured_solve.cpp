#include "configured_solve.hpp"

#include "graticule/problems/pose_graph/initialise_and_solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule::apps {
namespace {

SecondLookSummary Summarise(const SecondLook& look) {
  const auto solve = [](const StartedSolve& solve) {
    return SecondLookSummary::Solve{ToString(solve.start), ToString(solve.termination),
                                    solve.objective, solve.seconds, solve.iterations};
  };
  SecondLookSummary summary;
  summary.text = look.summary;
  summary.reduced_chi2 = look.reduced_chi2;
  summary.first = solve(look.first);
  if (look.certificate) summary.verdict = ToString(look.certificate->verdict);
  summary.certificate_seconds = look.certificate_seconds;
  if (look.second) summary.second = solve(*look.second);
  summary.improved = look.improved;
  summary.was_stopped = look.was_stopped;
  return summary;
}

ConfiguredSolution SolveAll(Graph* graph, bool file_has_guess, const Configuration& configuration,
                            const Observer& watch) {
  PoseGraphSolution solved = InitialiseAndSolve(graph, configuration.initialise.initialise,
                                                file_has_guess, configuration.solve, watch);
  ConfiguredSolution result;
  result.solution = std::move(solved.solution);
  result.initialisation = solved.start.summary;
  result.start_label = ToString(solved.start.used);
  result.initialise = solved.initialise;
  if (solved.second_look) result.second_look = Summarise(*solved.second_look);
  return result;
}

ConfiguredSolution SolveTrusted(Graph* graph, bool file_has_guess,
                                const Configuration& configuration, const Observer& watch) {
  ConfiguredSolution result;
  Stopwatch clock;
  const bool from_values = configuration.initialise.initialise != InitialGuess::kAutomatic;
  if (from_values) {
    const InitialiseReport start =
        Initialise(graph, configuration.initialise.initialise, file_has_guess, watch);
    result.initialisation = start.summary;
    result.start_label = ToString(start.used);
  } else {
    result.initialisation = "trusted factors";
    result.start_label = result.initialisation;
  }
  result.initialise = clock.Lap();
  RobustSolution robust = SolveWithoutOutliers(*graph, configuration.rejection, configuration.solve,
                                               watch, from_values);
  result.solution = std::move(robust.solution);
  result.rejection = std::move(robust.rejection);
  result.is_kept = std::move(robust.is_kept);
  graph->SetValues(robust.start);
  std::vector<std::string>& warnings = result.solution.report.warnings;
  warnings.insert(warnings.end(), result.rejection.warnings.begin(),
                  result.rejection.warnings.end());
  return result;
}

}  // namespace

ConfiguredSolution SolveAsConfigured(Graph* graph, bool file_has_guess,
                                     const Configuration& configuration, const Observer& watch) {
  const bool rejects = configuration.rejection.reject_outliers != Rejection::kNone;
  return (rejects ? SolveTrusted : SolveAll)(graph, file_has_guess, configuration, watch);
}

Graph AsSolved(const Graph& graph, const SolveOptions& options) {
  Graph asked = graph;
  if (!options.loss.empty()) asked.SetLosses(MakeLoss(options.loss, options.loss_scale));
  return asked;
}

}  // namespace graticule::apps
