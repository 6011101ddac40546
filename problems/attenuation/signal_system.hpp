#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/problems/attenuation/signal_rows.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"

namespace graticule {

/// One row as it counts: its weight and what its terms should add up to.
struct SignalEquation {
  double log_distance;
  double target_dbm;
  double weight;                       ///< relative to one measurement's noise
  std::int32_t receiver, transmitter;  ///< unknowns of their biases; 0 with `bias_sign` 0: none
  std::size_t first, size;
};

/// The model's rows, smoothness and priors as one symmetric positive-definite system N x = b, which
/// is never formed: it is multiplied with row by row.  Noise of one measurement counts as 1.
///
/// Unknowns: L0, a, biases, then the cells in their numbers' order.
class SignalSystem {
 public:
  /// Sixteen right-hand sides at once.
  using Lanes = Eigen::Array<float, 16, 1>;

  explicit SignalSystem(const TomographyOptions& options) : options_(options) {}

  /// Takes the rows as they are now.  `correlation` as in TomographyOptions; `now_s` for
  /// forgetting.
  void Set(const SignalRows& rows, double sigma_db, double correlation, double now_s);
  /// Weights and targets may be changed, then Prepare must be called.
  std::vector<SignalEquation>& Equations() { return equations_; }
  const std::vector<SignalEquation>& Equations() const { return equations_; }
  /// The diagonal, and the right-hand side, of the equations as they are.
  void Prepare();

  std::size_t HeadSize() const { return head_; }
  std::size_t Size() const { return head_ + (rows_ ? rows_->Cells().Count() : 0); }
  /// Unknowns of a radio's bias, as listener and as sender; below zero: none.
  static std::int32_t ReceiverBias(RadioBias kind, std::uint32_t radio);
  static std::int32_t TransmitterBias(RadioBias kind, std::uint32_t radio);
  static std::size_t HeadSize(RadioBias kind, std::uint32_t radios);

  /// What is believed before measurements, and its weight.
  double PriorMean(std::size_t unknown) const;
  double PriorWeight(std::size_t unknown) const;
  /// Of the difference of neighbours.
  double SmoothWeight() const;

  /// The strength that a row predicts.
  double Predict(const SignalEquation& row, const double* x) const;

  template <class V>
  void Multiply(const std::vector<V>& x, std::vector<V>* y) const;
  /// Conjugate gradients from x, until the preconditioned residual's norm is below `tolerance`
  /// (in noise: the change of all predictions together that is left is about that).  Returns the
  /// iterations made.
  template <class V>
  int Solve(const std::vector<V>& b, double tolerance, int max_iterations, std::vector<V>* x) const;
  const std::vector<double>& RightHandSide() const { return b_; }

  /// Sixteen right-hand sides whose solutions have the covariance N^-1 and mean zero (perturb and
  /// MAP: Papandreou and Yuille 2010), with signs as perturbations.
  std::vector<Lanes> Perturbations(std::uint64_t seed) const;
  /// N, whole: for few unknowns.
  Eigen::MatrixXd Dense() const;

 private:
  void MakeCoarse();
  /// N where the cells of a block move together.
  Eigen::MatrixXd Condensed(const std::vector<std::int32_t>& block_of, std::size_t blocks) const;
  template <class V>
  void Precondition(const std::vector<V>& r, std::vector<V>* z) const;

  TomographyOptions options_;
  const SignalRows* rows_ = nullptr;
  std::size_t head_ = 2;
  double sigma_db_ = 1;
  std::vector<SignalEquation> equations_;
  std::vector<double> b_, prior_, inverse_diagonal_;

  // Second level of the preconditioner: the head, and blocks of cells that move together.
  std::vector<std::int32_t> block_of_;  // a cell's; below zero: none
  std::size_t coarse_at_entries_ = 0, coarse_at_head_ = 0, coarse_at_cells_ = 0;
  Eigen::MatrixXd coarse_inverse_;
};

}  // namespace graticule
