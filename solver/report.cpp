#include "graticule/solver/report.hpp"

#include <limits>

namespace graticule {

double Report::ReducedChi2() const {
  return degrees_of_freedom > 0 ? Chi2() / static_cast<double>(degrees_of_freedom)
                                : std::numeric_limits<double>::quiet_NaN();
}

std::string ToString(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "no_convergence";
    case Termination::kTimeLimit:
      return "time_limit";
    case Termination::kCancelled:
      return "cancelled";
    case Termination::kFailed:
      return "failed";
  }
  return "failed";
}

}  // namespace graticule
