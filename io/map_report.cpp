#include "graticule/io/map_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "graticule/io/chart.hpp"
#include "graticule/io/html.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/report_json.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

std::string BandName(std::size_t band) {
  const std::vector<double> ends = MapBands();
  return band < ends.size() ? "< " + ReadableSeconds(ends[band])
                            : "≥ " + ReadableSeconds(ends.back());
}

std::size_t BandOf(const MapUpdateRow& row) {
  const std::vector<double> ends = MapBands();
  return static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), row.seconds) -
                                  ends.begin());
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

// Figure 2.5: what a method took in all, by how long its updates took.
std::string BandChart(const MapReport& report) {
  BarChart chart;
  chart.title = "Time in all, by how long an update took";
  for (std::size_t band = 0; band <= MapBands().size(); ++band)
    chart.parts.push_back(BandName(band));
  for (const MapRun& run : report.runs) chart.bars.push_back({run.method, SecondsInBands(run)});
  return html::Figure(DrawBars(chart));
}

// Figures 2.5 to 2.7.
std::string TimeCharts(const MapReport& report) {
  CurveChart each, cumulative;
  each.title = "Time of each update (dashed: mean)";
  cumulative.title = "Cumulative time";
  for (CurveChart* chart : {&each, &cumulative}) {
    chart->x_label = "time of the log [s]";
    chart->y_label = "time [s]";
  }
  cumulative.y_scale = AxisScale::kLinear;
  for (const MapRun& run : report.runs) {
    Curve one{run.method, {}, TimesOf(run).mean}, sum{run.method, {}};
    double total = 0;
    for (const MapUpdateRow& row : run.updates) {
      total += row.seconds;
      one.points.push_back({row.time, row.seconds});
      sum.points.push_back({row.time, total});
    }
    each.curves.push_back(std::move(one));
    cumulative.curves.push_back(std::move(sum));
  }
  return html::Figure(DrawCurves(each)) + html::Figure(DrawCurves(cumulative));
}

// Figure 2.8.  Methods that draw the same slices anew share a curve.
std::string NodeChart(const MapReport& report) {
  CurveChart chart;
  chart.title = "Nodes, cover, and nodes drawn anew";
  chart.x_label = "time of the log [s]";
  chart.y_label = "nodes";
  chart.y_scale = AxisScale::kLinear;
  const auto curve = [](const MapRun& run, std::size_t MapUpdateRow::*what) {
    Curve line;
    for (const MapUpdateRow& row : run.updates)
      line.points.push_back({row.time, static_cast<double>(row.*what)});
    return line;
  };
  const auto by_cover = [](const MapRun& run) {
    return run.updates.empty() ? 0 : run.updates.back().nodes - run.updates.back().cover;
  };
  const MapRun& covered = *std::max_element(
      report.runs.begin(), report.runs.end(),
      [&](const MapRun& a, const MapRun& b) { return by_cover(a) < by_cover(b); });
  chart.curves = {curve(covered, &MapUpdateRow::nodes), curve(covered, &MapUpdateRow::cover)};
  chart.curves[0].name = "nodes";
  chart.curves[1].name = "cover";
  std::vector<Curve> anew;
  for (const MapRun& run : report.runs) {
    Curve line = curve(run, &MapUpdateRow::regenerated_nodes);
    if (std::none_of(line.points.begin(), line.points.end(),
                     [](const Curve::Point& point) { return point.y > 0; }))
      continue;
    const auto same = std::find_if(anew.begin(), anew.end(), [&](const Curve& other) {
      return std::equal(
          line.points.begin(), line.points.end(), other.points.begin(), other.points.end(),
          [](const Curve::Point& a, const Curve::Point& b) { return a.x == b.x && a.y == b.y; });
    });
    if (same != anew.end()) {
      same->name += ", " + run.method;
      continue;
    }
    line.name = "drawn anew: " + run.method;
    anew.push_back(std::move(line));
  }
  if (anew.size() == 1) anew.front().name = "drawn anew";
  chart.curves.insert(chart.curves.end(), anew.begin(), anew.end());
  return html::Figure(DrawCurves(chart));
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
  std::vector<std::size_t> counts(MapBands().size() + 1, 0);
  for (const MapUpdateRow& row : run.updates) ++counts[BandOf(row)];
  return counts;
}

std::vector<double> SecondsInBands(const MapRun& run) {
  std::vector<double> seconds(MapBands().size() + 1, 0);
  for (const MapUpdateRow& row : run.updates) seconds[BandOf(row)] += row.seconds;
  return seconds;
}

std::string MapReportHtml(const MapReport& report, const std::string& map_svg) {
  std::vector<std::vector<html::Cell>> facts;
  for (const auto& [name, value] : report.facts) facts.push_back({{name, "name"}, {value}});
  std::string body =
      html::Table({{"", false}, {"", false}}, facts) + html::Section("Map", html::Figure(map_svg));
  if (!report.runs.empty())
    body += html::Section("Updates", MethodTable(report) + BandChart(report) + TimeCharts(report) +
                                         NodeChart(report));
  if (!report.warnings.empty()) body += html::Section("Warnings", html::List(report.warnings));
  return html::Page(report.title, "<h1>" + EscapeXml(report.title) + "</h1>\n", body);
}

std::string MapReportJson(const MapReport& report) {
  nlohmann::ordered_json json = {{"schema", "graticule-map/1"}, {"title", report.title}};
  // Facts without a name go on with the one before, and are told by members of their own.
  for (const auto& [name, value] : report.facts)
    if (!name.empty()) json["facts"][name] = value;
  json["runs"] = nlohmann::ordered_json::array();
  for (const MapRun& run : report.runs) json["runs"].push_back(Json(run));
  if (report.accuracy)
    json["accuracy"] = nlohmann::ordered_json::parse(AccuracyJson(report.accuracy));
  json["warnings"] = report.warnings;
  return JsonText(json, 2) + "\n";
}

}  // namespace graticule
