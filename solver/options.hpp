#pragma once

#include <string>
#include <vector>

#include "graticule/solver/loss.hpp"
#include "graticule/solver/option.hpp"

namespace graticule {

enum class Engine { kAutomatic, kCeres, kDirect };
enum class Method { kLevenbergMarquardt, kGaussNewton, kDogleg, kSubspaceDogleg };
enum class LinearSolver {
  kAutomatic,
  kSparseNormalCholesky,
  kDenseNormalCholesky,
  kDenseQr,
  kCgnr,
  kDenseSchur,
  kSparseSchur,
  kIterativeSchur
};
enum class LinearAlgebra { kSuiteSparse, kEigenSparse };
enum class Preconditioner { kIdentity, kJacobi, kSchurJacobi };
enum class Anchoring { kAutomatic, kNone };

/// How to solve; never what.  SolveOptionTable() describes each member, and is what files, flags
/// and docs read.
struct SolveOptions {
  Engine engine = Engine::kAutomatic;
  Method method = Method::kLevenbergMarquardt;
  LinearSolver linear_solver = LinearSolver::kAutomatic;
  LinearAlgebra linear_algebra = LinearAlgebra::kSuiteSparse;
  Preconditioner preconditioner = Preconditioner::kJacobi;
  int max_iterations = 100;
  double function_tolerance = 1e-9;
  double gradient_tolerance = 1e-12;
  double parameter_tolerance = 1e-12;
  /// Large: Levenberg-Marquardt then begins as Gauss-Newton and damps only where a step fails.
  double initial_trust_region_radius = 1e16;
  double max_trust_region_radius = 1e32;
  int max_linear_iterations = 500;
  bool jacobi_scaling = true;
  bool reuse_factorisation = true;
  bool nonmonotonic_steps = false;
  double time_limit_s = 0;  ///< 0: none
  int threads = 1;
  Anchoring anchor = Anchoring::kAutomatic;
  bool allow_pieces = false;
  /// If set ("none", "huber", ...), replaces the loss of every factor (with `loss_scale`).
  std::string loss;
  double loss_scale = 1;
};

/// The one description of SolveOptions.
const std::vector<OptionRow<SolveOptions>>& SolveOptionTable();

}  // namespace graticule
