#include "graticule/io/map_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "graticule/io/chart.hpp"
#include "graticule/io/html.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

std::string BandName(std::size_t band) {
  const std::vector<double> ends = MapBands();
  return band < ends.size() ? "< " + ReadableSeconds(ends[band])
                            : "≥ " + ReadableSeconds(ends.back());
}

std::string MethodTable(const MapReport& report) {
  std::vector<html::Column> columns = {
      {"method", false}, {"total", true}, {"mean", true}, {"99 %", true}, {"worst", true}};
  for (std::size_t band = 0; band <= MapBands().size(); ++band)
    columns.push_back({BandName(band), true, "updates in this band"});
  columns.push_back({"structure IoU", true, "against the map of all nodes at the same poses"});
  columns.push_back({"known recall", true, "of the cells that the map of all nodes knows"});
  std::vector<std::vector<html::Cell>> rows;
  for (const MapRun& run : report.runs) {
    const MapRunTimes times = TimesOf(run);
    std::vector<html::Cell> row = {{run.method, "name"},
                                   {ReadableSeconds(times.total)},
                                   {ReadableSeconds(times.mean)},
                                   {ReadableSeconds(times.p99)},
                                   {ReadableSeconds(times.worst)}};
    for (const std::size_t count : CountInBands(run)) row.push_back({ReadableCount(count)});
    row.push_back({ReadableNumber(run.structure_iou)});
    row.push_back({ReadableNumber(run.known_recall)});
    rows.push_back(std::move(row));
  }
  return html::Table(columns, rows);
}

std::string UpdateCharts(const MapReport& report) {
  CurveChart each, cumulative, nodes;
  each.title = "Time of each update";
  cumulative.title = "Cumulative time";
  nodes.title = "Nodes, cover, and nodes drawn anew";
  for (CurveChart* chart : {&each, &cumulative, &nodes}) chart->x_label = "time of the log [s]";
  each.y_label = cumulative.y_label = "time [s]";
  nodes.y_label = "nodes";
  nodes.y_scale = cumulative.y_scale = AxisScale::kLinear;
  for (const MapRun& run : report.runs) {
    Curve one{run.method, {}}, sum{run.method, {}};
    double total = 0;
    for (const MapUpdateRow& row : run.updates) {
      total += row.seconds;
      one.points.push_back({row.time, row.seconds});
      sum.points.push_back({row.time, total});
    }
    each.curves.push_back(std::move(one));
    cumulative.curves.push_back(std::move(sum));
  }
  if (!report.runs.empty()) {
    Curve all{"nodes", {}}, cover{"cover", {}}, anew{"drawn anew", {}};
    for (const MapUpdateRow& row : report.runs.front().updates) {
      all.points.push_back({row.time, static_cast<double>(row.nodes)});
      cover.points.push_back({row.time, static_cast<double>(row.cover)});
      anew.points.push_back({row.time, static_cast<double>(row.regenerated_nodes)});
    }
    nodes.curves = {all, cover, anew};
  }
  return html::Figure(DrawCurves(each)) + html::Figure(DrawCurves(cumulative)) +
         html::Figure(DrawCurves(nodes));
}

nlohmann::ordered_json Json(const MapRun& run) {
  const MapRunTimes times = TimesOf(run);
  nlohmann::ordered_json updates = nlohmann::ordered_json::array();
  for (const MapUpdateRow& row : run.updates)
    updates.push_back({{"time", row.time},
                       {"seconds", row.seconds},
                       {"nodes", row.nodes},
                       {"cover", row.cover},
                       {"regenerated_nodes", row.regenerated_nodes},
                       {"left_over_slices", row.left_over_slices},
                       {"dirty_tiles", row.dirty_tiles},
                       {"flipped_cells", row.flipped_cells}});
  nlohmann::ordered_json bands = nlohmann::ordered_json::array();
  const std::vector<std::size_t> counts = CountInBands(run);
  for (std::size_t i = 0; i < counts.size(); ++i)
    bands.push_back({{"below_s", i < MapBands().size() ? nlohmann::ordered_json(MapBands()[i])
                                                       : nlohmann::ordered_json(nullptr)},
                     {"updates", counts[i]}});
  return {{"method", run.method},
          {"total_s", times.total},
          {"mean_s", times.mean},
          {"p99_s", times.p99},
          {"worst_s", times.worst},
          {"bands", bands},
          {"structure_iou", run.structure_iou},
          {"known_recall", run.known_recall},
          {"known_changed", run.known_changed},
          {"updates", updates}};
}

}  // namespace

MapRunTimes TimesOf(const MapRun& run) {
  MapRunTimes times;
  if (run.updates.empty()) return times;
  std::vector<double> seconds;
  for (const MapUpdateRow& row : run.updates) seconds.push_back(row.seconds);
  for (const double one : seconds) times.total += one;
  std::sort(seconds.begin(), seconds.end());
  times.mean = times.total / static_cast<double>(seconds.size());
  times.p99 = seconds[(seconds.size() - 1) * 99 / 100];
  times.worst = seconds.back();
  return times;
}

std::vector<double> MapBands() { return {0.5e-3, 1e-3, 5e-3, 20e-3, 100e-3, 1}; }

std::vector<std::size_t> CountInBands(const MapRun& run) {
  const std::vector<double> ends = MapBands();
  std::vector<std::size_t> counts(ends.size() + 1, 0);
  for (const MapUpdateRow& row : run.updates)
    ++counts[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), row.seconds) -
                                      ends.begin())];
  return counts;
}

std::string MapReportHtml(const MapReport& report, const std::string& map_svg) {
  std::vector<std::vector<html::Cell>> facts;
  for (const auto& [name, value] : report.facts) facts.push_back({{name, "name"}, {value}});
  std::string body =
      html::Table({{"", false}, {"", false}}, facts) + html::Section("Map", html::Figure(map_svg));
  if (!report.runs.empty())
    body += html::Section("Updates", MethodTable(report) + UpdateCharts(report));
  if (!report.warnings.empty()) body += html::Section("Warnings", html::List(report.warnings));
  return html::Page(report.title, "<h1>" + EscapeXml(report.title) + "</h1>\n", body);
}

std::string MapReportJson(const MapReport& report) {
  nlohmann::ordered_json json = {{"schema", "graticule-map/1"}, {"title", report.title}};
  for (const auto& [name, value] : report.facts) json["facts"][name] = value;
  json["runs"] = nlohmann::ordered_json::array();
  for (const MapRun& run : report.runs) json["runs"].push_back(Json(run));
  json["warnings"] = report.warnings;
  return json.dump(2) + "\n";
}

}  // namespace graticule
