#include "graticule/solver/parallel_evaluation.hpp"

#include <algorithm>
#include <cstdint>
#include <thread>

#include "graticule/solver/on_threads.hpp"

namespace graticule {

ParallelEvaluation::ParallelEvaluation(const Evaluation& evaluation, Stride stride, int threads)
    : evaluation_(evaluation), stride_(stride) {
  // More threads than cores bring nothing, and too many cannot be made.
  const auto cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  threads_ = std::clamp(threads, 1, 4 * cores);
  const Graph& graph = evaluation.TheGraph();
  std::size_t offset = 0;
  offset_.reserve(evaluation.FactorCount());
  for (FactorId id = 0; id < evaluation.FactorCount(); ++id) {
    offset_.push_back(offset);
    std::size_t columns = 1;
    for (const VariableId variable : graph.FactorAt(id).variables)
      columns += static_cast<std::size_t>(StrideOf(variable));
    offset += columns * static_cast<std::size_t>(graph.ResidualSize(id));
  }
  storage_.resize(offset);
  good_.resize(evaluation.FactorCount());
}

int ParallelEvaluation::StrideOf(VariableId variable) const {
  const VariableType& type = evaluation_.TheGraph().TypeOf(variable);
  return stride_ == Stride::kStored ? type.Size() : type.TangentSize();
}

void ParallelEvaluation::Prepare(const double* data, bool with_jacobians) {
  const auto bound = [&](int thread) {
    return static_cast<FactorId>(std::uint64_t{evaluation_.FactorCount()} *
                                 static_cast<unsigned>(thread) / static_cast<unsigned>(threads_));
  };
  const auto share = [&](int thread) {
    Work(data, bound(thread), bound(thread + 1), with_jacobians);
  };
  OnThreads(threads_, share);
}

bool ParallelEvaluation::Copy(FactorId id, double* residual, double** jacobians) const {
  const double* from = At(id);
  if (!from) return false;
  const Graph& graph = evaluation_.TheGraph();
  const int rows = graph.ResidualSize(id);
  std::copy(from, from + rows, residual);
  if (!jacobians) return true;
  from += rows;
  const Span<const VariableId> variables = graph.FactorAt(id).variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const int size = rows * StrideOf(variables[i]);
    if (jacobians[i]) std::copy(from, from + size, jacobians[i]);
    from += size;
  }
  return true;
}

void ParallelEvaluation::Work(const double* data, FactorId begin, FactorId end,
                              bool with_jacobians) {
  const Graph& graph = evaluation_.TheGraph();
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  std::vector<int> strides;
  for (FactorId id = begin; id < end; ++id) {
    evaluation_.Blocks(id, data, &blocks);
    const int rows = graph.ResidualSize(id);
    double* residual = storage_.data() + offset_[id];
    double* next = residual + rows;
    jacobians.clear();
    strides.clear();
    for (const VariableId variable : graph.FactorAt(id).variables) {
      jacobians.push_back(next);
      strides.push_back(StrideOf(variable));
      next += rows * strides.back();
    }
    good_[id] = evaluation_.Whitened(id, blocks.data(), residual,
                                     with_jacobians ? jacobians.data() : nullptr, strides.data());
  }
}

}  // namespace graticule
