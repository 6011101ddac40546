#pragma once

#include <functional>
#include <map>
#include <vector>

#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/gaussian.hpp"

namespace graticule {

/// A Gaussian over some variables of a graph.
struct GaussianTerm {
  std::vector<VariableId> variables;  ///< sorted
  Gaussian gaussian;
};
/// By a number of its own: later ones have larger ones.
using GaussianTerms = std::map<int, GaussianTerm>;

/// What variables that leave say about those that stay: their factors and terms are linearised at
/// `data`, laid out as the graph's values, and the leaving eliminated by Householder reflections,
/// fewest neighbours first, on rows sorted by where they begin (George, Heath: Solution of sparse
/// linear least squares problems using Givens rotations, 1980), so that neither normal equations
/// nor an undetermined direction cost digits.  Variables that are constant have no part in it.
/// Losses count by their weight there.  What is constant in the cost is dropped.
///
/// Throws Error (kOther) where a factor cannot be evaluated.
std::vector<GaussianTerm> MarginaliseOut(const std::vector<VariableId>& leaving,
                                         const std::vector<FactorId>& factors,
                                         const std::vector<const GaussianTerm*>& terms,
                                         const Evaluation& evaluation, const double* data,
                                         const std::function<bool(VariableId)>& is_constant);

}  // namespace graticule
