#include <cmath>

#include "bind.hpp"
#include "graticule/io/comparison.hpp"
#include "graticule/io/graph_plot.hpp"
#include "graticule/io/report_html.hpp"
#include "graticule/io/report_json.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/pose_graph/drawing.hpp"
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
      [](const Report& report, const std::string& file, const std::string& graph_svg) {
        ReportContext context;
        context.file = file;
        return ReportHtml(report, context, graph_svg);
      },
      "report"_a, "file"_a = "", "graph_svg"_a = "",
      "The report as one self-contained page, for people; graph_svg: its figure, from "
      "`draw_graph`.");
  module.def(
      "draw_graph",
      [](const Graph& graph, const Values& after, const Values* before, const std::string& title) {
        GraphPlot plot = PlotOf(graph, before ? *before : after, after, title);
        if (!before) plot.before.clear();
        return DrawGraph(plot);
      },
      "graph"_a, "after"_a, "before"_a = nullptr, "title"_a = "", Released(),
      "A graph of poses and landmarks seen from above, as SVG; edges are coloured by their chi2 at "
      "`after`.  before: values for a second picture beside it.");
  module.def(
      "png_from_svg",
      [](const std::string& svg, int width_px) { return py::bytes(PngFromSvg(svg, width_px)); },
      "svg"_a, "width_px"_a = 1600, "The same picture as a PNG file, on white.");

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
