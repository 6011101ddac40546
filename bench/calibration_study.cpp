// The thesis' study of people who calibrate cameras (section 5.4 and 5.5), simulated: prints the
// tables of docs/calibration_uncertainty.md.  Usage: graticule_calibration_study [trials]
// [sigma_px]

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/study.hpp"

namespace graticule {
namespace {

int trials = 100;
double sigma_px = 0.2;

double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1) + .5)];
}

template <class Get>
std::vector<double> Of(const std::vector<StudyTrial>& of, Get get) {
  std::vector<double> values;
  for (const StudyTrial& trial : of) values.push_back(get(trial));
  return values;
}

double Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value / static_cast<double>(values.size());
  return sum;
}

double Deviation(const std::vector<double>& values) {
  const double mean = Mean(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

StudyOptions Options(const StudyLens& lens, Strategy strategy) {
  StudyOptions options;
  options.lens = lens;
  options.strategy = strategy;
  options.trials = trials;
  options.sigma_px = sigma_px;
  options.frames = strategy == Strategy::kSuggestions ? 8 : 32;
  return options;
}

void FramesToOnePixel() {
  fmt::print("\n## Frames until the true largest error stays below 1 px\n\n");
  fmt::print(
      "| lens | who | there after 32 (8) frames | median | 95 % of trials | below 1 px after 4, 6, "
      "8 frames |\n|---|---|---|---|---|---|\n");
  for (const StudyLens& lens : StudyLenses())
    for (const Strategy strategy :
         {Strategy::kSuggestions, Strategy::kRosRules, Strategy::kNovice}) {
      const auto run = RunStudy(Options(lens, strategy));
      std::vector<double> needed;
      double there = 0, below[3] = {};
      for (const StudyTrial& trial : run) {
        const std::size_t count = FramesNeeded(trial, 1);
        there += count > 0;
        needed.push_back(count > 0 ? static_cast<double>(count) : HUGE_VAL);
        for (int i = 0; i < 3; ++i) below[i] += trial.frames[3 + 2 * i].true_max_px < 1;
      }
      const auto shown = [](double count) {
        return std::isfinite(count) ? fmt::format("{:.0f}", count) : std::string("not there");
      };
      const double share = 100. / static_cast<double>(run.size());
      fmt::print("| {} | {} | {:.0f} % | {} | {} | {:.0f} %, {:.0f} %, {:.0f} % |\n", lens.name,
                 NameOf(strategy), there * share, shown(Quantile(needed, .5)),
                 shown(Quantile(needed, .95)), below[0] * share, below[1] * share,
                 below[2] * share);
      std::fflush(stdout);
    }
}

void Table51() {
  fmt::print(
      "\n## Table 5.1 and Figure 5.5 in kind: lens c, truth known, no noise in the test set\n\n");
  fmt::print(
      "| who | model | frames | test mean | test max (mean over trials) | worst trial | fx mean +- "
      "deviation | cx mean +- deviation |\n|---|---|---|---|---|---|---|---|\n");
  struct Row {
    Strategy strategy;
    const char* model;
    std::size_t frames;
  };
  for (const Row& row :
       {Row{Strategy::kNovice, "radial3", 13}, Row{Strategy::kNovice, "angular4", 13},
        Row{Strategy::kRosRules, "radial3", 13}, Row{Strategy::kRosRules, "angular4", 13},
        Row{Strategy::kSuggestions, "radial3", 7}, Row{Strategy::kSuggestions, "angular4", 7}}) {
    StudyOptions options = Options(StudyLenses()[2], row.strategy);
    options.session.calibration.model = row.model;
    options.frames = row.frames;
    const auto run = RunStudy(options);
    const auto worst = Of(run, [](const StudyTrial& t) { return t.frames.back().test.max_px; });
    const auto fx = Of(run, [](const StudyTrial& t) { return t.camera.parameters[0]; });
    const auto cx = Of(run, [](const StudyTrial& t) { return t.camera.parameters[2]; });
    fmt::print(
        "| {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} +- {:.2f} | {:.2f} +- {:.2f} |\n",
        NameOf(row.strategy), row.model, row.frames,
        Mean(Of(run, [](const StudyTrial& t) { return t.frames.back().test.mean_px; })),
        Mean(worst), Quantile(worst, 1), Mean(fx), Deviation(fx), Mean(cx), Deviation(cx));
    std::fflush(stdout);
  }
}

void Figures57And58() {
  fmt::print(
      "\n## Figures 5.7 and 5.8: Max ERE against test error, following suggestions\n\n"
      "| lens | rank correlation with the 99.5th percentile | the same, raw | with the true "
      "maximum "
      "| Max ERE / 99.5th percentile, median | after 8 frames: test mean | 99.5th percentile | max "
      "| "
      "Max ERE |\n|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> all_ere, all_raw, all_p995, all_max;
  std::vector<std::vector<double>> ere_by_frame(8), p995_by_frame(8);
  const auto row = [](const std::string& name, const std::vector<double>& ere,
                      const std::vector<double>& raw, const std::vector<double>& p995,
                      const std::vector<double>& largest) {
    std::vector<double> ratio;
    for (std::size_t i = 0; i < ere.size(); ++i) ratio.push_back(ere[i] / p995[i]);
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |", name, RankCorrelation(ere, p995),
               RankCorrelation(raw, p995), RankCorrelation(ere, largest), Quantile(ratio, .5));
  };
  for (const StudyLens& lens : StudyLenses()) {
    StudyOptions options = Options(lens, Strategy::kSuggestions);
    options.test_every_frame = true;
    const auto run = RunStudy(options);
    std::vector<double> ere, raw, p995, largest;
    for (const StudyTrial& trial : run)
      for (std::size_t i = 0; i < trial.frames.size(); ++i) {
        const StudyFrame& frame = trial.frames[i];
        ere_by_frame[i].push_back(frame.max_ere_px);
        p995_by_frame[i].push_back(frame.test.p995_px);
        if (frame.is_bootstrapping) continue;
        ere.push_back(frame.max_ere_px);
        raw.push_back(frame.raw_max_ere_px);
        p995.push_back(frame.test.p995_px);
        largest.push_back(frame.true_max_px);
      }
    row(lens.name, ere, raw, p995, largest);
    const auto last = [&](double TestError::*field) {
      return Mean(Of(run, [&](const StudyTrial& t) { return t.frames.back().test.*field; }));
    };
    fmt::print(" {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n", last(&TestError::mean_px),
               last(&TestError::p995_px), last(&TestError::max_px),
               Mean(Of(run, [](const StudyTrial& t) { return t.frames.back().max_ere_px; })));
    std::fflush(stdout);
    all_ere.insert(all_ere.end(), ere.begin(), ere.end());
    all_raw.insert(all_raw.end(), raw.begin(), raw.end());
    all_p995.insert(all_p995.end(), p995.begin(), p995.end());
    all_max.insert(all_max.end(), largest.begin(), largest.end());
  }
  row("all", all_ere, all_raw, all_p995, all_max);
  fmt::print(
      " | | | |\n\n| frames | Max ERE, median | 99.5th percentile, median |\n|---|---|---|\n");
  for (std::size_t i = 0; i < 8; ++i)
    fmt::print("| {} | {:.3f} | {:.3f} |\n", i + 1, Quantile(ere_by_frame[i], .5),
               Quantile(p995_by_frame[i], .5));
}

void CoverageOfTheTruth() {
  fmt::print(
      "\n## The truth in the 95 % region of the parameters, 500 trials\n\n| lens | inside | "
      "mean squared Mahalanobis distance a parameter |\n|---|---|---|\n");
  const Registry types = Builtins();
  for (const StudyLens& lens : StudyLenses()) {
    CoverageOptions options;
    options.lens = lens;
    options.sigma_px = sigma_px;
    const Coverage coverage = MeasureCoverage(types, options);
    fmt::print("| {} | {:.1f} % | {:.3f} |\n", lens.name, 100. * coverage.inside / coverage.trials,
               coverage.mean_squared);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  if (argc > 1) trials = std::max(2, std::atoi(argv[1]));
  if (argc > 2) sigma_px = std::atof(argv[2]);
  const auto start = std::chrono::steady_clock::now();
  fmt::print("{} trials, pixel noise {} px\n", trials, sigma_px);
  CoverageOfTheTruth();
  Figures57And58();
  Table51();
  FramesToOnePixel();
  fmt::print(stderr, "{:.0f} s\n",
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}
