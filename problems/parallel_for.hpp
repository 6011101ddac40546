#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <vector>

#include "graticule/solver/on_threads.hpp"

namespace graticule {

/// Calls work(worker, i) for every i below count, from `threads` threads; `worker` says which,
/// below threads, so that each may keep memory of its own.  What is written to places of its own
/// for each i does not depend on the number of threads.  Rethrows what the first of the workers
/// threw.
template <class Work>
void ParallelFor(std::size_t count, std::size_t threads, Work work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> errors(threads);
  const auto run = [&](std::size_t worker) {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(worker, i);
    } catch (...) {
      errors[worker] = std::current_exception();
      next = count;
    }
  };
  OnThreads(static_cast<int>(std::max<std::size_t>(std::min(threads, count), 1)),
            [&](int worker) { run(static_cast<std::size_t>(worker)); });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace graticule
