#include "bind.hpp"
#include "graticule/problems/pose_graph/corrupt.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "observer.hpp"

namespace graticule::python {

void BindOutliers(py::module_& module) {
  using namespace py::literals;
  py::enum_<Rejection>(module, "Rejection", "How outliers are found.")
      .value("NONE", Rejection::kNone, "Not at all.")
      .value("GNC_TLS", Rejection::kGncTls, "Graduated non-convexity, truncated least squares.")
      .value("GNC_GM", Rejection::kGncGm, "The same, Geman-McClure.")
      .value("PCM", Rejection::kPcm, "Pairwise consistency maximisation.");
  Record<RejectionOptions>(module, "RejectionOptions", "How outliers are found.")
      .Options(RejectionOptionTable());
  Record<RejectionReport::Factor>(module, "RejectedFactor", "A factor that was left out.")
      .Result("id", &RejectionReport::Factor::id, "In the graph.")
      .Result("chi2", &RejectionReport::Factor::chi2, "At the solution that does without it.")
      .Result("limit", &RejectionReport::Factor::limit, "Up to which it would have been kept.");
  Record<RejectionReport>(module, "RejectionReport", "What was rejected, and how.")
      .Result("method", &RejectionReport::method, "Which.")
      .Result("factors", &RejectionReport::factors, "Of the whole graph.")
      .Result("suspects", &RejectionReport::suspects, "(n,) ids.")
      .Result("rejected", &RejectionReport::rejected, "In the graph's order.")
      .Result("inlier_quantile", &RejectionReport::inlier_quantile, "As used.")
      .Result("inlier_noise_scale", &RejectionReport::inlier_noise_scale, "As used.")
      .Result("rounds", &RejectionReport::rounds, "Of all attempts.")
      .Result("trees", &RejectionReport::trees, "That trusted factors make.")
      .Result("warnings", &RejectionReport::warnings, "For people.")
      .Result("seconds", &RejectionReport::seconds, "Wall, of all but the last solve.");
  py::class_<RobustSolution>(module, "RobustSolution", "The graph solved without what is wrong.")
      .def_readonly("solution", &RobustSolution::solution, "Without the rejected factors.")
      .def_readonly("rejection", &RobustSolution::rejection, "What was rejected.")
      .def_readonly("start", &RobustSolution::start, "What the trusted factors say.")
      .def_property_readonly(
          "is_kept",
          [](const RobustSolution& self) {
            py::array_t<bool> kept(static_cast<py::ssize_t>(self.is_kept.size()));
            std::copy(self.is_kept.begin(), self.is_kept.end(), kept.mutable_data());
            return kept;
          },
          "(factors,) by id.");
  module.def(
      "solve_without_outliers",
      [](const Graph& graph, const RejectionOptions* rejection, const SolveOptions* options,
         bool from_values, const py::object& on_iteration, const py::kwargs& keywords) {
        const RejectionOptions reject = OptionsFrom(rejection, keywords);
        const SolveOptions solve = options ? *options : SolveOptions();
        return Watched(graph, on_iteration, [&](const Graph& asked, const Observer& watch) {
          return SolveWithoutOutliers(asked, reject, solve, watch, from_values);
        });
      },
      "graph"_a, "rejection"_a = nullptr, "options"_a = nullptr, "from_values"_a = false,
      py::kw_only(), "on_iteration"_a = py::none(),
      "Finds factors that are wrong, and solves the graph without them (docs/outliers.md).  The "
      "rejection's options also as keywords: reject_outliers=\"gnc_tls\".");

  py::enum_<Corruption>(module, "Corruption", "How false loop closures come about.")
      .value("RANDOM", Corruption::kRandom, "One by one, between any two poses.")
      .value("GROUPED", Corruption::kGrouped, "Runs of ten that agree with each other.")
      .value("LOCAL", Corruption::kLocal, "Between poses at most 20 apart by number.");
  module.def(
      "add_false_closures",
      [](const Graph& graph, double fraction, Corruption kind, std::uint64_t seed) {
        Corrupted corrupted = AddFalseClosures(graph, {fraction, kind, seed});
        return std::make_pair(std::move(corrupted.graph), std::move(corrupted.outliers));
      },
      "graph"_a, "fraction"_a = 0.3, py::arg_v("kind", Corruption::kRandom, "Corruption.RANDOM"),
      "seed"_a = 1,
      "The graph with false loop closures added, and their ids.  fraction: of all closures "
      "afterwards.");
}

}  // namespace graticule::python
