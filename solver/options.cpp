#include "graticule/solver/options.hpp"

namespace graticule {
namespace {

std::vector<OptionRow<SolveOptions>> MakeTable() {
  using O = SolveOptions;
  std::string losses;
  for (const std::string_view name : LossNames()) losses += " | " + std::string(name);
  return {
      ChoiceOption("engine", &O::engine,
                   {{"automatic", Engine::kAutomatic},
                    {"ceres", Engine::kCeres},
                    {"direct", Engine::kDirect}},
                   "who takes the steps: Ceres, or the same Levenberg-Marquardt on block normal "
                   "equations in place; automatic: direct where its kind of steps is asked for, "
                   "and no elimination of points pays"),
      ChoiceOption("method", &O::method,
                   {{"levenberg_marquardt", Method::kLevenbergMarquardt},
                    {"gauss_newton", Method::kGaussNewton},
                    {"dogleg", Method::kDogleg},
                    {"subspace_dogleg", Method::kSubspaceDogleg}},
                   "how steps are chosen; gauss_newton is undamped, and still refuses steps that "
                   "raise the cost"),
      ChoiceOption("linear_solver", &O::linear_solver,
                   {{"automatic", LinearSolver::kAutomatic},
                    {"sparse_normal_cholesky", LinearSolver::kSparseNormalCholesky},
                    {"dense_normal_cholesky", LinearSolver::kDenseNormalCholesky},
                    {"dense_qr", LinearSolver::kDenseQr},
                    {"cgnr", LinearSolver::kCgnr},
                    {"dense_schur", LinearSolver::kDenseSchur},
                    {"sparse_schur", LinearSolver::kSparseSchur},
                    {"iterative_schur", LinearSolver::kIterativeSchur}},
                   "how the linear system of a step is solved; automatic: by the problem's shape"),
      ChoiceOption("linear_algebra", &O::linear_algebra,
                   {{"suite_sparse", LinearAlgebra::kSuiteSparse},
                    {"eigen_sparse", LinearAlgebra::kEigenSparse}},
                   "sparse factorisation: CHOLMOD (parts are GPL), or Eigen's (MPL2, slower)"),
      ChoiceOption("preconditioner", &O::preconditioner,
                   {{"identity", Preconditioner::kIdentity},
                    {"jacobi", Preconditioner::kJacobi},
                    {"schur_jacobi", Preconditioner::kSchurJacobi}},
                   "for cgnr and iterative_schur"),
      IntegerOption("max_iterations", &O::max_iterations, 0, "steps tried, accepted or not"),
      NumberOption("function_tolerance", &O::function_tolerance, false,
                   "stop when a step changes the objective by less than this, relatively"),
      NumberOption("gradient_tolerance", &O::gradient_tolerance, false,
                   "stop when no component of the gradient is larger"),
      NumberOption("parameter_tolerance", &O::parameter_tolerance, false,
                   "stop when a step is shorter than this, relative to the values"),
      NumberOption("initial_trust_region_radius", &O::initial_trust_region_radius, true,
                   "large: the first steps are Gauss-Newton's, damping begins where one fails"),
      NumberOption("max_trust_region_radius", &O::max_trust_region_radius, true,
                   "the radius never grows beyond"),
      IntegerOption("max_linear_iterations", &O::max_linear_iterations, 1,
                    "for cgnr and iterative_schur"),
      SwitchOption("jacobi_scaling", &O::jacobi_scaling, "scale the columns of the Jacobian"),
      SwitchOption("reuse_factorisation", &O::reuse_factorisation,
                   "direct: where the objective falls quickly, solve for a step with the "
                   "factorisation of the step before"),
      SwitchOption("nonmonotonic_steps", &O::nonmonotonic_steps,
                   "allow up to five steps that raise the objective"),
      NumberOption("time_limit_s", &O::time_limit_s, false, "seconds; 0: no limit"),
      IntegerOption("threads", &O::threads, 1,
                    "threads that evaluate factors; results do not depend on it"),
      ChoiceOption("anchor", &O::anchor,
                   {{"automatic", Anchoring::kAutomatic}, {"none", Anchoring::kNone}},
                   "automatic: where nothing but relative factors hold a graph, its first pose is "
                   "held fixed"),
      SwitchOption("allow_pieces", &O::allow_pieces,
                   "solve a graph in several loose pieces, each anchored"),
      {"loss", "keep" + losses, "replaces the loss of every factor; keep: as recorded",
       [](const O& options) { return options.loss.empty() ? "keep" : options.loss; },
       [](O& options, std::string_view text) {
         for (const std::string_view name : LossNames()) {
           if (name != text) continue;
           options.loss = text;
           return true;
         }
         options.loss.clear();
         return text == "keep";
       }},
      NumberOption("loss_scale", &O::loss_scale, true,
                   "whitened residual norm where `loss` leaves the parabola"),
  };
}

}  // namespace

const std::vector<OptionRow<SolveOptions>>& SolveOptionTable() {
  static const std::vector<OptionRow<SolveOptions>> kTable = MakeTable();
  return kTable;
}

}  // namespace graticule
