#pragma once

#include <exception>
#include <optional>
#include <utility>

#include "bind.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule::python {

/// An Observer that calls a Python function, and lets Ctrl-C through.  Whoever solves with it has
/// released the interpreter; afterwards `Rethrow` throws what was thrown meanwhile.
class PythonObserver {
 public:
  explicit PythonObserver(py::object on_iteration = py::none())
      : on_iteration_(std::move(on_iteration)) {}

  Observer Watch() {
    return {[this](const Iteration& iteration) {
      const py::gil_scoped_acquire acquired;
      return Goes([&] {
        return on_iteration_.is_none() ||
               !py::object(on_iteration_(py::cast(Iteration(iteration)))).is(py::bool_(false));
      });
    }};
  }

  /// Runs what may throw as Python does, then looks for Ctrl-C.  False: stop.
  template <class Work>
  bool Goes(const Work& work) {
    if (thrown_) return false;
    try {
      const bool goes_on = work();
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      return goes_on;
    } catch (...) {
      thrown_ = std::current_exception();
      return false;
    }
  }

  void Rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  py::object on_iteration_;
  std::exception_ptr thrown_;
};

/// What `solve(Observer)` returns, run without the interpreter.
template <class Solve>
auto Watched(const py::object& on_iteration, const Solve& solve) {
  PythonObserver observer(on_iteration);
  auto result = [&] {
    const py::gil_scoped_release released;
    return solve(observer.Watch());
  }();
  observer.Rethrow();
  return result;
}

/// The same for what is solved of a graph: of a copy where Python is called meanwhile, which may
/// change the graph itself.
template <class Solve>
auto Watched(const Graph& graph, const py::object& on_iteration, const Solve& solve) {
  std::optional<Graph> copy;
  if (!on_iteration.is_none()) copy = graph;
  return Watched(on_iteration,
                 [&](const Observer& watch) { return solve(copy ? *copy : graph, watch); });
}

}  // namespace graticule::python
