#include "graticule/problems/pose_graph/initialise_and_solve.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "graticule/problems/chi_square.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

// Of all fits that the noise explains, one in a million is taken for one that it does not.
constexpr double kImplausible = 1 - 1e-6;
// What differs by less is the same minimum, converged otherwise.
constexpr double kSame = 1e-9;

bool HasPoses(const Graph& graph) {
  const auto& types = graph.UsedVariableTypes();
  return std::any_of(types.begin(), types.end(), IsPose);
}

bool HasLoss(const Graph& graph) {
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    if (graph.LossOf(id).kind != LossKind::kNone) return true;
  return false;
}

std::string Number(double number, int digits) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.*g", digits, number);
  return text;
}

void Add(const PhaseTime& more, PhaseTime* time) {
  time->wall += more.wall;
  time->cpu += more.cpu;
}

// Where the time of the solve that was not kept went, too.
void Add(const Timing& more, Timing* timing) {
  Add(more.build, &timing->build);
  Add(more.solve, &timing->solve);
  Add(more.total, &timing->total);
  timing->preprocess += more.preprocess;
  timing->evaluate += more.evaluate;
  timing->linear_solve += more.linear_solve;
}

class Solving {
 public:
  Solving(Graph* graph, const SolveOptions& options, const Observer& watch)
      : graph_(*graph), options_(options), watch_(watch) {}

  PoseGraphSolution Run(InitialGuess how, bool file_has_guess) {
    StartAndSolve(how, file_has_guess, &result_, &first_);
    if (how == InitialGuess::kAutomatic && DeservesSecondLook()) LookAgain();
    return std::move(result_);
  }

 private:
  double SecondsLeft() const {
    return options_.time_limit_s > 0 ? options_.time_limit_s - clock_.Elapsed().wall
                                     : std::numeric_limits<double>::infinity();
  }

  void StartAndSolve(InitialGuess how, bool file_has_guess, PoseGraphSolution* to,
                     StartedSolve* what) {
    Stopwatch clock;
    to->start = Initialise(&graph_, how, file_has_guess, Watching());
    to->initialise = clock.Lap();
    SolveOptions options = options_;
    // Where nothing is left, Solve is to end by its limit at once: 0 would be no limit.
    if (options.time_limit_s > 0) options.time_limit_s = std::max(SecondsLeft(), 1e-9);
    to->solution = Solve(graph_, options, watch_);
    if (options.time_limit_s > 0) NameTheWholeLimit(&to->solution.report);
    const Report& report = to->solution.report;
    *what = {to->start.used, report.termination, report.final_objective, report.Steps(),
             to->initialise.wall + clock.Elapsed().wall};
  }

  // What Solve was told is what was left of it.
  void NameTheWholeLimit(Report* report) const {
    const std::string limit = Number(options_.time_limit_s, 6);
    if (report->termination == Termination::kTimeLimit)
      report->message = "the limit of " + limit + " s was reached";
    for (auto& [name, value] : report->options)
      if (name == "time_limit_s") value = limit;
  }

  // The observer, which also stops at the time limit; of updates it sees the best objective so far.
  Observer Watching() const {
    return {[this](const Iteration& row) {
      Iteration seen = row;
      if (result_.second_look) seen.objective = first_.objective;
      return SecondsLeft() > 0 && (!watch_.on_iteration || watch_.on_iteration(seen));
    }};
  }

  bool DeservesSecondLook() const {
    const Report& report = result_.solution.report;
    const double degrees = static_cast<double>(report.degrees_of_freedom);
    if (!(degrees > 0) || !(report.Chi2() > degrees) || !HasPoses(graph_)) return false;
    const bool was_cut_short = report.termination == Termination::kNoConvergence &&
                               options_.max_iterations < SolveOptions().max_iterations;
    if (was_cut_short || (report.termination != Termination::kConverged &&
                          report.termination != Termination::kNoConvergence))
      return false;
    if (options_.loss.empty() ? HasLoss(graph_) : options_.loss != "none") return false;
    return ChiSquareShare(report.Chi2(), degrees) > kImplausible;
  }

  void LookAgain() {
    SecondLook& look = result_.second_look.emplace();
    look.first = first_;
    look.reduced_chi2 = result_.solution.report.ReducedChi2();
    if (SecondsLeft() <= 0) {
      look.was_stopped = true;
    } else {
      if (first_.termination == Termination::kConverged) CertifyFirst(&look);
      if (!look.certificate || look.certificate->verdict != Verdict::kOptimal) SolveAgain(&look);
    }
    look.summary = Summary(look);
  }

  void CertifyFirst(SecondLook* look) {
    const Stopwatch clock;
    CertifyOptions options;
    options.find_eigenvalue = false;
    if (options_.loss.empty()) {
      look->certificate = Certify(graph_, result_.solution.values, options);
    } else {
      Graph asked = graph_;
      asked.SetLosses(Loss());
      look->certificate = Certify(asked, result_.solution.values, options);
    }
    look->certificate_seconds = clock.Elapsed().wall;
  }

  void SolveAgain(SecondLook* look) {
    const Values start = graph_.InitialValues();
    PoseGraphSolution again;
    StartedSolve second;
    StartAndSolve(InitialGuess::kIncremental, false, &again, &second);
    const Termination end = second.termination;
    look->was_stopped = end == Termination::kCancelled || end == Termination::kTimeLimit;
    if (!look->was_stopped || second.iterations > 0) look->second = second;
    look->improved = end != Termination::kFailed &&
                     second.objective < (1 - kSame) * result_.solution.report.final_objective;
    if (look->improved) {
      std::swap(result_.solution, again.solution);
      std::swap(result_.start, again.start);
    } else {
      graph_.SetValues(start);
    }
    Add(again.solution.report.timing, &result_.solution.report.timing);
    Add(again.initialise, &result_.initialise);
  }

  static std::string Ended(const StartedSolve& solve) {
    return ToString(solve.start) +
           (solve.termination == Termination::kConverged ? " ended at " : " stood at ") +
           Number(solve.objective, 9);
  }

  static std::string Summary(const SecondLook& look) {
    std::string text = Ended(look.first) + ", chi2 " + Number(look.reduced_chi2, 4) +
                       " each: more than the noise explains";
    if (look.certificate) {
      const Verdict verdict = look.certificate->verdict;
      if (verdict == Verdict::kOptimal)
        return text + ", but proved optimal, so the noise is stated too small or factors are wrong";
      text += verdict == Verdict::kRefused   ? ", and not proved optimal"
              : verdict == Verdict::kBounded ? ", and proved optimal but for a gap of " +
                                                   Number(look.certificate->RelativeGap(), 2)
                                             : "; no certificate applies";
    }
    if (look.second) text += "; " + Ended(*look.second);
    if (look.was_stopped) text += "; stopped before more was tried";
    return text + (look.improved ? ", and is kept" : "; the first is kept");
  }

  Graph& graph_;
  const SolveOptions& options_;
  const Observer& watch_;
  const Stopwatch clock_;
  PoseGraphSolution result_;
  StartedSolve first_;
};

}  // namespace

PoseGraphSolution InitialiseAndSolve(Graph* graph, InitialGuess how, bool file_has_guess,
                                     const SolveOptions& solve, const Observer& watch) {
  return Solving(graph, solve, watch).Run(how, file_has_guess);
}

}  // namespace graticule
