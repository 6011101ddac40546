#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/solver/online.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

OnlineReport Updated(Online& online, bool exactly) {
  auto report = [&] {
    const py::gil_scoped_release released;
    return exactly ? online.UpdateExactly() : online.Update();
  }();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  return report;
}

}  // namespace

void BindOnline(py::module_& module) {
  Record<OnlineOptions>(module, "OnlineOptions", "How a growing graph is solved.")
      .Field("relinearise_above", &OnlineOptions::relinearise_above,
             "A variable is linearised anew where a component of its step since then (m, rad) is "
             "larger.")
      .Field("relinearise_every", &OnlineOptions::relinearise_every,
             "... which is looked for at every so many updates.")
      .Field("propagate_above", &OnlineOptions::propagate_above,
             "Changes smaller than this, in every component, are not followed further.")
      .Field("lag", &OnlineOptions::lag,
             "Fixed lag: of each family named here so many stay, those added last.")
      .Field("solve", &OnlineOptions::solve, "How update_exactly solves.");
  Record<OnlineReport>(module, "OnlineReport", "What an update did.")
      .Result("new_variables", &OnlineReport::new_variables, "Taken in.")
      .Result("new_factors", &OnlineReport::new_factors, "Taken in.")
      .Result("marginalised", &OnlineReport::marginalised, "Variables that left by the lag.")
      .Result("eliminated", &OnlineReport::eliminated, "Variables eliminated anew.")
      .Result("relinearised", &OnlineReport::relinearised, "Variables linearised anew.")
      .Result("changed", &OnlineReport::changed, "Variables computed anew.")
      .Result("loose", &OnlineReport::loose,
              "Of these, variables that nothing determines in some direction, held along it.  Of "
              "several that are loose together, one stands for all.")
      .Result("objective", &OnlineReport::objective, "Of update_exactly: 0.5 sum rho(r' W r).")
      .Result("termination", &OnlineReport::termination,
              "Of update_exactly: how the solve ended.  update takes one step: NO_CONVERGENCE.")
      .Result("message", &OnlineReport::message, "Of update_exactly: why it ended.")
      .Result("seconds", &OnlineReport::seconds, "Wall time.");
  py::class_<Online>(module, "Online",
                     "A graph that grows and is solved as it grows: incremental smoothing after "
                     "Kaess et al. (iSAM2, IJRR 2012).  Where no factor is absolute and no "
                     "variable fixed, the variable added first is held.")
      .def(py::init(
               [](const Registry* types, const OnlineOptions* options, const py::kwargs& keywords) {
                 return std::make_unique<Online>(types ? *types : Builtins(),
                                                 OptionsFrom(options, keywords));
               }),
           "types"_a = nullptr, "options"_a = nullptr,
           "Empty.  None: the built-in types, the default options; these also as keywords.")
      .def("add",
           py::overload_cast<const Key&, std::string_view, const std::vector<double>&, bool>(
               &Online::Add),
           "key"_a, "type"_a, "value"_a, "fixed"_a = false,
           "A variable.  The value should be a guess made from `latest()`.  Returns its id.")
      .def("add", py::overload_cast<const Factor&>(&Online::Add), "factor"_a,
           "A factor.  Returns its id, which stays what it is.")
      .def(
          "update", [](Online& online) { return Updated(online, false); },
          "Takes in what was added since the last update, and publishes new values.")
      .def(
          "update_exactly", [](Online& online) { return Updated(online, true); },
          "The same, and then on to the minimum, as `solve` finds it from here.")
      .def("freeze", &Online::Freeze, "keys"_a, Released(),
           "Holds variables where they are from now on.")
      .def("marginalise", &Online::Marginalise, "keys"_a, Released(),
           "Takes variables out; what their factors said of the others stays, as Gaussians.")
      .def("has_left", &Online::HasLeft, "key"_a, "Whether a variable was marginalised.")
      .def("remove", &Online::Remove, "factor"_a, "Takes a factor back, from the next update on.")
      .def(
          "latest",
          [](const Online& online) -> std::optional<Values> {
            const auto latest = online.Latest();
            if (!latest) return std::nullopt;
            return *latest;
          },
          "The values of the last update: a copy.  None before the first.")
      .def(
          "covariance",
          [](const Online& online, const Key& key) {
            std::vector<double> block = online.Covariance(key);
            const auto size =
                static_cast<py::ssize_t>(std::lround(std::sqrt(static_cast<double>(block.size()))));
            return Owned(std::move(block), {size, size});
          },
          "key"_a,
          "(tangent size, tangent size) the marginal covariance as of the last update.  Zero "
          "where the variable is held.  IllPosedError: it moves with something that nothing "
          "determines.")
      .def("problem", &Online::Problem, Released(),
           "The problem as it stands: without what was removed, Gaussians in place of what was "
           "marginalised.")
      .def("recorded", &Online::Recorded, Released(),
           "All that was added and not removed, at the values of the last update.");
}

}  // namespace graticule::python
