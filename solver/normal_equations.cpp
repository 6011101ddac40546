#include "graticule/solver/normal_equations.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

// to += a' b, of matrices with kRows rows, row-major; `to` by columns.  Zeros of b are common (a
// rotation's residual does not depend on translations), and skipped.
template <int kRows, int kA, int kB>
void AddProductOf(const double* a, const double* b, double* to, int stride) {
  for (int j = 0; j < kB; ++j, to += stride) {
    double sum[kA] = {};
    for (int r = 0; r < kRows; ++r) {
      const double factor = b[r * kB + j];
      if (factor == 0) continue;
      for (int i = 0; i < kA; ++i) sum[i] += factor * a[r * kA + i];
    }
    for (int i = 0; i < kA; ++i) to[i] += sum[i];
  }
}

// The rows of a matrix of three by three, each in a register.
struct Rows {
  using Register [[gnu::vector_size(32)]] = double;
  Register row[3];

  explicit Rows(const double* a)
      : row{{a[0], a[1], a[2], 0}, {a[3], a[4], a[5], 0}, {a[6], a[7], a[8], 0}} {}

  // to += the matrix' transpose times x, whose numbers are `step` apart.
  void AddTimes(const double* x, int step, double* to) const {
    const Register sum = x[0] * row[0] + x[step] * row[1] + x[2 * step] * row[2];
    for (int i = 0; i < 3; ++i) to[i] += sum[i];
  }
};

template <>
void AddProductOf<3, 3, 3>(const double* a, const double* b, double* to, int stride) {
  const Rows rows(a);
  for (int j = 0; j < 3; ++j) rows.AddTimes(b + j, 3, to + j * stride);
}

void AddProduct(int rows, int a_size, int b_size, const double* a, const double* b,
                const BlockSystem::Block& to) {
  if (to.transposed) return AddProduct(rows, b_size, a_size, b, a, {to.values, to.stride, false});
  if (rows == 3 && a_size == 3 && b_size == 3)
    return AddProductOf<3, 3, 3>(a, b, to.values, to.stride);
  if (rows == 6 && a_size == 6 && b_size == 6)
    return AddProductOf<6, 6, 6>(a, b, to.values, to.stride);
  for (int r = 0; r < rows; ++r)
    for (int j = 0; j < b_size; ++j) {
      const double factor = b[r * b_size + j];
      for (int i = 0; i < a_size; ++i) to.values[i + j * to.stride] += factor * a[r * a_size + i];
    }
}

}  // namespace

std::size_t NormalEquations::CountPairs(const Graph& graph) {
  std::size_t pairs = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const std::size_t blocks = graph.VariablesOf(id).size();
    pairs += blocks * (blocks - 1) / 2;
  }
  return pairs;
}

NormalEquations::NormalEquations(const Evaluation& evaluation, const std::optional<Loss>& replaced,
                                 const std::vector<char>& is_held, int threads)
    : evaluation_(evaluation), replaced_(replaced) {
  const Graph& graph = evaluation.TheGraph();
  std::vector<int> node_of(graph.VariableCount(), kHeld), sizes;
  for (const VariableId id : graph.KeyOrder()) {
    if (is_held[id] || graph.TypeOf(id).TangentSize() == 0) continue;
    node_of[id] = static_cast<int>(free_.size());
    free_.push_back(id);
    sizes.push_back(graph.TypeOf(id).TangentSize());
  }
  BlockSystem::Links links;
  links.reserve(CountPairs(graph));
  firsts_.reserve(graph.FactorCount());
  links_.reserve(graph.FactorCount());
  std::size_t largest = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const Span<const VariableId> variables = graph.VariablesOf(id);
    firsts_.push_back(nodes_.size());
    links_.push_back(links.size());
    std::size_t columns = 1;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const int node = node_of[variables[i]];
      columns += static_cast<std::size_t>(graph.TypeOf(variables[i]).TangentSize());
      for (std::size_t k = firsts_.back(); k < nodes_.size() && node != kHeld; ++k)
        if (nodes_[k] != kHeld) links.emplace_back(nodes_[k], node);
      nodes_.push_back(node);
    }
    largest = std::max(largest, columns * static_cast<std::size_t>(graph.ResidualSize(id)));
  }
  system_ = std::make_unique<BlockSystem>(std::move(sizes), links);
  gradient_.resize(static_cast<std::size_t>(system_->Size()));
  chi2_.resize(graph.FactorCount());
  scratch_.resize(largest);
  if (threads > 1)
    parallel_ = std::make_unique<ParallelEvaluation>(evaluation,
                                                     ParallelEvaluation::Stride::kTangent, threads);
}

bool NormalEquations::Linearise(const double* data, double* objective) {
  const Graph& graph = evaluation_.TheGraph();
  system_->Clear();
  std::fill(gradient_.begin(), gradient_.end(), 0.0);
  *objective = 0;
  if (parallel_) parallel_->Prepare(data, true);
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  for (FactorId id = 0; id < evaluation_.FactorCount(); ++id) {
    const int rows = graph.ResidualSize(id);
    double* residual = scratch_.data();
    if (parallel_) {
      residual = parallel_->At(id);
      if (!residual) return false;
    } else {
      evaluation_.Blocks(id, data, &blocks);
      jacobians.clear();
      double* next = scratch_.data() + rows;
      const Span<const VariableId> variables = graph.VariablesOf(id);
      for (std::size_t i = 0; i < variables.size(); ++i) {
        jacobians.push_back(nodes_[firsts_[id] + i] == kHeld ? nullptr : next);
        next += rows * graph.TypeOf(variables[i]).TangentSize();
      }
      if (!evaluation_.Whitened(id, blocks.data(), scratch_.data(), jacobians.data(), nullptr))
        return false;
    }
    double chi2 = 0, rho[3];
    for (int r = 0; r < rows; ++r) chi2 += residual[r] * residual[r];
    EvaluateLoss(replaced_.value_or(graph.LossOf(id)), chi2, rho);
    chi2_[id] = chi2;
    *objective += 0.5 * rho[0];
    if (rho[1] != 1) {
      // Both are ours to change: what was evaluated is used once.
      const double weight = std::sqrt(std::max(rho[1], 0.0));
      double* end = residual + rows;
      for (const VariableId variable : graph.VariablesOf(id))
        end += rows * graph.TypeOf(variable).TangentSize();
      for (double* value = residual; value < end; ++value) *value *= weight;
    }
    Add(id, residual, residual + rows);
  }
  return true;
}

void NormalEquations::Add(FactorId id, const double* residual, const double* jacobians) {
  const Graph& graph = evaluation_.TheGraph();
  const int rows = graph.ResidualSize(id);
  const Span<const VariableId> variables = graph.VariablesOf(id);
  const int* nodes = nodes_.data() + firsts_[id];
  std::size_t link = links_[id];
  const double* b = jacobians;
  for (std::size_t j = 0; j < variables.size(); ++j) {
    const int b_size = graph.TypeOf(variables[j]).TangentSize();
    if (nodes[j] != kHeld) {
      const double* a = jacobians;
      for (std::size_t i = 0; i < j; ++i) {
        const int a_size = graph.TypeOf(variables[i]).TangentSize();
        if (nodes[i] != kHeld) AddProduct(rows, a_size, b_size, a, b, system_->LinkBlock(link++));
        a += rows * a_size;
      }
      AddProduct(rows, b_size, b_size, b, b, system_->NodeBlock(nodes[j]));
      double* gradient = gradient_.data() + system_->First(nodes[j]);
      if (rows == 3 && b_size == 3)
        Rows(b).AddTimes(residual, 1, gradient);
      else
        for (int r = 0; r < rows; ++r)
          for (int c = 0; c < b_size; ++c) gradient[c] += residual[r] * b[r * b_size + c];
    }
    b += rows * b_size;
  }
}

bool NormalEquations::Objective(const double* data, double* objective) {
  const Graph& graph = evaluation_.TheGraph();
  *objective = 0;
  double rho[3];
  if (parallel_) parallel_->Prepare(data, false);
  for (FactorId id = 0; id < evaluation_.FactorCount(); ++id) {
    double chi2 = 0;
    if (parallel_) {
      const double* residual = parallel_->At(id);
      if (!residual) return false;
      for (int r = 0; r < graph.ResidualSize(id); ++r) chi2 += residual[r] * residual[r];
    } else {
      chi2 = evaluation_.Chi2(id, data);
      if (std::isnan(chi2)) return false;
    }
    EvaluateLoss(replaced_.value_or(graph.LossOf(id)), chi2, rho);
    *objective += 0.5 * rho[0];
  }
  return true;
}

void NormalEquations::Plus(const double* data, const double* step, double* moved) const {
  const Graph& graph = evaluation_.TheGraph();
  for (std::size_t node = 0; node < free_.size(); ++node) {
    const VariableId id = free_[node];
    const std::size_t offset = graph.Offset(id);
    graph.TypeOf(id).Plus(data + offset, step + system_->First(static_cast<int>(node)),
                          moved + offset);
  }
}

double NormalEquations::Norm(const double* data) const {
  const Graph& graph = evaluation_.TheGraph();
  double sum = 0;
  for (const VariableId id : free_)
    for (int i = 0; i < graph.TypeOf(id).Size(); ++i) {
      const double value = data[graph.Offset(id) + static_cast<std::size_t>(i)];
      sum += value * value;
    }
  return std::sqrt(sum);
}

}  // namespace graticule
