#include "graticule/problems/pose_graph/certify_escape.hpp"

#include <cmath>
#include <utility>

#include "graticule/problems/pose_graph/certify_staircase.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

// Where the staircase leads; `rank` is of what was rounded.
template <int kDim>
Values FromStaircase(const Graph& graph, const Values& values,
                     const std::function<bool(double)>& go_on, int* rank) {
  std::vector<std::string> reasons;
  const Program<kDim> program = ReadProgram<kDim>(graph, &reasons);
  const StaircaseResult<kDim> end = ClimbStaircase(program, program.Read(values), go_on);
  Values placed = values;
  program.Write(end.poses, &placed);
  *rank = end.rank;
  return placed;
}

class Escaping {
 public:
  Escaping(const Graph& graph, const EscapeOptions& options, const Observer& watch, Escape* escape)
      : graph_(graph), options_(options), watch_(watch), escape_(*escape) {}

  // Whether to try more.
  bool IsOpen() const { return !stopped_ && escape_.certificate.verdict == Verdict::kRefused; }

  void FromChordal() {
    const Stopwatch clock;
    Graph again = graph_;
    Initialise(&again, InitialGuess::kChordal, true);
    Try(again, "chordal start", clock);
  }

  void FromEigenvector() {
    const Stopwatch clock;
    Iteration step;
    const auto go_on = [&](double value) {
      ++step.number;
      step.objective = value;
      step.seconds = clock.Elapsed().wall;
      stopped_ = watch_.on_iteration && !watch_.on_iteration(step);
      const double limit = options_.solve.time_limit_s;
      return !stopped_ && !(limit > 0 && step.seconds > limit);
    };
    int rank = 0;
    Graph again = graph_;
    const Values& values = escape_.solution.values;
    again.SetValues(HasPoses(graph_, 2) ? FromStaircase<2>(graph_, values, go_on, &rank)
                                        : FromStaircase<3>(graph_, values, go_on, &rank));
    if (!stopped_) Try(again, "staircase of rank " + std::to_string(rank), clock);
  }

 private:
  void Try(const Graph& start, std::string from, const Stopwatch& clock) {
    EscapeAttempt attempt;
    attempt.from = std::move(from);
    Solution solution = Solve(start, options_.solve, watch_);
    stopped_ = solution.report.termination == Termination::kCancelled;
    attempt.cost = solution.report.final_cost;
    if (solution.report.termination != Termination::kFailed) {
      Certificate certificate = Certify(graph_, solution.values, options_.certify);
      attempt.verdict = certificate.verdict;
      // What differs by less is the same minimum, converged otherwise.
      if (attempt.cost < (1 - 1e-9) * escape_.certificate.cost) {
        escape_.solution = std::move(solution);
        escape_.certificate = std::move(certificate);
        escape_.improved = true;
      }
    }
    attempt.seconds = clock.Elapsed().wall;
    escape_.attempts.push_back(std::move(attempt));
  }

  const Graph& graph_;
  const EscapeOptions& options_;
  const Observer& watch_;
  Escape& escape_;
  bool stopped_ = false;
};

}  // namespace

Escape EscapeMinimum(const Graph& graph, Solution solution, Certificate certificate,
                     const EscapeOptions& options, const Observer& watch) {
  Escape escape;
  escape.solution = std::move(solution);
  escape.certificate = std::move(certificate);
  Escaping escaping(graph, options, watch, &escape);
  if (options.chordal && escaping.IsOpen()) escaping.FromChordal();
  if (options.staircase && escaping.IsOpen()) escaping.FromEigenvector();
  return escape;
}

}  // namespace graticule
