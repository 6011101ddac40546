#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace graticule::apps {

/// Independent pieces of work, done by whoever is free: by threads of this process, or by the
/// processes that a launcher started.  A request and its result are text, which means the same to
/// every process: each has the same words, and has read the same files.
class Spread {
 public:
  /// A request's result.  Empty: it was stopped (Interruptible), and has none.
  using Handler = std::function<std::optional<std::string>(const std::string& request)>;
  using OnResult = std::function<void(std::size_t request, const std::string& result)>;

  virtual ~Spread() = default;

  /// Whether this is the process that asks, prints and writes.
  virtual bool IsRoot() const = 0;

  /// On the root: has all requests handled, in whatever order, and gives each result as it arrives,
  /// one at a time.  After Interruptible was asked nothing more is begun, and what has no result
  /// then gets none.  Throws what a handler threw, in whichever process.
  virtual void Run(const std::vector<std::string>& requests, const Handler& handler,
                   const OnResult& on_result) = 0;

  /// On the others: handles what the root asks for, one request at a time, until it has ended.
  virtual void Serve(const Handler& handler) = 0;
};

/// Runs `body` in every process, and returns the exit code of this one: the root's is the body's,
/// the others' is 0.  What a body throws in any process, the root throws.  Without a launcher there
/// is this process alone, with so many threads; under one each process does one piece at a time.
/// There are two of this function: a program is linked with spread_threads.cpp, or with
/// spread_mpi.cpp and MPI.
int WithSpread(std::size_t threads, const std::function<int(Spread* spread)>& body);

}  // namespace graticule::apps
