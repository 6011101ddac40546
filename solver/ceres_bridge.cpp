#include "graticule/solver/ceres_bridge.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <limits>
#include <map>

#include "graticule/solver/error.hpp"
#include "graticule/solver/parallel_evaluation.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

class TangentManifold final : public ceres::Manifold {
 public:
  explicit TangentManifold(const VariableType& type) : type_(type) {}
  int AmbientSize() const override { return type_.Size(); }
  int TangentSize() const override { return type_.TangentSize(); }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    type_.Plus(x, delta, x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Identity(jacobian, AmbientSize(), TangentSize());
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    type_.Minus(y, x, y_minus_x);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Identity(jacobian, TangentSize(), AmbientSize());
    return true;
  }

 private:
  static void Identity(double* matrix, int rows, int columns) {
    std::fill(matrix, matrix + rows * columns, 0.0);
    for (int i = 0; i < std::min(rows, columns); ++i) matrix[i * columns + i] = 1;
  }
  const VariableType& type_;
};

class BridgeLoss final : public ceres::LossFunction {
 public:
  explicit BridgeLoss(const Loss& loss) : loss_(loss) {}
  void Evaluate(double s, double rho[3]) const override {
    EvaluateLoss(loss_, s, rho);
    if (std::isnan(rho[2])) rho[2] = 0;  // of an infinite s: Ceres would end the process
  }

 private:
  Loss loss_;
};

// Has the factors evaluated by several threads before Ceres asks for them.
class EvaluateBeforehand final : public ceres::EvaluationCallback {
 public:
  EvaluateBeforehand(ParallelEvaluation* evaluation, const double* data)
      : evaluation_(evaluation), data_(data) {}
  void PrepareForEvaluation(bool with_jacobians, bool) override {
    evaluation_->Prepare(data_, with_jacobians);
  }

 private:
  ParallelEvaluation* evaluation_;
  const double* data_;
};

class BridgeCost final : public ceres::CostFunction {
 public:
  void Bind(const Evaluation* evaluation, const ParallelEvaluation* prepared, FactorId id) {
    evaluation_ = evaluation;
    prepared_ = prepared;
    id_ = id;
    const Graph& graph = evaluation->TheGraph();
    const FactorView factor = graph.FactorAt(id);
    auto* sizes = mutable_parameter_block_sizes();
    sizes->reserve(factor.variables.size());
    for (const VariableId variable : factor.variables)
      sizes->push_back(graph.TypeOf(variable).Size());
    set_num_residuals(graph.ResidualSize(id));
  }

  bool Evaluate(double const* const* blocks, double* residual, double** jacobians) const override {
    const int* sizes = parameter_block_sizes().data();
    if (prepared_) return prepared_->Copy(id_, residual, jacobians);
    return evaluation_->Whitened(id_, blocks, residual, jacobians, sizes);
  }

 private:
  const Evaluation* evaluation_ = nullptr;
  const ParallelEvaluation* prepared_ = nullptr;
  FactorId id_ = 0;
};

class Watcher final : public ceres::IterationCallback {
 public:
  Watcher(const Observer& watch, std::vector<Iteration>* iterations)
      : watch_(watch), iterations_(iterations) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    Iteration row;
    row.number = step.iteration;
    row.accepted = step.step_is_successful;
    row.objective = step.cost;
    row.objective_change = step.cost_change;
    row.gradient_max_norm = step.gradient_max_norm;
    row.step_norm = step.step_norm;
    row.trust_region_radius = step.trust_region_radius;
    row.linear_iterations = step.linear_solver_iterations;
    row.seconds = clock_.Elapsed().wall;
    iterations_->push_back(row);
    const bool go_on = !watch_.on_iteration || watch_.on_iteration(row);
    return go_on ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const Observer& watch_;
  std::vector<Iteration>* iterations_;
  Stopwatch clock_;
};

ceres::LinearSolverType ToCeres(LinearSolver solver) {
  switch (solver) {
    case LinearSolver::kAutomatic:
    case LinearSolver::kSparseNormalCholesky:
      return ceres::SPARSE_NORMAL_CHOLESKY;
    case LinearSolver::kDenseNormalCholesky:
      return ceres::DENSE_NORMAL_CHOLESKY;
    case LinearSolver::kDenseQr:
      return ceres::DENSE_QR;
    case LinearSolver::kCgnr:
      return ceres::CGNR;
    case LinearSolver::kDenseSchur:
      return ceres::DENSE_SCHUR;
    case LinearSolver::kSparseSchur:
      return ceres::SPARSE_SCHUR;
    case LinearSolver::kIterativeSchur:
      return ceres::ITERATIVE_SCHUR;
  }
  return ceres::SPARSE_NORMAL_CHOLESKY;
}

constexpr std::size_t kWidePairs = 64;  // of variables a factor, on average

bool IsSchur(ceres::LinearSolverType type) {
  return type == ceres::DENSE_SCHUR || type == ceres::SPARSE_SCHUR ||
         type == ceres::ITERATIVE_SCHUR;
}

// The variable type whose elimination leaves the smallest system: no factor touches two of it.
struct Elimination {
  int type = -1;                         // index into the graph's types; -1: none
  std::size_t eliminated = 0, kept = 0;  // tangent sizes

  bool Pays() const { return type >= 0 && eliminated >= 4 * kept; }
};

Elimination FindElimination(const Graph& graph, const std::vector<char>& is_held) {
  const std::size_t types = graph.UsedVariableTypes().size();
  std::vector<std::size_t> sizes(types, 0);
  std::size_t all = 0;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    if (is_held[id]) continue;
    sizes[graph.VariableTypeIndex(id)] += static_cast<std::size_t>(graph.TypeOf(id).TangentSize());
    all += static_cast<std::size_t>(graph.TypeOf(id).TangentSize());
  }
  // By factor type: how often each variable type stands in its schema.
  std::vector<bool> independent(types, true);
  for (const FactorType& type : graph.UsedFactorTypes()) {
    std::map<std::string, int> count;
    for (const Block& block : type.schema.blocks) ++count[block.variable_type];
    if (type.schema.repeats_last_block) ++count[type.schema.blocks.back().variable_type];
    for (std::size_t t = 0; t < types; ++t)
      if (count[graph.UsedVariableTypes()[t].name] > 1 || count[kAnyVariable] > 0)
        independent[t] = false;
  }
  Elimination best;
  for (std::size_t t = 0; t < types; ++t)
    if (independent[t] && sizes[t] > best.eliminated)
      best = {static_cast<int>(t), sizes[t], all - sizes[t]};
  if (best.kept == 0) best.type = -1;
  return best;
}

Termination ToTermination(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE:
      return Termination::kConverged;
    case ceres::NO_CONVERGENCE:
      return summary.message.find("time") != std::string::npos ? Termination::kTimeLimit
                                                               : Termination::kNoConvergence;
    case ceres::USER_SUCCESS:
    case ceres::USER_FAILURE:
      return Termination::kCancelled;
    case ceres::FAILURE:
      break;
  }
  return Termination::kFailed;
}

}  // namespace

struct CeresBridge::Machine {
  const Evaluation& evaluation;
  ceres::Solver::Options options;
  std::vector<std::unique_ptr<TangentManifold>> manifolds;
  std::map<std::pair<LossKind, double>, std::unique_ptr<BridgeLoss>> losses;
  std::vector<BridgeCost> costs;
  std::unique_ptr<ParallelEvaluation> parallel;  // null with one thread
  std::unique_ptr<EvaluateBeforehand> beforehand;
  std::unique_ptr<ceres::Problem> problem;
  std::size_t parameters = 0;

  explicit Machine(const Evaluation& e) : evaluation(e), costs(e.FactorCount()) {}
};

bool CeresBridge::EliminationPays(const Graph& graph, const std::vector<char>& is_held) {
  return FindElimination(graph, is_held).Pays();
}

CeresBridge::CeresBridge(const Evaluation& evaluation, const SolveOptions& options,
                         const std::optional<Loss>& replaced, const std::vector<char>& is_held,
                         std::vector<double>* data)
    : machine_(std::make_unique<Machine>(evaluation)) {
  Machine& m = *machine_;
  const Graph& graph = evaluation.TheGraph();
  if (options.threads > 1) {
    m.parallel = std::make_unique<ParallelEvaluation>(
        evaluation, ParallelEvaluation::Stride::kStored, options.threads);
    m.beforehand = std::make_unique<EvaluateBeforehand>(m.parallel.get(), data->data());
  }

  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;  // Graph::Add has made them
  problem_options.evaluation_callback = m.beforehand.get();
  m.problem = std::make_unique<ceres::Problem>(problem_options);

  for (const VariableType& type : graph.UsedVariableTypes())
    m.manifolds.push_back(type.manifold ? std::make_unique<TangentManifold>(type) : nullptr);

  // In key order, so that the result does not depend on the order in which a graph was put
  // together.
  for (const VariableId id : graph.KeyOrder()) {
    double* block = data->data() + graph.Offset(id);
    ceres::Manifold* manifold = m.manifolds[graph.VariableTypeIndex(id)].get();
    m.problem->AddParameterBlock(block, graph.TypeOf(id).Size(), manifold);
    if (is_held[id]) {
      m.problem->SetParameterBlockConstant(block);
    } else {
      m.parameters += static_cast<std::size_t>(graph.TypeOf(id).TangentSize());
    }
  }
  std::vector<double*> blocks;
  std::size_t pairs = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    m.costs[id].Bind(&evaluation, m.parallel.get(), id);
    const FactorView factor = graph.FactorAt(id);
    pairs += factor.variables.size() * factor.variables.size();
    blocks.clear();
    for (const VariableId variable : factor.variables)
      blocks.push_back(data->data() + graph.Offset(variable));
    ceres::LossFunction* loss = nullptr;
    if (const Loss wanted = replaced.value_or(factor.loss); wanted.kind != LossKind::kNone) {
      auto& slot = m.losses[{wanted.kind, wanted.scale}];
      if (!slot) slot = std::make_unique<BridgeLoss>(wanted);
      loss = slot.get();
    }
    m.problem->AddResidualBlock(&m.costs[id], loss, blocks);
  }

  ceres::Solver::Options& o = m.options;
  o.minimizer_type = ceres::TRUST_REGION;
  o.logging_type = ceres::SILENT;
  o.num_threads = 1;
  const bool dogleg =
      options.method == Method::kDogleg || options.method == Method::kSubspaceDogleg;
  o.trust_region_strategy_type = dogleg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  o.dogleg_type = options.method == Method::kSubspaceDogleg ? ceres::SUBSPACE_DOGLEG
                                                            : ceres::TRADITIONAL_DOGLEG;
  o.linear_solver_type = ToCeres(options.linear_solver);
  o.sparse_linear_algebra_library_type = options.linear_algebra == LinearAlgebra::kSuiteSparse
                                             ? ceres::SUITE_SPARSE
                                             : ceres::EIGEN_SPARSE;
  o.preconditioner_type = options.preconditioner == Preconditioner::kIdentity ? ceres::IDENTITY
                          : options.preconditioner == Preconditioner::kSchurJacobi
                              ? ceres::SCHUR_JACOBI
                              : ceres::JACOBI;
  o.max_num_iterations = options.max_iterations;
  o.function_tolerance = options.function_tolerance;
  o.gradient_tolerance = options.gradient_tolerance;
  o.parameter_tolerance = options.parameter_tolerance;
  o.initial_trust_region_radius = options.initial_trust_region_radius;
  o.max_trust_region_radius = options.max_trust_region_radius;
  if (options.method == Method::kGaussNewton) {
    o.initial_trust_region_radius = o.max_trust_region_radius = 1e32;  // damping below rounding
    o.min_lm_diagonal = std::numeric_limits<double>::min();
  }
  o.max_trust_region_radius = std::max(o.max_trust_region_radius, o.initial_trust_region_radius);
  o.max_linear_solver_iterations = options.max_linear_iterations;
  o.min_linear_solver_iterations = 0;
  o.jacobi_scaling = options.jacobi_scaling;
  o.use_nonmonotonic_steps = options.nonmonotonic_steps;
  if (options.time_limit_s > 0) o.max_solver_time_in_seconds = options.time_limit_s;

  const Elimination elimination = FindElimination(graph, is_held);
  // Points seen by few cameras: elimination pays when it removes most of the unknowns, and what is
  // left is small enough for a dense matrix up to about fifty cameras.
  if (options.linear_solver == LinearSolver::kAutomatic && !dogleg && elimination.Pays())
    o.linear_solver_type = elimination.kept <= 500 ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  if (IsSchur(o.linear_solver_type) && elimination.type >= 0) {
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      ordering->AddElementToGroup(data->data() + graph.Offset(id),
                                  graph.VariableTypeIndex(id) == elimination.type ? 0 : 1);
    o.linear_solver_ordering = ordering;
  }
  // Ceres sorts all pairs of blocks that a row has before it multiplies them; where rows are wide,
  // CHOLMOD is faster with the rows themselves.
  o.dynamic_sparsity = o.linear_solver_type == ceres::SPARSE_NORMAL_CHOLESKY &&
                       o.sparse_linear_algebra_library_type == ceres::SUITE_SPARSE &&
                       pairs > kWidePairs * graph.FactorCount();
  std::string why;
  bool is_valid = o.IsValid(&why);
  if (o.linear_solver_type == ceres::CGNR && o.preconditioner_type == ceres::SCHUR_JACOBI) {
    is_valid = false;  // Ceres 2.1 lets it pass and then ends the process
    why = "the preconditioner schur_jacobi is for iterative_schur";
  }
  if (!is_valid) throw Error("these options do not go together: " + why, ErrorKind::kUsage);
}

CeresBridge::~CeresBridge() = default;

void CeresBridge::Run(const Observer& watch, Report* report) {
  Machine& m = *machine_;
  Watcher watcher(watch, &report->iterations);
  m.options.callbacks = {&watcher};
  ceres::Solver::Summary summary;
  ceres::Solve(m.options, m.problem.get(), &summary);
  report->termination = ToTermination(summary);
  report->message = summary.message;
  report->parameters = m.parameters;
  report->initial_objective = summary.initial_cost;
  report->final_objective = summary.final_cost;
  if (report->termination == Termination::kFailed && report->iterations.empty())
    report->initial_objective = report->final_objective = std::numeric_limits<double>::quiet_NaN();
  report->timing.preprocess = summary.preprocessor_time_in_seconds;
  report->timing.evaluate =
      summary.residual_evaluation_time_in_seconds + summary.jacobian_evaluation_time_in_seconds;
  report->timing.linear_solve = summary.linear_solver_time_in_seconds;
  report->linear_solver = ceres::LinearSolverTypeToString(summary.linear_solver_type_used);
  std::transform(report->linear_solver.begin(), report->linear_solver.end(),
                 report->linear_solver.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (report->linear_solver.find("sparse") != std::string::npos)
    report->linear_solver += m.options.sparse_linear_algebra_library_type == ceres::SUITE_SPARSE
                                 ? " (suite_sparse)"
                                 : " (eigen_sparse)";
}

std::string CeresVersion() { return CERES_VERSION_STRING; }

}  // namespace graticule
