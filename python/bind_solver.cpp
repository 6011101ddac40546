#include "bind.hpp"
#include "graticule/solver/solve.hpp"
#include "observer.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

void BindReport(py::module_& m) {
  py::enum_<Termination>(m, "Termination", "How a solve ended.")
      .value("CONVERGED", Termination::kConverged, "A tolerance was met.")
      .value("NO_CONVERGENCE", Termination::kNoConvergence, "max_iterations reached.")
      .value("TIME_LIMIT", Termination::kTimeLimit, "time_limit_s reached.")
      .value("CANCELLED", Termination::kCancelled, "The observer said stop.")
      .value("FAILED", Termination::kFailed,
             "A factor could not be evaluated, or the linear solver gave up.");
  Record<Iteration>(m, "Iteration", "One step of the solver.  Row 0 is the initial guess.")
      .Result("number", &Iteration::number, "From 0.")
      .Result("accepted", &Iteration::accepted, "Whether the step was taken.")
      .Result("objective", &Iteration::objective, "0.5 sum rho(r' W r)")
      .Result("objective_change", &Iteration::objective_change, "Decrease; negative: rejected.")
      .Result("gradient_max_norm", &Iteration::gradient_max_norm, "Largest component.")
      .Result("step_norm", &Iteration::step_norm, "Length of the step.")
      .Result("trust_region_radius", &Iteration::trust_region_radius, "After the step.")
      .Result("linear_iterations", &Iteration::linear_iterations, "Of iterative linear solvers.")
      .Result("seconds", &Iteration::seconds, "Wall time since the solve began.");
  Record<CostShare>(m, "CostShare", "Cost of all factors of one type and source together.")
      .Result("type", &CostShare::type, "Factor type.")
      .Result("source", &CostShare::source, "Who said so.")
      .Result("factors", &CostShare::factors, "How many.")
      .Result("residuals", &CostShare::residuals, "Numbers.")
      .Result("initial_cost", &CostShare::initial_cost, "0.5 r' W r at the start.")
      .Result("final_cost", &CostShare::final_cost, "0.5 r' W r at the end.");
  Record<WorstFactor>(m, "WorstFactor", "A factor that disagrees most.")
      .Result("id", &WorstFactor::id, "In the graph.")
      .Result("type", &WorstFactor::type, "Factor type.")
      .Result("source", &WorstFactor::source, "Who said so.")
      .Result("keys", &WorstFactor::keys, "Of its variables.")
      .Result("chi2", &WorstFactor::chi2, "r' W r at the end.")
      .Result("residuals", &WorstFactor::residuals, "Numbers.")
      .Result("weight", &WorstFactor::weight, "rho': what the loss left of it.");
  Record<PhaseTime>(m, "PhaseTime", "Seconds of one phase.")
      .Field("wall", &PhaseTime::wall, "Wall seconds.")
      .Field("cpu", &PhaseTime::cpu, "CPU seconds of all threads.");
  Record<Timing>(m, "Timing", "Where the time went.")
      .Field("load", &Timing::load, "Reading the file.")
      .Field("initialise", &Timing::initialise, "Finding a start.")
      .Field("build", &Timing::build, "Graph to solver.")
      .Field("solve", &Timing::solve, "The solver.")
      .Field("write", &Timing::write, "Writing files.")
      .Field("total", &Timing::total, "All of it.");
  Record<Report>(m, "Report", "What a solve did: enough to judge it, and to repeat it.")
      .Result("termination", &Report::termination, "How it ended.")
      .Result("message", &Report::message, "One line: why it ended.")
      .Result("variables", &Report::variables, "How many.")
      .Result("fixed_variables", &Report::fixed_variables, "Of these, held.")
      .Result("factors", &Report::factors, "How many.")
      .Result("residuals", &Report::residuals, "Numbers.")
      .Result("parameters", &Report::parameters, "Numbers.")
      .Result("degrees_of_freedom", &Report::degrees_of_freedom,
              "Residuals minus free tangent parameters.")
      .Result("initial_cost", &Report::initial_cost, "0.5 r' W r at the start, without losses.")
      .Result("final_cost", &Report::final_cost, "0.5 r' W r at the end, without losses.")
      .Result("initial_objective", &Report::initial_objective, "0.5 sum rho(r' W r).")
      .Result("final_objective", &Report::final_objective, "The same at the end.")
      .Result("iterations", &Report::iterations, "Row 0 is the initial guess.")
      .Result("shares", &Report::shares, "Cost by factor type and source.")
      .Result("worst", &Report::worst, "Factors of the largest chi2, at most five.")
      .Result("anchors", &Report::anchors, "Keys held by the solver to remove the gauge.")
      .Result("warnings", &Report::warnings, "For people.")
      .Result("timing", &Report::timing, "Where the time went.")
      .Result("threads", &Report::threads, "That were used.")
      .Result("linear_solver", &Report::linear_solver, "That was used.")
      .Class()
      .def_property_readonly("chi2", &Report::Chi2, "r' W r at the end.")
      .def_property_readonly("reduced_chi2", &Report::ReducedChi2,
                             "chi2 per degree of freedom; nan where there is none.")
      .def_property_readonly("steps", &Report::Steps, "Accepted and rejected.")
      .def_property_readonly(
          "options",
          [](const Report& report) {
            py::dict options;
            for (const auto& [name, value] : report.options) options[py::str(name)] = value;
            return options;
          },
          "Every option's name and value, as texts.")
      .def(
          "__repr__",
          [](const Report& report) {
            return "Report(" + ToString(report.termination) + ", cost " +
                   Shown(report.initial_cost) + " -> " + Shown(report.final_cost) + ", " +
                   std::to_string(report.Steps()) + " steps)";
          },
          py::prepend());
}

}  // namespace

void BindSolver(py::module_& module) {
  Record<SolveOptions>(module, "SolveOptions", "How to solve; never what (docs/options.md).")
      .Options(SolveOptionTable());
  BindReport(module);
  py::class_<Solution>(module, "Solution", "Where a solve ended, and how it got there.")
      .def_readonly("values", &Solution::values, "Of the graph's variables.")
      .def_readonly("report", &Solution::report, "What it did.")
      .def("__repr__", [](const py::object& solution) {
        return "Solution(" + py::repr(solution.attr("report")).cast<std::string>() + ")";
      });

  module.def(
      "solve",
      [](const Graph& graph, const SolveOptions* options, const py::object& on_iteration,
         const py::kwargs& keywords) {
        const SolveOptions chosen = OptionsFrom(options, keywords);
        return Watched(graph, on_iteration, [&](const Graph& asked, const Observer& watch) {
          return Solve(asked, chosen, watch);
        });
      },
      "graph"_a, "options"_a = nullptr, py::kw_only(), "on_iteration"_a = py::none(),
      "Minimises 0.5 sum rho(r' W r) over the free variables, from the graph's own values.  The "
      "graph is not changed.  Options also as keywords: `solve(graph, threads=2)`.  "
      "`on_iteration` is called with an Iteration after each; where it returns False the best so "
      "far is the result; what it does to the graph the next solve sees.  Ctrl-C raises "
      "KeyboardInterrupt after the next iteration.  Other "
      "threads run meanwhile.  Throws Error for what is wrong with the graph; what is numerical "
      "is in the report.");
  module.def(
      "factor_chi2",
      [](const Graph& graph, const Values* values) {
        const py::gil_scoped_release released;
        return FactorChi2(graph, values ? *values : graph.InitialValues());
      },
      "graph"_a, "values"_a = nullptr,
      "(factors,) r' W r of every factor, by id; nan where it cannot be evaluated.  None: at the "
      "graph's own values.");
  module.def(
      "objective",
      [](const Graph& graph, const Values* values) {
        const py::gil_scoped_release released;
        const Values at = values ? *values : graph.InitialValues();
        return Objectives(graph, {&at}).at(0);
      },
      "graph"_a, "values"_a = nullptr,
      "0.5 sum rho(r' W r), what `solve` minimises.  None: at the graph's own values.");
}

}  // namespace graticule::python
