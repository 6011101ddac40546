#include "calibration_figures.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>

#include "graticule/io/chart.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/svg.hpp"

namespace graticule {
namespace {

void Write(const std::string& folder, const std::string& name, const CurveChart& chart) {
  const std::string svg = DrawCurves(chart);
  WriteFile(folder + "/" + name + ".svg", svg);
  WriteFile(folder + "/" + name + ".png", PngFromSvg(svg, 1000));
}

// A number of the trials after each frame: mean, and its standard error around it.
struct Series {
  Curve curve;
  CurveBand band;
};

Series SeriesOf(const std::string& name, const std::vector<const StudyTrial*>& trials,
                std::size_t number, const std::function<double(const StudyFrame&)>& get) {
  Series series;
  series.curve.name = name;
  series.band.curve = number;
  for (std::size_t k = 0; k < trials.front()->frames.size(); ++k) {
    double sum = 0, squares = 0, count = 0;
    for (const StudyTrial* trial : trials) {
      if (k >= trial->frames.size() || trial->frames[k].is_bootstrapping) continue;
      const double value = get(trial->frames[k]);
      sum += value;
      squares += value * value;
      ++count;
    }
    if (count < static_cast<double>(trials.size()) / 2) continue;
    const double mean = sum / count, x = static_cast<double>(k + 1);
    const double error = std::sqrt(std::max(0., squares / count - mean * mean) / count);
    series.curve.points.push_back({x, mean});
    series.band.points.push_back({x, mean - error, mean + error});
  }
  return series;
}

// The thesis' own form: what is said and what a test set shows, after every frame.
CurveChart ErrorsByFrame(const std::vector<LensRuns>& all) {
  std::vector<const StudyTrial*> trials;
  for (const LensRuns& runs : all)
    for (const StudyTrial& trial : runs.by[0]) trials.push_back(&trial);
  CurveChart chart;
  chart.title = "Figure 5.7 in kind: Max ERE and test errors, frames by suggestion, six lenses";
  chart.x_label = "frames";
  chart.y_label = "error [px]";
  chart.y_scale = AxisScale::kLogarithmic;
  chart.whole_x = true;
  chart.height = 380;
  const std::pair<const char*, double (*)(const StudyFrame&)> kinds[] = {
      {"Max ERE", [](const StudyFrame& f) { return f.max_ere_px; }},
      {"test, max", [](const StudyFrame& f) { return f.test.max_px; }},
      {"test, 99.5th percentile", [](const StudyFrame& f) { return f.test.percentile_995_px; }},
      {"test, mean", [](const StudyFrame& f) { return f.test.mean_px; }}};
  for (const auto& [name, get] : kinds) {
    Series series = SeriesOf(name, trials, chart.curves.size(), get);
    chart.curves.push_back(std::move(series.curve));
    chart.bands.push_back(std::move(series.band));
  }
  chart.note =
      fmt::format("Means over {} trials; bands: standard error of the mean.", trials.size());
  return chart;
}

CurveChart ErePairs(const std::vector<LensRuns>& all) {
  CurveChart chart;
  chart.title = "Figure 5.7 in kind: Max ERE against the 99.5th percentile of test error";
  chart.x_label = "Max ERE [px]";
  chart.y_label = "99.5th percentile on the test set [px]";
  chart.x_scale = chart.y_scale = AxisScale::kLogarithmic;
  chart.width = 620;
  chart.height = 520;
  FrameMeans total;
  for (const LensRuns& runs : all) {
    FrameMeans means;
    for (const auto& run : runs.by) {
      means.Add(run);
      total.Add(run);
    }
    Curve curve;
    curve.name = runs.lens.name;
    curve.dots = true;
    for (std::size_t i = 0; i < means.ere.size(); ++i)
      curve.points.push_back({means.ere[i], means.p995[i]});
    chart.curves.push_back(std::move(curve));
  }
  double low = HUGE_VAL, high = 0;
  for (std::size_t i = 0; i < total.ere.size(); ++i) {
    low = std::min(low, std::max(total.ere[i], total.p995[i]));
    high = std::max(high, std::min(total.ere[i], total.p995[i]));
  }
  chart.curves.push_back({"equal", {{low, low}, {high, high}}});
  chart.note = fmt::format(
      "Means by lens, person (suggestions, ROS' rules, novices) and frames; rank correlation "
      "{:.3f}.",
      RankCorrelation(total.ere, total.p995));
  return chart;
}

CurveChart Spreads(const std::vector<ParameterSpread>& spreads) {
  CurveChart chart;
  chart.title = "Figure 5.5 in kind: focal length and centre of each trial";
  chart.x_label = "fx [px]";
  chart.y_label = "cx [px]";
  chart.y_scale = AxisScale::kLinear;
  chart.width = 620;
  chart.height = 460;
  for (const ParameterSpread& spread : spreads) {
    Curve curve;
    curve.name = spread.name;
    curve.dots = true;
    for (const StudyTrial& trial : spread.run)
      curve.points.push_back({trial.camera.parameters[0], trial.camera.parameters[2]});
    chart.curves.push_back(std::move(curve));
  }
  const CameraIntrinsics truth = StudyLenses()[2].camera;
  chart.guides = {{true, truth.parameters[0], "truth"}, {false, truth.parameters[2], ""}};
  return chart;
}

}  // namespace

void FrameMeans::Add(const std::vector<StudyTrial>& run) {
  for (std::size_t k = 0; k < run.front().frames.size(); ++k) {
    double e = 0, p = 0, l = 0, count = 0;
    for (const StudyTrial& trial : run) {
      if (k >= trial.frames.size() || trial.frames[k].is_bootstrapping) continue;
      e += trial.frames[k].max_ere_px;
      p += trial.frames[k].test.percentile_995_px;
      l += trial.frames[k].true_max_px;
      ++count;
    }
    if (count < static_cast<double>(run.size()) / 2) continue;
    frames.push_back(static_cast<double>(k + 1));
    ere.push_back(e / count);
    p995.push_back(p / count);
    largest.push_back(l / count);
  }
}

void WriteFigures(const std::string& folder, const std::vector<LensRuns>& all,
                  const std::vector<ParameterSpread>& spreads) {
  Write(folder, "figure_5_5", Spreads(spreads));
  Write(folder, "figure_5_7", ErrorsByFrame(all));
  Write(folder, "figure_5_7_pairs", ErePairs(all));
}

}  // namespace graticule
