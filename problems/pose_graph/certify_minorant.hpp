#pragma once

#include <vector>

#include "graticule/problems/pose_graph/certify_program.hpp"

namespace graticule {

/// A function of lifted poses X (a row of [t R] blocks), 0.5 tr(X Q X') and a constant, by the
/// blocks of Q.
template <int kDim>
struct Quadratic {
  using Block = Eigen::Matrix<double, kDim + 1, kDim + 1>;
  struct Term {
    int a = 0, b = 0;
    Block aa = Block::Zero(), ab = Block::Zero(), bb = Block::Zero();
  };
  std::vector<Term> terms;  ///< one for each statement

  /// X Q.
  Poses<kDim> Times(const Poses<kDim>& poses) const;
  /// The blocks on the diagonal of Q, by node.
  std::vector<Block> Diagonal(std::size_t nodes) const;
};

/// Which quadratic stands in for a program's cost.
enum class StandIn {
  /// Nowhere above the cost; where possible of its value and gradient at the poses given.
  kMinorant,
  /// Isotropic and chordal, a sum of squares, 0.5 sum tau |t_b - t_a - R_a t_m|^2 + kappa |R_b -
  /// R_a R_m|^2, with
  /// the means over the axes of the variances that W gives.
  kChordal,
};

template <int kDim>
struct StandInResult {
  Quadratic<kDim> quadratic;
  double cost = 0;        ///< of the program, at the poses given
  double shortfall = 0;   ///< cost less the minorant's value there; of kChordal 0
  std::size_t exact = 0;  ///< statements whose minorant has their value and gradient there
};

/// The derivations are in docs/certificate.md.
template <int kDim>
StandInResult<kDim> MakeStandIn(const Program<kDim>& program, const Poses<kDim>& poses,
                                StandIn kind);

}  // namespace graticule
