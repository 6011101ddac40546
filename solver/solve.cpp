#include "graticule/solver/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "graticule/solver/ceres_bridge.hpp"
#include "graticule/solver/diagnose.hpp"
#include "graticule/solver/direct_minimiser.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/normal_equations.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/solver/provenance.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

constexpr std::size_t kWorst = 5;

std::vector<double> AllChi2(const Evaluation& evaluation, const double* data) {
  std::vector<double> chi2(evaluation.FactorCount());
  for (FactorId id = 0; id < chi2.size(); ++id) chi2[id] = evaluation.Chi2(id, data);
  return chi2;
}

// Sums in the order of the factors: the same digits every time.
void AddCosts(const Graph& graph, const std::vector<double>& initial,
              const std::vector<double>& final, Report* report) {
  // Views of names that the graph owns.
  using Name = std::pair<std::string_view, std::string_view>;
  std::map<Name, std::size_t> rows;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const Name name(factor.type->name, factor.source);
    const auto [row, is_new] = rows.emplace(name, report->shares.size());
    if (is_new) {
      report->shares.emplace_back();
      report->shares.back().type = factor.type->name;
      report->shares.back().source = factor.source;
    }
    CostShare& share = report->shares[row->second];
    ++share.factors;
    share.residuals += static_cast<std::size_t>(graph.ResidualSize(id));
    share.initial_cost += 0.5 * initial[id];
    share.final_cost += 0.5 * final[id];
    report->initial_cost += 0.5 * initial[id];
    report->final_cost += 0.5 * final[id];
    report->residuals += static_cast<std::size_t>(graph.ResidualSize(id));
  }
}

void AddWorst(const Graph& graph, const std::vector<double>& chi2,
              const std::optional<Loss>& replaced, Report* report) {
  std::vector<FactorId> order(chi2.size());
  for (FactorId id = 0; id < order.size(); ++id) order[id] = id;
  const auto worse = [&](FactorId a, FactorId b) {
    const double x = std::isnan(chi2[a]) ? HUGE_VAL : chi2[a],
                 y = std::isnan(chi2[b]) ? HUGE_VAL : chi2[b];
    return x != y ? x > y : a < b;
  };
  const std::size_t count = std::min(kWorst, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    worse);
  for (std::size_t i = 0; i < count; ++i) {
    const FactorView factor = graph.FactorAt(order[i]);
    WorstFactor worst;
    worst.id = order[i];
    worst.type = factor.type->name;
    worst.source = factor.source;
    for (const VariableId variable : factor.variables) worst.keys.push_back(graph.KeyOf(variable));
    worst.chi2 = chi2[order[i]];
    worst.residuals = graph.ResidualSize(order[i]);
    double rho[3];
    EvaluateLoss(replaced.value_or(factor.loss), worst.chi2, rho);
    worst.weight = rho[1];
    report->worst.push_back(std::move(worst));
  }
}

void WarnOfStarved(const Graph& graph, const Structure& structure, Report* report) {
  if (structure.starved.empty()) return;
  std::string text = std::to_string(structure.starved.size()) +
                     (structure.starved.size() == 1 ? " variable has" : " variables have") +
                     " fewer residuals than degrees of freedom:";
  for (std::size_t i = 0; i < std::min<std::size_t>(structure.starved.size(), 5); ++i)
    text += " " + graph.KeyOf(structure.starved[i]).ToString();
  report->warnings.push_back(text + (structure.starved.size() > 5 ? " ..." : ""));
}

// Whether our own minimiser takes the steps.  Throws Error (kUsage) where it is asked for what it
// does not do.
bool IsDirect(const Graph& graph, const SolveOptions& options, const std::vector<char>& is_held) {
  if (options.engine == Engine::kDirect) {
    if (DirectMinimiser::Serves(options)) return true;
    throw Error(
        "these options do not go together: engine direct takes levenberg_marquardt or "
        "gauss_newton steps by sparse_normal_cholesky with suite_sparse, and none that raise the "
        "objective",
        ErrorKind::kUsage);
  }
  // Factors of many variables would make a plan larger than the problem.
  constexpr std::size_t kPairsAFactor = 10;
  return options.engine == Engine::kAutomatic && DirectMinimiser::Serves(options) &&
         NormalEquations::CountPairs(graph) <= kPairsAFactor * graph.FactorCount() &&
         !(options.linear_solver == LinearSolver::kAutomatic &&
           CeresBridge::EliminationPays(graph, is_held));
}

// Ceres calls it convergence where no step is to be had: where all is held, or the gradient
// vanishes beside the cost.
void RefuseInfinite(const Graph& graph, const std::vector<double>& final, Report* report) {
  if (report->termination == Termination::kFailed ||
      (std::isfinite(report->final_objective) && std::isfinite(report->final_cost)))
    return;
  report->termination = Termination::kFailed;
  report->message = "the cost is too large for a number";
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    if (!std::isfinite(final[id])) {
      report->message += ": " + Describe(graph, id);
      return;
    }
}

}  // namespace

Solution Solve(const Graph& graph, const SolveOptions& options, const Observer& watch) {
  const NumericGuard guard;
  const Stopwatch total;
  Stopwatch clock;
  Solution solution;
  Report& report = solution.report;

  std::optional<Loss> replaced;
  if (!options.loss.empty()) replaced = MakeLoss(options.loss, options.loss_scale);
  const Structure structure = AnalyseStructure(graph);
  const Evaluation evaluation(graph);
  std::vector<VariableId> held;
  if (options.anchor == Anchoring::kAutomatic)
    held = ChooseAnchors(graph, structure, options.allow_pieces);
  for (const VariableId id : held) report.anchors.push_back(graph.KeyOf(id).ToString());
  WarnOfStarved(graph, structure, &report);

  std::vector<char> is_held(graph.VariableCount(), 0);
  for (const VariableId id : held) is_held[id] = 1;
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    if (graph.IsFixed(id)) is_held[id] = 1;

  solution.values = graph.InitialValues();
  std::vector<double>* data = &solution.values.MutableData();
  std::vector<double> initial, final;
  if (IsDirect(graph, options, is_held)) {
    DirectMinimiser minimiser(evaluation, options, replaced, is_held, data);
    report.timing.build = clock.Lap();
    minimiser.Run(watch, &report);
    initial = minimiser.TakeInitialChi2();
    final = minimiser.TakeFinalChi2();
  } else {
    CeresBridge bridge(evaluation, options, replaced, is_held, data);
    report.timing.build = clock.Lap();
    initial = AllChi2(evaluation, data->data());
    bridge.Run(watch, &report);
  }
  if (report.termination == Termination::kFailed && !evaluation.FirstFailure().empty())
    report.message = evaluation.FirstFailure();
  if (initial.empty()) initial = AllChi2(evaluation, graph.InitialValues().Data().data());
  if (final.empty()) final = AllChi2(evaluation, solution.values.Data().data());
  AddCosts(graph, initial, final, &report);
  RefuseInfinite(graph, final, &report);
  AddWorst(graph, final, replaced, &report);
  report.variables = graph.VariableCount();
  report.factors = graph.FactorCount();
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    report.fixed_variables += graph.IsFixed(id);
  report.degrees_of_freedom =
      static_cast<long long>(report.residuals) - static_cast<long long>(report.parameters);
  report.threads = options.threads;
  for (const auto& row : SolveOptionTable())
    report.options.emplace_back(row.name, row.get(options));
  report.provenance = Provenance();
  report.timing.solve = clock.Elapsed();
  report.timing.total = total.Elapsed();
  return solution;
}

std::vector<double> FactorChi2(const Graph& graph, const Values& values) {
  graph.CheckLayout(values);
  const Evaluation evaluation(graph);
  return AllChi2(evaluation, values.Data().data());
}

std::vector<double> Objectives(const Graph& graph, const std::vector<const Values*>& values,
                               bool only_the_least) {
  for (const Values* candidate : values) graph.CheckLayout(*candidate);
  const Evaluation evaluation(graph);
  std::vector<double> objectives;
  double enough = std::numeric_limits<double>::infinity();
  for (const Values* candidate : values) {
    double objective = 0, rho[3];
    for (FactorId id = 0; id < graph.FactorCount(); ++id) {
      EvaluateLoss(graph.LossOf(id), evaluation.Chi2(id, candidate->Data().data()), rho);
      objective += 0.5 * rho[0];
      if (objective > enough) break;
    }
    if (only_the_least && objective < enough) enough = objective;
    objectives.push_back(objective);
  }
  return objectives;
}

}  // namespace graticule
