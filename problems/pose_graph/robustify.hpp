#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/option.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

/// How outliers are found.
enum class Rejection : std::uint8_t {
  kNone,
  kGncTls,  ///< graduated non-convexity, truncated least squares
  kGncGm,   ///< the same, Geman-McClure
  kPcm,     ///< pairwise consistency maximisation
};

struct RejectionOptions {
  Rejection reject_outliers = Rejection::kNone;
  /// A suspect is an inlier where its chi2 is below this quantile of the chi-square distribution.
  double inlier_quantile = 0.99;
  /// By which the noise's standard deviations are multiplied in that test; 0: automatic, the root
  /// of chi2 per degree of freedom of what is kept.
  double inlier_noise_scale = 1;
  std::string trusted_sources;  ///< comma separated, as SuspectOptions::trust
  std::string suspect_sources;  ///< comma separated, as SuspectOptions::suspect
};

/// The one description of RejectionOptions.
const std::vector<OptionRow<RejectionOptions>>& RejectionOptionTable();

/// What was rejected, and how it came about.
struct RejectionReport {
  struct Factor {
    FactorId id = 0;
    double chi2 = 0;   ///< at the solution that does without it
    double limit = 0;  ///< the chi2 up to which it would have been an inlier
  };
  /// One attempt of graduated non-convexity.
  struct Attempt {
    std::string start;
    double truncated_cost = 0;
    std::size_t rejected = 0, rounds = 0;
  };

  Rejection method = Rejection::kNone;
  std::size_t factors = 0;  ///< of the whole graph
  std::vector<FactorId> suspects;
  std::vector<std::pair<std::string, std::size_t>> suspect_sources;  ///< how many of each, by name
  std::vector<Factor> rejected;                                      ///< in the graph's order
  double inlier_quantile = 0, inlier_noise_scale = 1;                ///< as used
  std::vector<Attempt> attempts;  ///< the last of the least cost was taken
  std::size_t rounds = 0;         ///< of all attempts
  /// Trees that trusted factors between poses make: more than one means that suspects say where
  /// robots are to each other.
  std::size_t trees = 0;
  std::size_t groups = 0, unproven = 0, unchecked = 0;  ///< as ConsistencyResult; of kPcm
  std::vector<std::string> warnings;
  double seconds = 0;  ///< wall, of all but the last solve
};

struct RobustSolution {
  Solution solution;  ///< of the graph without the rejected factors
  RejectionReport rejection;
  std::vector<bool> is_kept;  ///< by factor
  Values start;               ///< what the trusted factors say
};

/// Finds factors that are wrong, and solves the graph without them.  The suspects are those of
/// ChooseSuspects; all others are trusted.
///
/// kPcm keeps the largest pairwise consistent sets (FindConsistent), in one solve.
/// kGncTls, kGncGm anneal (Annealing) from several starts, and keep the answer of the least
/// truncated cost: the suspects that agree with the trusted factors alone; least squares over all.
/// Where the two differ: the trusted factors, annealed; the pairwise consistent; and, while work
/// lasts, the best with a rejected suspect counted again, those that disagree least first.  Where
/// trusted factors leave poses in several trees (robots whose starts are unknown to each other),
/// these are first aligned by the closures between them that are pairwise consistent.
///
/// The trusted factors say where to begin, unless `from_values`: then the graph's own values do.
/// Throws Error as Solve and ChooseSuspects do; kUsage where nothing is suspect; kIllPosed where
/// what is kept does not hold the graph together.  Same input, same digits.
RobustSolution SolveWithoutOutliers(const Graph& graph, const RejectionOptions& options,
                                    const SolveOptions& solve = {}, const Observer& watch = {},
                                    bool from_values = false);

/// "gnc_tls".
std::string ToString(Rejection method);

}  // namespace graticule
