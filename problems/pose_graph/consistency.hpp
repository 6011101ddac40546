#pragma once

#include <cstddef>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// The largest group of closures that is compared pair by pair: a bit and a test a pair.
constexpr std::size_t kMostConsistent = 20000;

struct ConsistencyOptions {
  /// A pair agrees below this quantile of the chi-square distribution.
  double quantile = 0.99;
  /// By which the noise's standard deviations are multiplied first.
  double noise_scale = 1;
  /// Only closures between trees of odometry, as the paper has it; those within one are all kept.
  bool only_between_trees = false;
  /// Larger groups are thinned to this many, evenly; what is left out is not kept.  0: none is.
  std::size_t thin_to = 0;
};

struct ConsistencyResult {
  std::vector<bool> is_kept;  ///< by suspect
  std::size_t groups = 0;     ///< of closures that join the same trees
  std::size_t unproven = 0;   ///< groups whose set may not be the largest: the search was cut short
  std::size_t unchecked = 0;  ///< suspects that are kept because they cannot be compared
  std::size_t trees = 0;      ///< of trusted odometry
};

/// Pairwise consistency maximisation (Mangelson, Dominic, Eustice, Vasudevan: Pairwise consistent
/// measurement set maximization for robust multi-robot map merging, ICRA 2018).  Two closures
/// between the same two trees of trusted odometry make a loop with the odometry between their ends;
/// they are consistent where the loop's error is small against its covariance (squared Mahalanobis
/// distance).  Of each group of closures that join the same trees (of those within one tree too,
/// unless options say otherwise) the largest pairwise consistent set is kept.
///
/// A suspect is not compared and kept where it is not between two poses or does not say all of a
/// pose.  Time in proportion to the pairs, and the search for the set (FindLargestClique).
/// Throws Error (kUsage): a group of more than kMostConsistent.
ConsistencyResult FindConsistent(const Graph& graph, const std::vector<FactorId>& suspects,
                                 const ConsistencyOptions& options = {});

/// By variable: the tree of trusted factors between poses that a pose is in; -1 for other
/// variables.
std::vector<int> OdometryTrees(const Graph& graph, const std::vector<FactorId>& suspects);

}  // namespace graticule
