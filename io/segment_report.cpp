#include "graticule/io/segment_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "graticule/io/base64.hpp"
#include "graticule/io/chart.hpp"
#include "graticule/io/html.hpp"
#include "graticule/io/readable.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

// A chart is higher than it says by its title, and a legend of one row.
constexpr double kChartWidth = 560, kChartHeight = 250, kChartPitch = kChartHeight + 40;

struct Score {
  const char *name, *hint;
  double SegmentSweepRow::*value;
  bool less_is_better = false;
};

constexpr std::array<Score, 5> kScores = {{
    {"weighted overlap", "of each object's best segment, by the objects' sizes",
     &SegmentSweepRow::weighted_overlap},
    {"F of objects", "of each object's best segment, mean over objects", &SegmentSweepRow::mean_f},
    {"achievable accuracy", "points that were right if each segment had its best label",
     &SegmentSweepRow::achievable},
    {"under-segmentation error", "points that spill over objects' borders",
     &SegmentSweepRow::under_segmentation, true},
    {"boundary recall", "borders of objects that a border of segments is near",
     &SegmentSweepRow::boundary_recall},
}};

double Merit(const SegmentSweepRow& row) { return row.weighted_overlap + row.mean_f; }

std::vector<std::string> MethodsOf(const SegmentSweepReport& report) {
  std::vector<std::string> methods;
  for (const SegmentSweepRow& row : report.rows)
    if (std::find(methods.begin(), methods.end(), row.method) == methods.end())
      methods.push_back(row.method);
  return methods;
}

// Of a method, by the values of a parameter: the best row of each.  A method that has not the
// parameter is everywhere the same.
std::map<double, const SegmentSweepRow*> ProfileOf(const SegmentSweepReport& report,
                                                   const std::string& method,
                                                   std::size_t parameter) {
  std::map<double, const SegmentSweepRow*> profile;
  for (const SegmentSweepRow& row : report.rows)
    if (std::isfinite(row.values[parameter])) profile[row.values[parameter]] = nullptr;
  for (const SegmentSweepRow& row : report.rows) {
    if (row.method != method) continue;
    for (auto& [value, best] : profile)
      if ((row.values[parameter] == value || std::isnan(row.values[parameter])) &&
          (best == nullptr || Merit(row) > Merit(*best)))
        best = &row;
  }
  return profile;
}

std::string ChartOf(const SegmentSweepReport& report, std::size_t parameter, const Score& score) {
  CurveChart chart;
  chart.title = score.name;
  if (score.less_is_better) chart.title += " (less is better)";
  chart.x_label = report.parameters[parameter];
  chart.y_label = score.name;
  chart.y_scale = AxisScale::kLinear;
  chart.width = kChartWidth;
  chart.height = kChartHeight;
  double least = HUGE_VAL, most = 0;
  for (const std::string& method : MethodsOf(report)) {
    Curve curve;
    curve.name = method;
    for (const auto& [value, row] : ProfileOf(report, method, parameter)) {
      if (row == nullptr) continue;
      curve.points.push_back({value, row->*score.value});
      least = std::min(least, value);
      most = std::max(most, value);
    }
    chart.curves.push_back(std::move(curve));
  }
  if (least > 0 && most >= 10 * least) chart.x_scale = AxisScale::kLogarithmic;
  return DrawCurves(chart);
}

std::string RowsTable(const SegmentSweepReport& report,
                      const std::vector<const SegmentSweepRow*>& rows) {
  std::vector<html::Column> columns = {{"method"}};
  for (const std::string& parameter : report.parameters) columns.push_back({parameter, true});
  for (const Score& score : kScores) columns.push_back({score.name, true, score.hint});
  columns.push_back({"found", true, "objects with an overlap above one half"});
  columns.push_back({"segments", true, "a scan, that labelled points are in"});
  columns.push_back({"CPU", true, "a scan"});
  std::vector<std::vector<html::Cell>> cells;
  for (const SegmentSweepRow* row : rows) {
    std::vector<html::Cell> line = {{row->method, "name"}};
    for (const double value : row->values)
      line.push_back({std::isfinite(value) ? ReadableNumber(value) : ""});
    for (const Score& score : kScores) {
      double best = row->*score.value;
      for (const SegmentSweepRow* other : rows)
        best = score.less_is_better ? std::min(best, other->*score.value)
                                    : std::max(best, other->*score.value);
      line.push_back(
          {ReadableNumber(row->*score.value, 3), row->*score.value == best ? "best" : ""});
    }
    line.push_back({ReadableNumber(row->found, 3)});
    line.push_back({ReadableNumber(row->segments, 3)});
    line.push_back({ReadableSeconds(row->seconds)});
    cells.push_back(std::move(line));
  }
  return html::Table(columns, cells);
}

std::string FactsTable(const std::vector<std::pair<std::string, std::string>>& facts) {
  std::vector<std::vector<html::Cell>> rows;
  for (const auto& [name, value] : facts) rows.push_back({{name, "name"}, {value}});
  return html::Table({{""}, {""}}, rows);
}

std::string PageOf(const std::string& title, const std::string& body) {
  return html::Page(title, "<h1>" + EscapeXml(title) + "</h1>\n", body);
}

}  // namespace

std::vector<const SegmentSweepRow*> BestOfEachMethod(const SegmentSweepReport& report) {
  std::vector<const SegmentSweepRow*> best;
  for (const SegmentSweepRow& row : report.rows) {
    if (best.empty() || best.back()->method != row.method)
      best.push_back(&row);
    else if (Merit(row) > Merit(*best.back()))
      best.back() = &row;
  }
  return best;
}

std::string SegmentSweepSvg(const SegmentSweepReport& report) {
  Svg svg(kChartWidth * static_cast<double>(report.parameters.size()),
          kChartPitch * static_cast<double>(kScores.size()), "scores of segmentation");
  for (std::size_t p = 0; p < report.parameters.size(); ++p)
    for (std::size_t s = 0; s < kScores.size(); ++s)
      svg.Nest(kChartWidth * static_cast<double>(p), kChartPitch * static_cast<double>(s),
               ChartOf(report, p, kScores[s]));
  return svg.Finish();
}

std::string SegmentSweepHtml(const SegmentSweepReport& report) {
  std::vector<const SegmentSweepRow*> all;
  for (const SegmentSweepRow& row : report.rows) all.push_back(&row);
  std::string body;
  if (!report.parameters.empty()) {
    body += html::Section("Best of each method",
                          html::Paragraph("By the mean of weighted overlap and F.", "soft") +
                              RowsTable(report, BestOfEachMethod(report)));
    std::string charts;
    if (report.parameters.size() > 1)
      charts += html::Paragraph(
          "At each value of a parameter, the best combination with the others.", "soft");
    for (std::size_t p = 0; p < report.parameters.size(); ++p)
      for (const Score& score : kScores) charts += html::Figure(ChartOf(report, p, score));
    body += html::Section("Scores by parameter", charts);
  }
  body += html::Section("All", RowsTable(report, all));
  body += html::Section("Scans", html::List(report.scans));
  return PageOf("Segmentation held against labels", body);
}

std::string SegmentReportHtml(const SegmentReport& report) {
  std::string pictures;
  for (const SegmentReport::Picture& picture : report.pictures) {
    const double width = static_cast<double>(picture.width);
    const double height = static_cast<double>(picture.height);
    Svg svg(width, height, picture.title);
    svg.Element("image", {{"width", SvgNumber(width)},
                          {"height", SvgNumber(height)},
                          {"href", "data:image/png;base64," + Base64(picture.png)}});
    pictures += html::Paragraph(picture.title) + html::Figure(svg.Finish());
  }
  std::vector<SegmentReport::Segment> segments = report.segments;
  std::stable_sort(segments.begin(), segments.end(),
                   [](const auto& a, const auto& b) { return a.points > b.points; });
  std::vector<std::vector<html::Cell>> rows;
  for (const SegmentReport::Segment& segment : segments)
    rows.push_back({{ReadableCount(segment.label)},
                    {ReadableCount(segment.points), "",
                     static_cast<double>(segment.points) / static_cast<double>(segments[0].points)},
                    {segment.centre},
                    {segment.extent},
                    {ReadableNumber(segment.off_plane_m, 3)},
                    {segment.mean_colour}});
  const std::string table = html::Table({{"segment", true},
                                         {"points", true},
                                         {"centre [m]", true},
                                         {"extent [m]", true},
                                         {"off its plane [m]", true, "root mean square"},
                                         {"mean colour"}},
                                        rows);
  return PageOf(report.title, FactsTable(report.facts) + html::Section("Pictures", pictures) +
                                  html::Section("Segments", table));
}

}  // namespace graticule
