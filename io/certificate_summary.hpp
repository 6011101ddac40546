#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace graticule {

/// What a certificate of global optimality says of the solution.
struct CertificateSummary {
  std::string verdict;  ///< "optimal", "bounded", "refused", "not_applicable"
  std::string text;     ///< one line
  bool is_applicable = false;
  double cost = 0, lower_bound = 0, gap = 0, relative_gap = 0;
  double eigenvalue = 0;             ///< where refused
  std::vector<std::string> reasons;  ///< where not applicable
  std::size_t exact_factors = 0, factors = 0;
  double seconds = 0;  ///< wall, without the attempts

  /// Where it was refused: what was solved again.
  struct Attempt {
    std::string from, verdict;
    double cost = 0, seconds = 0;
  };
  std::vector<Attempt> attempts;
  bool improved = false;  ///< the solution is that of an attempt
};

}  // namespace graticule
