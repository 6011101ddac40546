#pragma once

#include <string>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// What a check of Jacobians found for one factor type.
struct JacobianCheck {
  std::string type;
  std::size_t checked = 0;
  std::size_t wrong = 0;   ///< disagree by more than the tolerance
  std::size_t failed = 0;  ///< could not be evaluated
  double worst = 0;        ///< largest relative disagreement
  FactorId worst_factor = 0;
  int worst_row = 0;                 ///< residual component
  std::string worst_block;           ///< role in the schema
  std::string worst_field;           ///< of the block's tangent
  double analytic = 0, numeric = 0;  ///< the two numbers there
  std::string failure;               ///< reason of the first failure
};

/// Compares every factor's Jacobian (raw, with respect to the tangent) with central differences at
/// `values`, extrapolated (Richardson, steps h and h/2).  The disagreement is relative to 1 + the
/// largest number of the block. At a wrap of an angle a difference is meaningless; a factor that
/// stands on one is compared on the smaller step only.  Throws Error as Solve does.
std::vector<JacobianCheck> CheckJacobians(const Graph& graph, const Values& values,
                                          double tolerance = 1e-5);

}  // namespace graticule
