#include "compare_runs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "configured_solve.hpp"
#include "graticule/io/checksum.hpp"
#include "graticule/io/comparison_run.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

Timing MedianOf(const std::vector<Timing>& runs) {
  const auto of = [&](const auto& get) {
    std::vector<double> values;
    for (const Timing& run : runs) values.push_back(get(run));
    return Median(values);
  };
  Timing median;
  for (PhaseTime Timing::*phase : {&Timing::load, &Timing::initialise, &Timing::build,
                                   &Timing::solve, &Timing::write, &Timing::total})
    median.*phase = {of([&](const Timing& t) { return (t.*phase).wall; }),
                     of([&](const Timing& t) { return (t.*phase).cpu; })};
  for (double Timing::*part : {&Timing::preprocess, &Timing::evaluate, &Timing::linear_solve})
    median.*part = of([&](const Timing& t) { return t.*part; });
  return median;
}

}  // namespace

CompareRuns::CompareRuns(const CompareCommand& command, const Console& console)
    : command_(command), console_(console) {
  for (const std::string& name : command.configs)
    configurations_.push_back(Choose({name, command.settings}));
  types_ = LoadTypes(command.reading);
}

std::optional<RepairedInformation> CompareRuns::Check(const std::string& file) {
  inputs_ += " refused";
  const Recording recording = Load(file, command_.reading, types_, console_);
  truths_.try_emplace(file, command_.comparing, command_.reading, recording.graph, console_);
  if (command_.state.empty()) return recording.repaired;
  inputs_.resize(inputs_.rfind(' '));
  inputs_ += " " + Checksum(ReadFile(file));
  const std::string& truth = command_.comparing.ground_truth;
  std::vector<std::pair<std::string, std::string>> truths = {{truth, ""}};
  if (!FormatOfName(truth)) truths = TrajectoryFiles(truth, recording.graph);
  for (const auto& [path, family] : truths)
    if (std::filesystem::exists(path)) inputs_ += " " + Checksum(ReadFile(path));
  return recording.repaired;
}

// One whole run, from the file: load, initialise, build, solve; what comes after is not counted.
Report CompareRuns::RunOnce(const std::string& file, const Configuration& configuration,
                            const std::string& what, std::optional<Accuracy>* accuracy) {
  const Stopwatch total;
  Stopwatch clock;
  Console silent;
  silent.quiet = true;
  Recording recording = Load(file, command_.reading, types_, silent);
  const PhaseTime load = clock.Lap();
  ConfiguredSolution solved = SolveAsConfigured(&recording.graph, recording.has_initial_guess,
                                                configuration, Watch(console_, what));
  Report& report = solved.solution.report;
  if (recording.repaired) report.warnings.push_back(ToString(*recording.repaired));
  report.timing.load = load;
  report.timing.initialise = solved.initialise;
  report.timing.total = total.Elapsed();
  if (report.termination != Termination::kFailed) {
    const TruthOf& truth =
        truths_.try_emplace(file, command_.comparing, command_.reading, recording.graph, silent)
            .first->second;
    *accuracy = truth.Judge(recording.graph, solved.solution.values);
  }
  return std::move(report);
}

ComparisonRun CompareRuns::Repeat(const std::string& file, const Configuration& configuration) {
  ComparisonRun run;
  run.file = file;
  run.configuration = configuration.name;
  run.repeats = static_cast<std::size_t>(command_.repeats);
  std::vector<Timing> timings;
  try {
    ResetPeakMemory();
    for (int i = 0; i <= command_.repeats && !Interruptible::WasAsked(); ++i) {
      const std::string what =
          fmt::format("{} {} {}/{}", file, configuration.name, i, command_.repeats);
      Report report = RunOnce(file, configuration, what, &run.accuracy);
      // The first run counts only where it stays the only one: its caches were cold.
      if (i > 0) timings.push_back(report.timing);
      if (i <= 1) run.report = std::move(report);
    }
    run.peak_memory_bytes = PeakMemory();
  } catch (const graticule::Error& error) {
    run.error = error.what();
  }
  if (timings.empty()) timings.push_back(run.report.timing);
  run.median = MedianOf(timings);
  run.min_total_s = run.max_total_s = timings[0].total.wall;
  for (const Timing& timing : timings) {
    run.min_total_s = std::min(run.min_total_s, timing.total.wall);
    run.max_total_s = std::max(run.max_total_s, timing.total.wall);
  }
  return run;
}

std::string CompareRuns::Handle(std::size_t run) {
  const ComparisonRun found =
      Repeat(command_.files[FileOf(run)], configurations_[run % configurations_.size()]);
  return (Interruptible::WasAsked() ? "part " : "whole ") + RunText(found);
}

std::string CompareRuns::Fingerprint() const {
  std::string text = inputs_;
  const auto add = [&](const std::string& word) { text += " " + Checksum(word); };
  for (const std::string& file : command_.files) add(file);
  for (const Configuration& configuration : configurations_) {
    add(configuration.name);
    for (const OptionLine& option : DescribeOptions(configuration))
      add(option.name + "=" + option.value);
  }
  const Reading& reading = command_.reading;
  for (const std::string& plugin : reading.plugins) add(ReadFile(plugin));
  const Comparing& comparing = command_.comparing;
  add(fmt::format("{} {} {} {} {} {} {}", reading.g2o_rotation, reading.skip_unknown,
                  reading.repair_information, command_.repeats, comparing.ground_truth,
                  comparing.align, comparing.rpe_distance_m));
  for (const auto& [what, version] : Provenance()) add(what + " " + version);
  return Checksum(text);
}

CompareResult ResultOf(const std::string& text) {
  TextReader reader(text, "a run's result");
  reader.NextLine();
  CompareResult result;
  result.is_whole = reader.Word("whole or part") == "whole";
  result.run = ParseRun(&reader);
  return result;
}

}  // namespace graticule::apps
