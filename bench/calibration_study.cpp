// The thesis' study of people who calibrate cameras (section 5.4 and 5.5), simulated: prints the
// tables of docs/calibration_uncertainty.md, and draws its figures into a folder.  Usage:
// graticule_calibration_study [trials] [sigma_px] [folder]

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "calibration_figures.hpp"
#include "graticule/factors/builtins.hpp"

namespace graticule {
namespace {

int trials = 25;
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
  // Who takes few frames gets more trials: the same work for everybody.
  options.trials = strategy == Strategy::kSuggestions ? 4 * trials : trials;
  options.sigma_px = sigma_px;
  options.frames = strategy == Strategy::kSuggestions ? 8 : 24;
  options.test_every_frame = true;
  return options;
}

std::vector<LensRuns> RunAll() {
  std::vector<LensRuns> all;
  for (const StudyLens& lens : StudyLenses()) {
    all.push_back({lens, {}});
    for (int i = 0; i < 3; ++i) all.back().by[i] = RunStudy(Options(lens, kStrategies[i]));
  }
  return all;
}

void FramesToOnePixel(const std::vector<LensRuns>& all) {
  fmt::print("\n## Frames until the true largest error stays below 1 px\n\n");
  fmt::print(
      "| lens | who | frames taken | there in the end | median | 95 % of trials | below 1 px after "
      "4, 6, 8 frames | told so (Max ERE), median |\n|---|---|---|---|---|---|---|---|\n");
  const auto shown = [](double count) {
    return std::isfinite(count) ? fmt::format("{:.0f}", count) : std::string("not there");
  };
  for (const LensRuns& runs : all)
    for (int i = 0; i < 3; ++i) {
      std::vector<double> needed, told;
      double there = 0, below[3] = {};
      for (const StudyTrial& trial : runs.by[i]) {
        const std::size_t count = FramesNeeded(trial, 1);
        there += count > 0;
        needed.push_back(count > 0 ? static_cast<double>(count) : HUGE_VAL);
        for (int k = 0; k < 3; ++k) below[k] += trial.frames[3 + 2 * k].true_max_px < 1;
        told.push_back(HUGE_VAL);
        for (std::size_t k = trial.frames.size(); k-- > 0;)
          if (trial.frames[k].is_met) told.back() = static_cast<double>(k + 1);
      }
      const double share = 100. / static_cast<double>(runs.by[i].size());
      fmt::print("| {} | {} | {} | {:.0f} % | {} | {} | {:.0f} %, {:.0f} %, {:.0f} % | {} |\n",
                 runs.lens.name, NameOf(kStrategies[i]), runs.by[i].front().frames.size(),
                 there * share, shown(Quantile(needed, .5)), shown(Quantile(needed, .95)),
                 below[0] * share, below[1] * share, below[2] * share, shown(Quantile(told, .5)));
    }
}

std::vector<ParameterSpread> Table51() {
  std::vector<ParameterSpread> spreads;
  fmt::print(
      "\n## Table 5.1 and Figure 5.5 in kind: lens c, truth known, no noise in the test set\n\n");
  fmt::print(
      "| who | model | frames | test mean, median over trials | test max, median | test max, worst "
      "trial | fx mean +- "
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
    options.test_every_frame = false;
    options.frames = row.frames;
    spreads.push_back({fmt::format("{}, {}", NameOf(row.strategy), row.model), RunStudy(options)});
    const std::vector<StudyTrial>& run = spreads.back().run;
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
  return spreads;
}

// Pairs of what the session says and what is true, after every frame past the bootstrap.
struct Pairs {
  std::vector<double> ere, raw, p995, largest, drawn;
  void Add(const StudyTrial& trial) {
    for (const StudyFrame& frame : trial.frames) {
      if (frame.is_bootstrapping) continue;
      ere.push_back(frame.max_ere_px);
      raw.push_back(frame.raw_max_ere_px);
      p995.push_back(frame.test.percentile_995_px);
      largest.push_back(frame.true_max_px);
      drawn.push_back(frame.drawn_max_px);
    }
  }
};

void PrintRow(const std::string& lens, const char* who, const Pairs& pairs) {
  double optimistic = 0;
  for (std::size_t i = 0; i < pairs.ere.size(); ++i) optimistic += pairs.p995[i] > pairs.ere[i];
  fmt::print("| {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.2f} % |\n", lens, who,
             pairs.ere.size(), RankCorrelation(pairs.ere, pairs.p995),
             RankCorrelation(pairs.raw, pairs.p995), RankCorrelation(pairs.ere, pairs.largest),
             RankCorrelation(pairs.ere, pairs.drawn),
             100 * optimistic / static_cast<double>(pairs.ere.size()));
}

void Figure57(const std::vector<LensRuns>& all) {
  fmt::print(
      "\n## Figure 5.7: Max ERE against test error\n\nMeans over trials, by lens, person and "
      "number "
      "of frames:\n\n| lens | who | points | rank correlation with the 99.5th percentile | with "
      "the "
      "true maximum |\n|---|---|---|---|---|\n");
  FrameMeans total, guided_means;
  const auto print = [](const std::string& lens, const char* who, const FrameMeans& means) {
    fmt::print("| {} | {} | {} | {:.3f} | {:.3f} |\n", lens, who, means.ere.size(),
               RankCorrelation(means.ere, means.p995), RankCorrelation(means.ere, means.largest));
  };
  for (const LensRuns& runs : all) {
    FrameMeans means;
    for (const auto& run : runs.by) {
      means.Add(run);
      total.Add(run);
    }
    guided_means.Add(runs.by[0]);
    print(runs.lens.name, "everybody", means);
  }
  print("all", "everybody", total);
  print("all", "suggestions", guided_means);

  fmt::print(
      "\nSingle calibrations:\n\n"
      "| lens | who | calibrations | rank correlation with the 99.5th percentile | the same, raw | "
      "with the true maximum | with that of a camera drawn from the posterior | the percentile "
      "above Max ERE |\n|---|---|---|---|---|---|---|---|\n");
  Pairs everything, guided;
  for (const LensRuns& runs : all) {
    Pairs everybody;
    for (const auto& run : runs.by)
      for (const StudyTrial& trial : run) {
        everybody.Add(trial);
        everything.Add(trial);
      }
    for (const StudyTrial& trial : runs.by[0]) guided.Add(trial);
    PrintRow(runs.lens.name, "everybody", everybody);
  }
  PrintRow("all", "everybody", everything);
  PrintRow("all", "suggestions", guided);

  fmt::print(
      "\n| frames | who | calibrations | Max ERE, median | true maximum, median | of a camera "
      "drawn "
      "from the posterior, median | 99.5th percentile, median |\n|---|---|---|---|---|---|---|\n");
  for (int i = 0; i < 3; ++i)
    for (const std::size_t count : {3u, 4u, 5u, 6u, 8u, 12u, 16u, 24u}) {
      Pairs pairs;
      for (const LensRuns& runs : all)
        for (const StudyTrial& trial : runs.by[i]) {
          if (count > trial.frames.size()) continue;
          StudyTrial only;
          only.frames = {trial.frames[count - 1]};
          pairs.Add(only);
        }
      if (pairs.ere.empty()) continue;
      fmt::print("| {} | {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n", count,
                 NameOf(kStrategies[i]), pairs.ere.size(), Quantile(pairs.ere, .5),
                 Quantile(pairs.largest, .5), Quantile(pairs.drawn, .5), Quantile(pairs.p995, .5));
    }
}

void Figure58(const std::vector<LensRuns>& all) {
  fmt::print(
      "\n## Figure 5.8: test error after 8 frames by suggestion\n\n| lens | mean | 99.5th "
      "percentile | max | Max ERE | largest difference to the truth "
      "|\n|---|---|---|---|---|---|\n");
  for (const LensRuns& runs : all) {
    const auto last = [&](auto get) {
      return Mean(Of(runs.by[0], [&](const StudyTrial& t) { return get(t.frames.back()); }));
    };
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n", runs.lens.name,
               last([](const StudyFrame& f) { return f.test.mean_px; }),
               last([](const StudyFrame& f) { return f.test.percentile_995_px; }),
               last([](const StudyFrame& f) { return f.test.max_px; }),
               last([](const StudyFrame& f) { return f.max_ere_px; }),
               last([](const StudyFrame& f) { return f.true_max_px; }));
  }
}

void BentBoard() {
  fmt::print(
      "\n## A bent board (0.45 mm in its middle), lens c, 8 frames by suggestion\n\n| board taken "
      "as | Max ERE | largest difference to the truth | test mean | 99.5th percentile "
      "|\n|---|---|---|---|---|\n");
  for (const BoardShape board : {BoardShape::kFlat, BoardShape::kWarped}) {
    StudyOptions options = Options(StudyLenses()[2], Strategy::kSuggestions);
    options.warp = {.02, -.01, .01};
    options.session.calibration.board = board;
    const auto run = RunStudy(options);
    const auto last = [&](auto get) {
      return Mean(Of(run, [&](const StudyTrial& t) { return get(t.frames.back()); }));
    };
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n",
               board == BoardShape::kFlat ? "flat" : "warped",
               last([](const StudyFrame& f) { return f.max_ere_px; }),
               last([](const StudyFrame& f) { return f.true_max_px; }),
               last([](const StudyFrame& f) { return f.test.mean_px; }),
               last([](const StudyFrame& f) { return f.test.percentile_995_px; }));
  }
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
  const std::vector<ParameterSpread> spreads = Table51();
  BentBoard();
  const std::vector<LensRuns> all = RunAll();
  FramesToOnePixel(all);
  Figure57(all);
  Figure58(all);
  if (argc > 3) WriteFigures(argv[3], all, spreads);
  fmt::print(stderr, "{:.0f} s\n",
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}
