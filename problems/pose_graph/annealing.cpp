#include "graticule/problems/pose_graph/annealing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/pose_graph/chordal.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"

namespace graticule {
namespace {

// What counts less than this does not count: the noise must stay a number.
constexpr double kLeastWeight = 1e-12;
// Rounds at the end are over when the cost changes less than this, relatively.
constexpr double kSettled = 1e-6;
// Where a truncated surrogate is as good as the robust cost itself: weights other than 0 and 1 are
// left for chi2 within 1 % of the limit only.
constexpr double kLastMu = 100;
// What has not settled by then will not.
constexpr int kLastRounds = 60;

}  // namespace

struct Annealing::State {
  const std::vector<double>& limits;
  const Values& odometry;
  Values values;
  std::vector<double> ratio, weights;  // of each suspect: chi2 over limit, and how much it counts
  std::size_t rounds = 0;
  bool was_cancelled = false;

  State(const std::vector<double>& l, const Values& o)
      : limits(l), odometry(o), values(o), ratio(l.size()), weights(l.size(), 1) {}
};

Annealing::Annealing(const Graph& graph, const std::vector<FactorId>& suspects,
                     const AnnealingOptions& options, const Observer& watch)
    : suspects_(suspects),
      options_(options),
      watch_(watch),
      copier_(graph),
      trusted_(copier_.Variables()),
      doubted_(copier_.Variables()) {
  std::vector<bool> is_suspect(graph.FactorCount());
  for (const FactorId id : suspects) is_suspect[id] = true;
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    if (!is_suspect[id]) copier_.Copy(id, 1, graph.FactorAt(id).loss, &trusted_);
  for (const FactorId id : suspects) copier_.Copy(id, 1, Loss{}, &doubted_);
  if (!options.solve.loss.empty())
    trusted_.SetLosses(MakeLoss(options.solve.loss, options.solve.loss_scale));
  options_.solve.loss.clear();
  options_.solve.allow_pieces = true;
  options_.solve.max_iterations = options.inner_iterations;
  options_.solve.time_limit_s = 0;
  time_limit_s_ = options.solve.time_limit_s;
  for (const FactorType& type : graph.UsedFactorTypes())
    relaxes_ |= PoseRoleOf(type.name) == PoseRole::kBetween;
}

AnnealingResult Annealing::FromLeastSquares(const std::vector<double>& limits,
                                            const Values& odometry) {
  State state(limits, odometry);
  relaxes_ ? Relax(&state) : static_cast<void>(Solve(&state));
  return Run(&state, FirstMu(state));
}

AnnealingResult Annealing::FromTrusted(const std::vector<double>& limits, const Values& odometry) {
  State state(limits, odometry);
  state.ratio = Chi2(odometry);
  for (std::size_t i = 0; i < limits.size(); ++i) state.ratio[i] /= limits[i];
  return Run(&state, FirstMu(state));
}

AnnealingResult Annealing::FromInliers(const std::vector<double>& limits, const Values& odometry,
                                       const std::vector<bool>& inliers, double mu) {
  State state(limits, odometry);
  for (std::size_t i = 0; i < limits.size(); ++i) state.weights[i] = inliers[i];
  relaxes_ ? Relax(&state) : static_cast<void>(Solve(&state));
  return Run(&state, mu);
}

// Yang et al., remarks 5 and 6: the surrogate is convex for the worst suspect.
double Annealing::FirstMu(const State& state) const {
  double worst = 1;
  for (const double ratio : state.ratio)
    if (ratio > worst) worst = ratio;
  if (!std::isfinite(worst)) worst = 1e12;
  return options_.cost == RobustCost::kTruncated ? 1 / (2 * worst - 1) : 2 * worst;
}

// Yang et al., equations 12 and 14.  Returns how many weights are neither 0 nor 1.
std::size_t Annealing::WeighAll(double mu, State* state) const {
  std::size_t between = 0;
  for (std::size_t i = 0; i < state->ratio.size(); ++i) {
    const double s = state->ratio[i];
    double weight = 0;
    if (!(s < std::numeric_limits<double>::infinity())) {
      weight = 0;
    } else if (options_.cost == RobustCost::kTruncated) {
      weight = s <= mu / (mu + 1) ? 1 : s >= (mu + 1) / mu ? 0 : std::sqrt(mu * (mu + 1) / s) - mu;
    } else {
      weight = mu / (s + mu) * (mu / (s + mu));
    }
    state->weights[i] = weight;
    between += weight != 0 && weight != 1;
  }
  return between;
}

Graph Annealing::Weighted(const State& state) {
  Graph weighted = trusted_;
  for (std::size_t i = 0; i < suspects_.size(); ++i)
    if (state.weights[i] > kLeastWeight)
      copier_.Copy(suspects_[i], state.weights[i], Loss{}, &weighted);
  return weighted;
}

double Annealing::Solve(State* state) {
  Graph weighted = Weighted(*state);
  weighted.SetValues(state->values);
  Solution solution = graticule::Solve(weighted, options_.solve);
  state->values = std::move(solution.values);
  state->ratio = Chi2(state->values);
  for (std::size_t i = 0; i < state->ratio.size(); ++i) state->ratio[i] /= state->limits[i];
  return solution.report.final_objective;
}

void Annealing::Relax(State* state) {
  state->values = state->odometry;
  PlaceByChordal(Weighted(*state), &state->values);
  state->ratio = Chi2(state->values);
  for (std::size_t i = 0; i < state->ratio.size(); ++i) state->ratio[i] /= state->limits[i];
}

AnnealingResult Annealing::Run(State* state, double mu) {
  const bool truncated = options_.cost == RobustCost::kTruncated;
  const auto go_on = [&] {
    mu = truncated ? mu * options_.step : std::max(1.0, mu / options_.step);
    Iteration row;
    row.number = static_cast<int>(++rounds_);
    row.objective = TruncatedCost(*state);
    row.seconds = clock_.Elapsed().wall;
    state->was_cancelled = (watch_.on_iteration && !watch_.on_iteration(row)) ||
                           (time_limit_s_ > 0 && row.seconds > time_limit_s_);
    return ++state->rounds < static_cast<std::size_t>(options_.max_rounds) && !state->was_cancelled;
  };
  std::vector<double> before;
  bool relax = relaxes_;
  while (relax) {
    before = state->weights;
    const bool binary = WeighAll(mu, state) == 0;
    if (truncated ? (binary && state->weights == before) || mu > kLastMu : mu <= 1) break;
    Relax(state);
    relax = go_on();
  }
  double cost_before = -1;
  for (int last = 0; last < kLastRounds; ++last) {
    const bool at_end = WeighAll(mu, state) == 0 || (!truncated && mu <= 1);
    const double cost = Solve(state);
    if (at_end && std::abs(cost - cost_before) <= kSettled * cost) break;
    if (!std::isfinite(cost)) break;
    cost_before = cost;
    if (state->was_cancelled || !go_on()) break;
  }
  return Finish(state);
}

double Annealing::TruncatedCost(const State& state) const {
  double cost = 0;
  for (const double chi2 : FactorChi2(trusted_, state.values)) cost += 0.5 * chi2;
  for (std::size_t i = 0; i < state.ratio.size(); ++i)
    cost += 0.5 * state.limits[i] * (state.ratio[i] <= 1 ? state.ratio[i] : 1);
  return cost;
}

AnnealingResult Annealing::Finish(State* state) const {
  AnnealingResult result;
  result.rounds = state->rounds;
  result.was_cancelled = state->was_cancelled;
  result.truncated_cost = TruncatedCost(*state);
  for (std::size_t i = 0; i < state->ratio.size(); ++i) {
    result.chi2.push_back(state->ratio[i] * state->limits[i]);
    result.is_inlier.push_back(state->ratio[i] <= 1);
  }
  result.values = std::move(state->values);
  return result;
}

}  // namespace graticule
