#include <cmath>

#include "bind.hpp"
#include "graticule/io/comparison.hpp"
#include "graticule/io/report_html.hpp"
#include "graticule/io/report_json.hpp"
#include "graticule/solver/provenance.hpp"

namespace graticule::python {

void BindReports(py::module_& module) {
  using namespace py::literals;
  module.def(
      "report_json",
      [](const Report& report, const std::string& file) {
        ReportContext context;
        context.file = file;
        return ReportJson(report, context);
      },
      "report"_a, "file"_a = "", "The report as one JSON object; `file` is the problem's name.");
  module.def(
      "report_html",
      [](const Report& report, const std::string& file) {
        ReportContext context;
        context.file = file;
        return ReportHtml(report, context);
      },
      "report"_a, "file"_a = "", "The report as one self-contained page, for people.");

  Record<ComparisonRun>(module, "ComparisonRun", "A problem solved with a configuration.")
      .Field("file", &ComparisonRun::file, "The problem.")
      .Field("configuration", &ComparisonRun::configuration, "Its name.")
      .Field("error", &ComparisonRun::error, "Why there is no result; \"\": there is one.")
      .Field("report", &ComparisonRun::report, "What the solve did.")
      .Field("best_known", &ComparisonRun::best_known, "The lowest cost known; nan: none.")
      .Field("gap", &ComparisonRun::gap, "(final cost - best known) / best known; nan: unknown.")
      .Field("repeats", &ComparisonRun::repeats, "How often it was run.")
      .Field("median", &ComparisonRun::median, "Times: the median of each phase.")
      .Field("min_total_s", &ComparisonRun::min_total_s, "Shortest run [s].")
      .Field("max_total_s", &ComparisonRun::max_total_s, "Longest run [s].");
  Record<Comparison>(module, "Comparison", "Runs, in the order in which they are shown.")
      .Field("runs", &Comparison::runs, "A problem and a configuration each.")
      .Class()
      .def("json", &ComparisonJson, "One JSON object, each run with its whole report.")
      .def("html", &ComparisonHtml, "One self-contained page.")
      .def(
          "table", [](const Comparison& self) { return ComparisonTable(self, false); },
          "Aligned columns, at most 120 wide.")
      .def("__str__", [](const Comparison& self) { return ComparisonTable(self, false); });
  module.def(
      "make_comparison",
      [](std::vector<ComparisonRun> runs) {
        Comparison comparison;
        comparison.runs = std::move(runs);
        comparison.provenance = Provenance();
        return comparison;
      },
      "runs"_a, "Of runs, with the versions that they were made with.");
}

}  // namespace graticule::python
