#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/segment_report.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "numbers.hpp"
#include "problem.hpp"
#include "segment_choosing.hpp"

namespace graticule::apps {
namespace {

constexpr std::size_t kMostRuns = 100000;

struct Sweep {
  const SegmentParameter* parameter;
  std::vector<double> values;
};

Sweep SweepOf(const std::string& words) {
  const std::size_t equals = words.find('=');
  if (equals == std::string::npos)
    throw Error("--sweep: expected NAME=VALUE,VALUE,..., found '" + words + "'", ErrorKind::kUsage);
  Sweep sweep{&ParameterOf(words.substr(0, equals)), {}};
  const SegmentParameter& parameter = *sweep.parameter;
  const auto commas = static_cast<std::size_t>(std::count(words.begin(), words.end(), ','));
  const std::vector<double> numbers =
      ReadNumbers("--sweep", words.substr(equals + 1), commas + 1, "numbers between commas");
  for (const double value : numbers) {
    if (!parameter.Allows(value))
      throw Error(fmt::format("--sweep: {} is not allowed for {}", value, parameter.name),
                  ErrorKind::kUsage);
    sweep.values.push_back(value);
  }
  std::sort(sweep.values.begin(), sweep.values.end());
  sweep.values.erase(std::unique(sweep.values.begin(), sweep.values.end()), sweep.values.end());
  return sweep;
}

std::vector<PointCloud> ReadScans(const SegmentEvaluateCommand& command) {
  if (!command.truth.empty() && command.truth.size() != command.scans.size())
    throw Error(fmt::format("--truth: expected {} files, one a scan, found {}",
                            command.scans.size(), command.truth.size()),
                ErrorKind::kUsage);
  std::vector<PointCloud> scans;
  for (std::size_t i = 0; i < command.scans.size(); ++i) {
    PointCloud scan = ReadCloud(command.scans[i]);
    if (!command.truth.empty()) {
      PointCloud truth = ReadCloud(command.truth[i]);
      if (truth.width != scan.width || truth.height != scan.height)
        throw Error(fmt::format("{}: {} x {} points; {} has {} x {}", command.truth[i], truth.width,
                                truth.height, command.scans[i], scan.width, scan.height));
      scan.labels = std::move(truth.labels);
    }
    if (std::all_of(scan.labels.begin(), scan.labels.end(), [](auto label) { return label == 0; }))
      throw Error((command.truth.empty() ? command.scans[i] : command.truth[i]) +
                  ": expected labels: a field `label` that is not 0 everywhere");
    scans.push_back(std::move(scan));
  }
  return scans;
}

SegmentSweepRow RowOf(const SegmentEvaluateCommand& command, const std::vector<PointCloud>& scans,
                      const std::string& method, const SegmentChoosing& choosing) {
  std::vector<SegmentScore> scores;
  SegmentSweepRow row;
  row.method = method;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    Segmenter segmenter(OptionsOf(SegmentMethodOf(method), choosing, scans[i]));
    About(command.scans[i], [&] {
      const Stopwatch watch;
      const std::vector<std::uint32_t>& labels = segmenter.Segment(scans[i]);
      row.seconds += watch.Elapsed().cpu;
      ScoreOptions options;
      options.least_object = static_cast<std::uint32_t>(command.least_object);
      options.width = scans[i].width;
      scores.push_back(ScoreOf(scans[i].labels, labels, options));
      return 0;
    });
  }
  const SegmentScore mean = MeanOf(scores);
  const double count = static_cast<double>(scans.size());
  row.seconds /= count;
  row.weighted_overlap = mean.weighted_overlap;
  row.achievable = mean.achievable;
  row.under_segmentation = mean.under_segmentation;
  row.boundary_recall = mean.boundary_recall;
  row.mean_f = mean.mean_f;
  row.found = mean.found;
  row.segments = static_cast<double>(mean.segments) / count;
  return row;
}

// Every combination of what matters to the method, the last parameter fastest.
void SweepMethod(const SegmentEvaluateCommand& command, const std::vector<PointCloud>& scans,
                 const std::string& method, const std::vector<Sweep>& sweeps,
                 std::vector<SegmentSweepRow>* rows) {
  const SegmentMethod which = SegmentMethodOf(method);
  std::size_t runs = 1;
  for (const Sweep& sweep : sweeps)
    if (sweep.parameter->matters(which)) runs *= sweep.values.size();
  for (std::size_t run = 0; run < runs; ++run) {
    SegmentChoosing choosing = command.choosing;
    std::vector<double> values(sweeps.size(), std::numeric_limits<double>::quiet_NaN());
    std::size_t left = run;
    for (std::size_t k = sweeps.size(); k-- > 0;) {
      if (!sweeps[k].parameter->matters(which)) continue;
      values[k] = sweeps[k].values[left % sweeps[k].values.size()];
      choosing.*sweeps[k].parameter->number = values[k];
      left /= sweeps[k].values.size();
    }
    rows->push_back(RowOf(command, scans, method, choosing));
    rows->back().values = values;
  }
}

std::string ValuesOf(const SegmentSweepReport& report, const SegmentSweepRow& row) {
  std::string text;
  for (std::size_t k = 0; k < row.values.size(); ++k)
    if (std::isfinite(row.values[k]))
      text +=
          fmt::format("{}{} {:g}", text.empty() ? "" : ", ", report.parameters[k], row.values[k]);
  return text;
}

void Print(const SegmentSweepReport& report) {
  std::size_t wide = 10;
  for (const SegmentSweepRow& row : report.rows)
    wide = std::max(wide, ValuesOf(report, row).size());
  if (report.parameters.empty()) wide = 0;
  fmt::print("{:<8} {:<{}} {:>7} {:>10} {:>9} {:>8} {:>6} {:>6} {:>8} {:>8}\n", "method",
             report.parameters.empty() ? "" : "parameters", wide, "overlap", "achievable",
             "undersegm", "boundary", "F", "found", "segments", "CPU ms");
  const auto print = [&](const SegmentSweepRow& row) {
    fmt::print("{:<8} {:<{}} {:7.3f} {:10.3f} {:9.3f} {:8.3f} {:6.3f} {:6.3f} {:8.1f} {:8.1f}\n",
               row.method, ValuesOf(report, row), wide, row.weighted_overlap, row.achievable,
               row.under_segmentation, row.boundary_recall, row.mean_f, row.found, row.segments,
               1e3 * row.seconds);
  };
  for (const SegmentSweepRow& row : report.rows) print(row);
  if (report.parameters.empty()) return;
  fmt::print("best mean of overlap and F:\n");
  for (const SegmentSweepRow* row : BestOfEachMethod(report)) print(*row);
}

nlohmann::ordered_json JsonOf(const SegmentSweepReport& report) {
  nlohmann::ordered_json json = {{"schema", "graticule-segment-evaluation/1"},
                                 {"scans", report.scans},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const SegmentSweepRow& row : report.rows) {
    nlohmann::ordered_json entry = {{"method", row.method}};
    for (std::size_t k = 0; k < row.values.size(); ++k)
      if (std::isfinite(row.values[k])) entry["parameters"][report.parameters[k]] = row.values[k];
    entry["weighted_overlap"] = row.weighted_overlap;
    entry["achievable_accuracy"] = row.achievable;
    entry["under_segmentation_error"] = row.under_segmentation;
    entry["boundary_recall"] = row.boundary_recall;
    entry["mean_f"] = row.mean_f;
    entry["found"] = row.found;
    entry["segments"] = row.segments;
    entry["cpu_seconds"] = row.seconds;
    json["rows"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace

int Run(const SegmentEvaluateCommand& command, const Console& console) {
  for (const std::string& method : command.methods) SegmentMethodOf(method);
  std::vector<Sweep> sweeps;
  SegmentSweepReport report;
  std::size_t runs = command.methods.size();
  for (const std::string& words : command.sweeps) {
    sweeps.push_back(SweepOf(words));
    const std::string name = sweeps.back().parameter->name;
    if (std::count(report.parameters.begin(), report.parameters.end(), name) > 0)
      throw Error("--sweep: " + name + " is there twice", ErrorKind::kUsage);
    report.parameters.push_back(name);
    runs *= sweeps.back().values.size();
    if (runs > kMostRuns)
      throw Error(fmt::format("--sweep: expected at most {} combinations", kMostRuns),
                  ErrorKind::kUsage);
  }
  if (!command.plot.empty()) {
    ExpectEnding(command.plot, "--plot", {".svg", ".png"});
    if (sweeps.empty()) throw Error("--plot: expected --sweep with it", ErrorKind::kUsage);
    ExpectWritable(command.plot);
  }
  if (!command.report.empty()) {
    ExpectEnding(command.report, "--report", {".html"});
    ExpectWritable(command.report);
  }
  const std::vector<PointCloud> scans = ReadScans(command);
  report.scans = command.scans;
  for (const std::string& method : command.methods)
    SweepMethod(command, scans, method, sweeps, &report.rows);
  if (!command.plot.empty()) {
    const std::string svg = SegmentSweepSvg(report);
    WriteFile(command.plot, Ending(command.plot) == ".png" ? PngFromSvg(svg, 1000) : svg);
    console.Note("wrote " + command.plot);
  }
  if (!command.report.empty()) {
    WriteFile(command.report, SegmentSweepHtml(report));
    console.Note("wrote " + command.report);
  }
  if (command.json)
    fmt::print("{}\n", JsonText(JsonOf(report), 2));
  else
    Print(report);
  return kDone;
}

}  // namespace graticule::apps
