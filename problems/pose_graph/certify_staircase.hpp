#pragma once

#include <functional>

#include "graticule/problems/pose_graph/certify_matrix.hpp"

namespace graticule {

/// Where a staircase ended.
template <int kDim>
struct StaircaseResult {
  Poses<kDim> poses;      ///< not lifted
  int rank = kDim;        ///< of what they were rounded from
  bool is_close = false;  ///< the lifted poses were proved within 1 % of the chordal minimum
};

/// The Riemannian staircase on a program's chordal stand-in, from poses that need not be its
/// minimum: descends; where the certificate matrix still has a negative eigenvalue, descends along
/// its eigenvector in one dimension more, where that is downhill; two more dimensions at the most.
/// Then rounds to rotations.  After N. Boumal, "A Riemannian low-rank method for optimization over
/// semidefinite matrices with block-diagonal constraints" (2015), and SE-Sync.
/// `go_on` is asked after each step, with the stand-in's value; false ends it.
template <int kDim>
StaircaseResult<kDim> ClimbStaircase(const Program<kDim>& program, const Poses<kDim>& from,
                                     const std::function<bool(double)>& go_on = {});

}  // namespace graticule
