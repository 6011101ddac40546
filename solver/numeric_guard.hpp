#pragma once

#include <string>

namespace graticule {

/// While it lives, BLAS and CHOLMOD run on the calling thread alone, and Ceres' log is silent.
///
/// CHOLMOD's supernodal code opens OpenMP regions of four threads whatever OMP_NUM_THREADS says,
/// and OpenBLAS brings its own: on small supernodes both cost more than they bring (measured: 2 to
/// 40 times the wall time), and neither adds up in a fixed order.
///
/// The log's level and BLAS' threads are the process': the first guard of any thread saves and sets
/// them, the last one restores them.
class NumericGuard {
 public:
  NumericGuard();
  ~NumericGuard();
  NumericGuard(const NumericGuard&) = delete;
  NumericGuard& operator=(const NumericGuard&) = delete;
};

/// The file that BLAS' dgemm_ comes from, as the process has bound it, links followed.
std::string LoadedBlas();

}  // namespace graticule
