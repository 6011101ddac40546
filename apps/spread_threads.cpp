#include <mutex>

#include "console.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "launcher.hpp"
#include "spread.hpp"

namespace graticule::apps {
namespace {

class Threads final : public Spread {
 public:
  explicit Threads(std::size_t threads) : threads_(threads) {}

  bool IsRoot() const override { return true; }

  void Run(const std::vector<std::string>& requests, const Handler& handler,
           const OnResult& on_result) override {
    std::mutex one_at_a_time;
    ParallelFor(requests.size(), threads_, [&](std::size_t, std::size_t i) {
      if (Interruptible::WasAsked()) return;
      const std::optional<std::string> result = handler(requests[i]);
      const std::lock_guard<std::mutex> lock(one_at_a_time);
      if (result) on_result(i, *result);
    });
  }

  void Serve(const Handler&) override {}

 private:
  std::size_t threads_;
};

}  // namespace

int WithSpread(std::size_t threads, const std::function<int(Spread*)>& body) {
  if (LaunchedAs().size > 1)
    return Become("graticule-mpi",
                  "the part of graticule that spreads work over a launcher's processes cannot be "
                  "run; it is built where MPI is found");
  Threads spread(threads);
  return body(&spread);
}

}  // namespace graticule::apps
