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

  /// A row that is new, or that was traced again.
  struct Change {
    std::size_t row;
    SignalEquation before;  ///< weight 0: there was none
  };

  /// The direction of conjugate gradients' last step, and N times it.  Unknowns that are new since
  /// count as zero in it; where they were numbered anew it must be cleared.
  template <class V>
  struct LastStep {
    std::vector<V> direction, product;
  };

  /// Takes the rows as they are now.  `correlation` as in TomographyOptions; `now_s` for
  /// forgetting.  What it costs is of the rows that the last Trace traced, where nothing that all
  /// rows depend on has changed: the noise, the radios, the map, and no forgetting.
  void Set(const SignalRows& rows, double sigma_db, double correlation, double now_s);
  /// Whether the last Set took all rows anew; if not, Changes are what it did, and cells from
  /// CellsBefore on are new.
  bool IsAnew() const { return is_anew_; }
  const std::vector<Change>& Changes() const { return changes_; }
  std::size_t CellsBefore() const { return cells_before_; }

  /// To change weights and targets; then Prepare must be called, and the next Set is of all rows.
  std::vector<SignalEquation>& ChangeEquations() {
    is_altered_ = true;
    return equations_;
  }
  const std::vector<SignalEquation>& Equations() const { return equations_; }
  /// The diagonal, the right-hand side and the preconditioner, of the equations as they are.
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
  /// Where `last` is given, goes on from the direction of the call before, of nearly the same
  /// system: a few iterations now and then get as far as if they had been made at a stretch.
  template <class V>
  int Solve(const std::vector<V>& b, double tolerance, int max_iterations, std::vector<V>* x,
            LastStep<V>* last = nullptr) const;
  const std::vector<double>& RightHandSide() const { return b_; }

  /// Sixteen right-hand sides whose solutions have the covariance N^-1 and mean zero (perturb and
  /// MAP: Papandreou and Yuille 2010), with signs as perturbations.
  /// `b` is what the last call gave for this seed, or empty: where the last Set was of some rows,
  /// so is what this costs.  Must be called after every Set that is not of all rows.
  void Perturb(std::uint64_t seed, std::vector<Lanes>* b) const;
  /// The trace of N^-1 A'WA, how many of the rows' squares the unknowns take up, from solutions for
  /// Perturb of this seed.  Solutions that are not finished give less.
  double DegreesOfFreedom(std::uint64_t seed, const std::vector<Lanes>& x) const;
  /// N, whole: for few unknowns.
  Eigen::MatrixXd Dense() const;

 private:
  void AddPriors(std::size_t from_cell, std::size_t from_unknown);
  void AddToSums(const SignalEquation& row, double sign);
  template <class V>
  void AddTerms(const SignalEquation& row, const V& pull, std::vector<V>* to) const;
  template <class F>
  void ForNewPairs(std::size_t from, const F& f) const;
  SignalEquation EquationOf(std::size_t i) const;
  void MakeCoarse();
  /// N where the cells of a block move together.
  Eigen::MatrixXd Condensed(const std::vector<std::int32_t>& block_of, std::size_t blocks) const;
  template <class V>
  void Precondition(const std::vector<V>& r, std::vector<V>* z) const;

  TomographyOptions options_;
  const SignalRows* rows_ = nullptr;
  std::size_t head_ = 2;
  double sigma_db_ = 1, correlation_ = 0, now_s_ = 0;
  std::size_t generation_ = 0, cells_before_ = 0;
  bool is_anew_ = true, is_altered_ = false, has_sums_ = false;
  std::vector<Change> changes_;
  std::vector<SignalEquation> equations_;
  std::vector<double> b_, prior_, diagonal_, inverse_diagonal_;

  // Second level of the preconditioner: the head, and blocks of cells that move together.
  std::vector<std::int32_t> block_of_;  // a cell's; below zero: none
  std::size_t coarse_at_entries_ = 0, coarse_at_head_ = 0, coarse_at_cells_ = 0;
  Eigen::MatrixXf coarse_inverse_;
};

}  // namespace graticule
