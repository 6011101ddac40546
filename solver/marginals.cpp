#include "graticule/solver/marginals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"
#include "graticule/solver/linearise.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/solver/sparse_inverse.hpp"

namespace graticule {
namespace {

// Below this reciprocal condition of the scaled normal matrix its null space is looked at before
// its inverse is believed.
constexpr double kSuspicious = 1e-11;

// From so many columns on, the inverse on the factor's pattern is cheaper than solving for them.
constexpr std::size_t kManyColumns = 128;

// Owns a factor of the column-scaled normal matrix.
class ScaledFactor {
 public:
  ScaledFactor(SparseColumns transposed, bool supernodal) : scale_(transposed.ScaleRows()) {
    if (supernodal) cholmod_()->supernodal = CHOLMOD_SUPERNODAL;
    cholmod_sparse view = transposed.View();
    factor_ = cholmod_analyze(&view, cholmod_());
    is_positive_ = factor_ && cholmod_factorize(&view, factor_, cholmod_()) &&
                   factor_->minor == factor_->n && cholmod_rcond(factor_, cholmod_()) > kSuspicious;
  }
  ~ScaledFactor() {
    if (factor_) cholmod_free_factor(&factor_, cholmod_());
  }
  ScaledFactor(const ScaledFactor&) = delete;
  ScaledFactor& operator=(const ScaledFactor&) = delete;

  bool IsClearlyPositive() const { return is_positive_; }
  bool IsUsable() const { return factor_ && factor_->minor == factor_->n; }

  const cholmod_factor& Factor() const { return *factor_; }
  double Scale(int row) const { return scale_[static_cast<std::size_t>(row)]; }

  // Columns of the inverse normal matrix: result is rows x columns.size(), by columns.
  std::vector<double> InverseColumns(const std::vector<int>& columns) {
    std::vector<double> rhs(scale_.size() * columns.size(), 0.0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto row = static_cast<std::size_t>(columns[c]);
      rhs[c * scale_.size() + row] = scale_[row];
    }
    cholmod_dense b = DenseView(rhs.data(), scale_.size(), columns.size());
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &b, cholmod_());
    if (!x) throw Error("CHOLMOD ran out of memory", ErrorKind::kOther);
    const double* values = static_cast<const double*>(x->x);
    for (std::size_t i = 0; i < rhs.size(); ++i) rhs[i] = values[i] * scale_[i % scale_.size()];
    cholmod_free_dense(&x, cholmod_());
    return rhs;
  }

 private:
  Cholmod cholmod_;
  cholmod_factor* factor_ = nullptr;
  std::vector<double> scale_;
  bool is_positive_ = false;
};

// Each column is solved for by itself: their rounding differs in the last digits.
void MakeSymmetric(std::size_t n, std::vector<double>* block) {
  for (std::size_t r = 0; r < n; ++r)
    for (std::size_t c = 0; c < r; ++c)
      (*block)[r * n + c] = (*block)[c * n + r] = ((*block)[r * n + c] + (*block)[c * n + r]) / 2;
}

// Whether a covariance could be one: of its correlations no eigenvalue is below zero by more than
// rounding.
// `scratch` is for the factor, so that nothing is allocated from block to block.
bool IsCovariance(const std::vector<double>& block, std::size_t size, Eigen::MatrixXd* scratch) {
  const auto n = static_cast<Eigen::Index>(size);
  const Eigen::Map<const Eigen::MatrixXd> covariance(block.data(), n, n);
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0)) return false;
  *scratch = covariance;
  if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(*scratch).info() == Eigen::Success) return true;
  const Eigen::VectorXd inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
  *scratch = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  constexpr double kRounding = 1e-12;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(*scratch, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() > -kRounding;
}

}  // namespace

const std::vector<double>& Marginals::Covariance(const Key& a, const Key& b) const {
  const auto it = blocks_.find({a, b});
  if (it == blocks_.end())
    throw Error("the covariance of " + a.ToString() + " and " + b.ToString() +
                " was not asked for");
  return it->second;
}

std::variant<Marginals, Diagnosis> ComputeMarginals(const Graph& graph, const Values& values,
                                                    const std::vector<Key>& keys, bool joint) {
  graph.CheckLayout(values);
  const NumericGuard guard;
  const Evaluation evaluation(graph);
  const std::vector<VariableId> anchors = ChooseAnchors(graph, AnalyseStructure(graph), false);
  const TangentIndex index(graph, anchors);
  std::vector<VariableId> wanted;
  for (const Key& key : keys) wanted.push_back(graph.IdOf(key));

  Marginals marginals;
  for (const VariableId id : anchors) marginals.anchors_.push_back(graph.KeyOf(id));
  const auto held = [&](VariableId id) { return index.first[id] == TangentIndex::kHeld; };
  const auto size_of = [&](VariableId id) {
    return static_cast<std::size_t>(graph.TypeOf(id).TangentSize());
  };
  for (const VariableId a : wanted)
    for (const VariableId b : joint ? wanted : std::vector<VariableId>{a})
      if (held(a) || held(b))
        marginals.blocks_[{graph.KeyOf(a), graph.KeyOf(b)}].assign(size_of(a) * size_of(b), 0.0);
  if (index.size == 0) return marginals;

  // Solving for columns pays for a few keys, and gives the blocks between them; for many, the
  // entries of the inverse on the factor's pattern cost about two factorisations in all.
  std::size_t columns_wanted = 0;
  for (const VariableId id : wanted) columns_wanted += held(id) ? 0 : size_of(id);
  const bool by_pattern = !joint && columns_wanted > kManyColumns;
  ScaledFactor factor(TransposedJacobian(evaluation, values.Data().data(), index), by_pattern);
  const auto too_ill_conditioned = [](Diagnosis diagnosis) {
    diagnosis.summary =
        "the normal matrix is too ill-conditioned to be inverted in double precision";
    diagnosis.at_least = true;
    return diagnosis;
  };
  if (!factor.IsClearlyPositive()) {
    Diagnosis diagnosis = Diagnose(graph, values, anchors);
    if (diagnosis.free_directions > 0) return diagnosis;
    if (!factor.IsUsable()) return too_ill_conditioned(std::move(diagnosis));
  }

  Eigen::MatrixXd scratch;
  if (by_pattern) {
    const SparseInverse inverse(factor.Factor());
    for (const VariableId id : wanted) {
      if (held(id)) continue;
      const int n = graph.TypeOf(id).TangentSize(), first = index.first[id];
      std::vector<double>& block = marginals.blocks_[{graph.KeyOf(id), graph.KeyOf(id)}];
      block.clear();
      for (int r = 0; r < n; ++r)
        for (int c = 0; c < n; ++c)
          block.push_back(inverse.At(first + r, first + c) * factor.Scale(first + r) *
                          factor.Scale(first + c));
      if (!IsCovariance(block, size_of(id), &scratch)) return too_ill_conditioned({});
    }
    return marginals;
  }

  // Right-hand sides a solve: wide enough for BLAS 3, small in memory.
  constexpr std::size_t kBatch = 64;
  const auto rows = static_cast<std::size_t>(index.size);
  for (std::size_t begin = 0; begin < wanted.size();) {
    std::vector<int> columns;
    std::size_t end = begin;
    for (; end < wanted.size() &&
           (columns.empty() || columns.size() + size_of(wanted[end]) <= kBatch);
         ++end)
      for (std::size_t c = 0; !held(wanted[end]) && c < size_of(wanted[end]); ++c)
        columns.push_back(index.first[wanted[end]] + static_cast<int>(c));
    const std::vector<double> inverse =
        columns.empty() ? std::vector<double>() : factor.InverseColumns(columns);
    std::size_t column = 0;
    for (; begin < end; ++begin) {
      const VariableId b = wanted[begin];
      if (held(b)) continue;
      for (const VariableId a : joint ? wanted : std::vector<VariableId>{b}) {
        if (held(a)) continue;
        std::vector<double>& block = marginals.blocks_[{graph.KeyOf(a), graph.KeyOf(b)}];
        block.resize(size_of(a) * size_of(b));
        for (std::size_t r = 0; r < size_of(a); ++r)
          for (std::size_t c = 0; c < size_of(b); ++c)
            block[r * size_of(b) + c] =
                inverse[(column + c) * rows + static_cast<std::size_t>(index.first[a]) + r];
        if (a != b) continue;
        MakeSymmetric(size_of(b), &block);
        if (!IsCovariance(block, size_of(b), &scratch)) return too_ill_conditioned({});
      }
      column += size_of(b);
    }
  }
  return marginals;
}

}  // namespace graticule
