#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// "factor 7 between_se2/1 (pose:1 pose:2)": how errors name it.
std::string Describe(const Graph& graph, FactorId id);

/// A graph made ready to be evaluated: every factor created, its noise turned into a whitening
/// matrix. What the Ceres bridge, marginals, diagnosis and reports share.  The graph must outlive
/// it and stay as it is.
class Evaluation {
 public:
  /// Throws Error: kMissingType where a type is not known here (with the number of factors that
  /// need it), kInput where a factor refuses its data.
  explicit Evaluation(const Graph& graph);
  ~Evaluation();
  /// Takes in what the graph has beyond what was there.  A factor with a mark in `left_out` (by
  /// factor; beyond its end: none) is not created, and must never be evaluated.  Throws as the
  /// constructor; then nothing was taken in.
  void Grow(const std::vector<char>& left_out = {});
  Evaluation(const Evaluation&) = delete;
  Evaluation& operator=(const Evaluation&) = delete;

  const Graph& TheGraph() const { return graph_; }
  std::size_t FactorCount() const { return instances_.size(); }

  /// Whitened residual of a factor and, where `jacobians` and its entries are not null, whitened
  /// Jacobians with respect to each block's tangent: row-major, `strides[i]` numbers from row to
  /// row (at least the tangent size; null: exactly that).  `blocks` are the stored values.  False
  /// where the factor fails or returns something that is not finite; the first failure is kept.
  /// Thread-safe.
  bool Whitened(FactorId id, const double* const* blocks, double* residual, double** jacobians,
                const int* strides) const;

  /// The residual as the factor states it, in its units; Jacobians likewise, packed.
  bool Raw(FactorId id, const double* const* blocks, double* residual, double** jacobians) const;

  /// Pointers to a factor's blocks inside a buffer laid out as the graph's values.
  void Blocks(FactorId id, const double* data, std::vector<const double*>* blocks) const;

  /// r' W r; nan where it cannot be evaluated.
  double Chi2(FactorId id, const double* data) const;

  /// Which factor failed first, with its keys and reason; "" if none did.
  std::string FirstFailure() const;
  /// The same, and forgets it: what fails next is the first again.
  std::string TakeFailure() const;

 private:
  struct Instance {
    const graticule_factor_type_v1* table = nullptr;
    void* self = nullptr;
    std::uint32_t noise = 0;
    bool is_plain = false;  // its Jacobians are those of the tangent, as it writes them
    bool is_gaussian = false;
  };
  bool EvaluateGaussian(FactorId id, const double* const* blocks, double* residual,
                        double** jacobians, const int* strides, bool whiten) const;
  bool EvaluatePlain(FactorId id, const double* const* blocks, double* residual, double** jacobians,
                     bool whiten) const;
  bool Evaluate(FactorId id, const double* const* blocks, double* residual, double** jacobians,
                const int* strides, bool whiten) const;
  void Destroy(std::size_t from);
  bool Fail(FactorId id, const std::string& why) const;

  const Graph& graph_;
  std::vector<Instance> instances_;
  std::vector<Whitener> whiteners_;  // by noise id
  VariableId variables_ = 0;         // known to be of known types
  mutable std::mutex failure_mutex_;
  static constexpr FactorId kNone = 0xffffffffu;
  mutable FactorId failed_ = kNone;
  mutable std::string failure_;
};

}  // namespace graticule
