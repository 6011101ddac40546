#pragma once

#include <functional>

#include "graticule/problems/pose_graph/certify_matrix.hpp"

namespace graticule {

struct DescentOptions {
  int max_steps = 100;
  /// Ends where the next step promises less.
  double tolerance = 0;
  /// Or after a step that brings less than this part of the value.
  double least_drop = 0;
  /// To begin with, relative to the Hessian's diagonal; 0: Newton's steps towards a smaller
  /// gradient, ended by the first that fails.
  double damping = 0;
  /// Asked after each step, with the quadratic's value; false ends.
  std::function<bool(double)> go_on;
};

struct Descent {
  double drop = 0;      ///< of the quadratic's value
  double promised = 0;  ///< by the step that was not taken any more
  int steps = 0;
  bool converged = false;
};

/// Minimises a quadratic over poses of any number of rows, R' R = 1: damped Newton steps with the
/// true (Riemannian) Hessian, tr(V S V') over tangents V, factorised by CHOLMOD; back onto the
/// manifold by the polar factor.  After P.-A. Absil, R. Mahony, R. Sepulchre, "Optimization
/// Algorithms on Matrix Manifolds" (2008).
template <int kDim>
Descent Descend(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                const DescentOptions& options, Poses<kDim>* poses);

}  // namespace graticule
