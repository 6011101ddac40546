#pragma once

#include <chrono>
#include <ctime>

#include "graticule/solver/report.hpp"

namespace graticule {

/// Wall and CPU time (of all threads of the process) since it was made or last restarted.
class Stopwatch {
 public:
  Stopwatch() { Restart(); }

  void Restart() {
    wall_ = std::chrono::steady_clock::now();
    cpu_ = CpuSeconds();
  }

  PhaseTime Elapsed() const {
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_;
    return {wall.count(), CpuSeconds() - cpu_};
  }

  /// Elapsed, and begins again.
  PhaseTime Lap() {
    const PhaseTime time = Elapsed();
    Restart();
    return time;
  }

 private:
  static double CpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  std::chrono::steady_clock::time_point wall_;
  double cpu_ = 0;
};

}  // namespace graticule
