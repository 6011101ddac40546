#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/problems/subgraph.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {

/// The robust cost that graduated non-convexity ends at, of a factor with chi2 s and limit c^2.
enum class RobustCost : std::uint8_t {
  kTruncated,     ///< min(s, c^2): a factor counts whole, or not at all
  kGemanMcClure,  ///< s c^2 / (s + c^2): the less the more it disagrees, never not at all
};

struct AnnealingOptions {
  RobustCost cost = RobustCost::kTruncated;
  double step = 1.4;         ///< how much less convex each round is than the one before
  int inner_iterations = 2;  ///< the solver's steps in a round
  int max_rounds = 200;
  /// How rounds are solved.  Its loss replaces those of the factors that are not suspects; its time
  /// limit is for all rounds together.
  SolveOptions solve;
};

struct AnnealingResult {
  Values values;
  std::vector<double> chi2;     ///< of each suspect, at the values
  std::vector<bool> is_inlier;  ///< chi2 within its limit
  /// 0.5 sum of the trusted factors' chi2 and of the suspects' min(chi2, limit): what tells the
  /// better of two answers, whatever the robust cost.  Trusted factors without their losses.
  double truncated_cost = 0;
  std::size_t rounds = 0;
  bool was_cancelled = false;
};

/// Graduated non-convexity (Yang, Antonante, Tzoumas, Carlone: Graduated non-convexity for robust
/// spatial perception, RA-L 2020): weighted least squares, reweighted each round by a surrogate
/// that begins convex and ends at the robust cost.  Suspects are reweighted, each against its limit
/// (the chi2 up to which it is an inlier); all other factors count whole.
///
/// The method asks for a solver that finds the least of each round wherever it begins.  Rounds of a
/// graph with factors between poses therefore begin with the chordal relaxation (PlaceByChordal),
/// which does, until the weights settle; from there the solver proper goes on, each round where the
/// last one ended.  Graphs without such factors have the solver only.  A factor of weight 0 is left
/// out of a round, which keeps the system as sparse as what is believed.
class Annealing {
 public:
  /// The graph, the suspects and the observer, which is called after every round, must outlive it.
  Annealing(const Graph& graph, const std::vector<FactorId>& suspects,
            const AnnealingOptions& options, const Observer& watch);

  // Throughout: `limits` by suspect, above 0; `odometry`: values that fit the trusted factors.

  /// From where all suspects count: as the paper has it.
  AnnealingResult FromLeastSquares(const std::vector<double>& limits, const Values& odometry);
  /// From where no suspect counts.
  AnnealingResult FromTrusted(const std::vector<double>& limits, const Values& odometry);
  /// From where these suspects count.  `mu` is where the surrogate begins: 1 is near its end, so
  /// that the inliers are held as they are but for a few.
  AnnealingResult FromInliers(const std::vector<double>& limits, const Values& odometry,
                              const std::vector<bool>& inliers, double mu = 1);

  /// r'Wr of the suspects.
  std::vector<double> Chi2(const Values& values) const { return FactorChi2(doubted_, values); }

 private:
  struct State;
  AnnealingResult Run(State* state, double mu);
  std::size_t WeighAll(double mu, State* state) const;
  double Solve(State* state);
  void Relax(State* state);
  Graph Weighted(const State& state);
  AnnealingResult Finish(State* state) const;
  double TruncatedCost(const State& state) const;
  double FirstMu(const State& state) const;

  const std::vector<FactorId>& suspects_;
  AnnealingOptions options_;
  const Observer& watch_;
  FactorCopier copier_;
  Graph trusted_, doubted_;  // all variables, and the factors of either kind
  bool relaxes_ = false;
  double time_limit_s_ = 0;
  std::size_t rounds_ = 0;  // of all runs
  Stopwatch clock_;
};

}  // namespace graticule
