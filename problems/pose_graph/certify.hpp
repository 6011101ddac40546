#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// What is proved of a solution.
enum class Verdict {
  kOptimal,        ///< no poses have a lower cost, but for the gap
  kBounded,        ///< a lower bound of every cost is proved; the gap to it is not negligible
  kRefused,        ///< the certificate matrix has a negative eigenvalue: not proved
  kNotApplicable,  ///< the graph says something that the certificate does not cover
};

/// A proof, a posteriori, of how far from the global minimum of 0.5 sum r' W r a solution can be at
/// most: of the very cost that Solve minimises, for any information matrices.
struct Certificate {
  Verdict verdict = Verdict::kNotApplicable;
  double cost = 0;         ///< 0.5 sum r' W r at the solution
  double lower_bound = 0;  ///< no values have a lower cost; 0 where nothing better is proved
  double Gap() const { return cost - lower_bound; }
  /// Gap / cost; 0 where the cost is.
  double RelativeGap() const { return cost > 0 ? Gap() / cost : 0; }

  /// Where refused: the smallest eigenvalue of the certificate matrix, relative to the weights on
  /// its diagonal; nan where it is not known, or was not looked for.
  double eigenvalue = 0;
  std::vector<std::string> reasons;  ///< where not applicable: why, with counts
  /// Factors whose stand-in has their value and gradient, of all: the others cost the bound a
  /// little.
  std::size_t exact_factors = 0, factors = 0;
  std::size_t factorisations = 0;  ///< sparse ones, what the time goes into
  std::string summary;             ///< one line for people
};

struct CertifyOptions {
  /// A larger relative gap is kBounded.
  double optimal_gap = 1e-5;
  /// Where refused: look for the smallest eigenvalue, and for what bound is proved all the same.
  bool find_eigenvalue = true;
  /// Asked before each factorisation but the first: false ends with what is proved by then.
  std::function<bool()> go_on;
};

/// Certifies values of a pose graph.  Each factor's cost is bounded from below by a function that
/// is quadratic in positions and rotation matrices and touches it at `values`; Lagrange's dual of
/// these quadratics' sum, with the multipliers that `values` give, is a lower bound of every cost
/// if one sparse matrix is positive semidefinite, which its Cholesky factorisation proves.  The
/// derivation, and what double precision leaves of it, is in docs/certificate.md.
///
/// Covers between, prior, position, landmark and point factors on se2/1 and point2/1, or on se3/1
/// and point3/1, with no loss and information that is positive definite; any number of fixed
/// variables.  Refuses what it cannot prove: that is no proof of the contrary.
///
/// `values` near a minimum: up to three Newton steps of the quadratics bring them to where the
/// dual is best, and are not returned.  One to five factorisations where Solve has converged, nine
/// at the most, beside the search for the eigenvalue.  Deterministic.
/// After L. Carlone, G. Calafiore, C. Tommolillo, F. Dellaert, "Planar pose graph optimization:
/// duality, optimal solutions, and verification" (T-RO 2016), and D. Rosen, L. Carlone, A.
/// Bandeira, J. Leonard, "SE-Sync" (IJRR 2019).
Certificate Certify(const Graph& graph, const Values& values, const CertifyOptions& options = {});

/// "optimal", "bounded", "refused", "not_applicable".
std::string ToString(Verdict verdict);

}  // namespace graticule
