#pragma once

#include <string>

namespace graticule {

/// While it lives, BLAS and CHOLMOD run on the calling thread alone, and Ceres' log is silent.
///
/// CHOLMOD's supernodal code opens OpenMP regions of four threads whatever OMP_NUM_THREADS says,
/// and OpenBLAS brings its own: on small supernodes both cost more than they bring (measured: 2 to
/// 40 times the wall time), and neither adds up in a fixed order.  Not nestable across threads for
/// the log level, which is process-wide.
class NumericGuard {
 public:
  NumericGuard();
  ~NumericGuard();
  NumericGuard(const NumericGuard&) = delete;
  NumericGuard& operator=(const NumericGuard&) = delete;

 private:
  int blas_threads_ = 0;
  int active_levels_ = 0;
  int log_level_ = 0;
};

/// The file that BLAS' dgemm_ comes from, as the process has bound it, links followed.
std::string LoadedBlas();

}  // namespace graticule
