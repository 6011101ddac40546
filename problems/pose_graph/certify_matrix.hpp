#pragma once

#include <optional>
#include <vector>

#include "graticule/problems/pose_graph/certify_minorant.hpp"
#include "graticule/solver/block_system.hpp"

namespace graticule {

/// The multipliers of the constraints R' R = 1 at poses X, and what they leave: S = Q - Lambda,
/// Lambda_i the symmetric part of R_i' (X Q)_i on the rotations and zero on the translations.
template <int kDim>
struct Dual {
  using Block = typename Quadratic<kDim>::Block;
  std::vector<Block> diagonal;  ///< of S, by node; its other blocks are those of Q
  Poses<kDim> gradient;         ///< X S: zero where X is stationary
  /// 0.5 tr(X S X'): only translations add to it.  The dual's value is the quadratic's less this.
  double remainder = 0;
};

template <int kDim>
Dual<kDim> DualAt(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                  const Poses<kDim>& poses);

/// The certificate matrix S, with one translation of each piece held: sparse, factorised by
/// CHOLMOD. What is added to it, and measured by its eigenvalues, is relative: D holds on the
/// rotations of a node the largest number of its diagonal in S, and zero on translations.
template <int kDim>
class CertificateMatrix {
 public:
  /// Of one pattern for all quadratics of the program, which must outlive it.
  explicit CertificateMatrix(const Program<kDim>& program);

  void Load(const Quadratic<kDim>& quadratic, const Dual<kDim>& dual);

  /// Whether S + shift D is positive definite.
  bool IsPositive(double shift);

  /// 0.5 tr(X D X'), the same for all X: what a shift of 1 costs the bound.
  double Allowance() const { return allowance_; }

  struct Direction {
    /// Of S v = eigenvalue D v, with the translations eliminated.
    double eigenvalue = 0;
    /// v' as a row of [t R] blocks, the translations the best for it; v' D v = 1.
    Eigen::RowVectorXd row;
  };
  /// The smallest eigenvalue and its vector.  `from`: a shift that IsPositive accepts.  None where
  /// the iteration did not converge.
  std::optional<Direction> SmallestEigenvalue(double from);

 private:
  const Program<kDim>& program_;
  BlockSystem system_;
  std::vector<bool> pins_;
  std::vector<double> weights_;  // D, by node
  double shift_ = 0, allowance_ = 0;
};

}  // namespace graticule
