#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "certificate.hpp"
#include "commands.hpp"
#include "configured_solve.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/graph_plot.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/report_html.hpp"
#include "graticule/io/report_json.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/pose_graph/drawing.hpp"
#include "graticule/problems/subgraph.hpp"
#include "graticule/solver/plugin.hpp"
#include "graticule/solver/provenance.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "ground_truth.hpp"
#include "marginals.hpp"
#include "outputs.hpp"
#include "problem.hpp"
#include "rejection.hpp"
#include "structure_json.hpp"

namespace graticule::apps {
namespace {

void PrintSummary(const SolveCommand& command, const Graph& graph, const Report& report,
                  const ReportContext& context) {
  fmt::print("{}\n", command.file);
  fmt::print("  variables  {} ({})\n", report.variables, CountVariables(graph));
  fmt::print("  factors    {} ({})\n", report.factors, CountFactors(graph));
  fmt::print("  start      {}\n", context.initialisation);
  if (context.second_look) fmt::print("  second     {}\n", context.second_look->text);
  if (context.rejection) PrintRejection(*context.rejection);
  fmt::print("  cost       {:.9g} -> {:.9g}  (0.5 r'Wr)", report.initial_cost, report.final_cost);
  if (std::abs(report.final_objective - report.final_cost) > 1e-9 * report.final_cost)
    fmt::print(", with losses {:.9g}", report.final_objective);
  if (report.degrees_of_freedom > 0)
    fmt::print(", chi2 {:.6g} over {} degrees of freedom: {:.4g} each", report.Chi2(),
               report.degrees_of_freedom, report.ReducedChi2());
  fmt::print("\n  ended      {} after {} iterations: {}\n", ToString(report.termination),
             report.Steps(), report.message);
  const Timing& t = report.timing;
  fmt::print(
      "  time       load {}, initialise {}, build {}, solve {} (linear {}, evaluate {}), write {}, "
      "total {}\n",
      Seconds(t.load.wall), Seconds(t.initialise.wall), Seconds(t.build.wall),
      Seconds(t.solve.wall), Seconds(t.linear_solve), Seconds(t.evaluate), Seconds(t.write.wall),
      Seconds(t.total.wall));
  if (!report.anchors.empty()) {
    fmt::print("  held       ");
    for (std::size_t i = 0; i < std::min<std::size_t>(report.anchors.size(), 5); ++i)
      fmt::print("{} ", report.anchors[i]);
    fmt::print("{}(nothing else says where the graph is)\n",
               report.anchors.size() > 5 ? "... " : "");
  }
  for (const std::string& warning : report.warnings) fmt::print("  warning    {}\n", warning);
  if (context.accuracy) {
    fmt::print("  truth      {}\n", AccuracyTitle(*context.accuracy));
    for (const std::string& line : AccuracyLines(*context.accuracy))
      fmt::print("             {}\n", line);
  }
  if (!report.worst.empty()) fmt::print("  worst      chi2 (residuals)\n");
  for (const WorstFactor& worst : report.worst) {
    std::string keys;
    for (std::size_t i = 0; i < std::min<std::size_t>(worst.keys.size(), 4); ++i)
      keys += (i ? " " : "") + worst.keys[i].ToString();
    fmt::print("             {:<10.5g} ({})  {} {}{}{}\n", worst.chi2, worst.residuals, worst.type,
               keys, worst.keys.size() > 4 ? " ..." : "",
               worst.source.empty() ? "" : ", " + worst.source);
  }
}

// In place of the report.
void PrintIllPosed(const Graph& graph, const Error& error, const SolveCommand& command) {
  nlohmann::ordered_json json = {
      {"schema", "graticule-ill-posed/1"}, {"file", command.file}, {"error", error.what()}};
  json.update(StructureJson(graph, AnalyseStructure(graph)));
  fmt::print("{}\n", JsonText(json, 1));
}

// What a solved problem says of its solution, on one line.
std::string SolutionLine(const Report& report, const SolveCommand& command,
                         const RejectionReport& rejection) {
  nlohmann::ordered_json line = {{"termination", ToString(report.termination)},
                                 {"iterations", report.Steps()},
                                 {"initial_cost", report.initial_cost},
                                 {"final_cost", report.final_cost},
                                 {"final_objective", report.final_objective}};
  if (rejection.method != Rejection::kNone) {
    line["rejection"] = ToString(rejection.method);
    if (command.drop_rejected) {
      line["dropped"] = rejection.rejected.size();
    } else {
      line["rejected"] = nlohmann::ordered_json::array();
      for (const RejectionReport::Factor& factor : rejection.rejected)
        line["rejected"].push_back(factor.id);
    }
  }
  return JsonText(line);
}

// The words of the command that stand for options.
Configuration ChooseRejection(const SolveCommand& command) {
  Configuration configuration = Choose(command.choosing);
  std::string method = command.reject;
  std::replace(method.begin(), method.end(), '-', '_');
  if (!method.empty()) configuration.Set("reject_outliers", method);
  const auto list = [&](const std::vector<std::string>& sources, const char* option) {
    std::string text;
    for (const std::string& source : sources) text += (text.empty() ? "" : ",") + source;
    if (!text.empty()) configuration.Set(option, text);
  };
  list(command.trust, "trusted_sources");
  list(command.suspect, "suspect_sources");
  if (configuration.rejection.reject_outliers != Rejection::kNone) return configuration;
  for (const auto& [is_set, word] : {std::pair(!command.trust.empty(), "--trust"),
                                     std::pair(!command.suspect.empty(), "--suspect"),
                                     std::pair(command.drop_rejected, "--drop-rejected")})
    if (is_set) throw Error(std::string(word) + " needs --reject-outliers", ErrorKind::kUsage);
  return configuration;
}

void CheckOutputs(const SolveCommand& command) {
  ExpectEnding(command.output, "-o", ProblemEndings());
  ExpectEnding(command.report, "--report", {".html", ".json"});
  ExpectEnding(command.plot, "--plot", {".svg", ".png"});
  ExpectEnding(command.marginals_output, "--marginals-output", {".json"});
  if (!command.marginals_output.empty() && command.marginals.empty())
    throw Error("--marginals-output needs --marginals", ErrorKind::kUsage);
  for (const std::string& path :
       {command.output, command.report, command.plot, command.trajectory, command.marginals_output})
    ExpectWritable(path);
}

}  // namespace

int Run(const SolveCommand& command, const Console& console) {
  const Stopwatch total;
  CheckOutputs(command);
  const Configuration configuration = ChooseRejection(command);
  const Registry types = LoadTypes(command.reading);

  Stopwatch clock;
  Recording recording = Load(command.file, command.reading, types, console);
  const PhaseTime load = clock.Lap();
  Graph& graph = recording.graph;
  const std::vector<Key> marginal_keys = ReadKeys(command.marginals, graph);
  const auto trajectories = TrajectoryFiles(command.trajectory, graph);
  const TruthOf truth(command.comparing, command.reading, graph, console);

  const bool has_guess = recording.has_initial_guess;
  const bool draws = !command.plot.empty() || Ending(command.report) == ".html";
  Values before;
  if (draws && has_guess) before = graph.InitialValues();

  // From here on Ctrl-C ends the solve, and does not cut a file that is being written.
  const Interruptible interruptible;
  ConfiguredSolution solved;
  try {
    solved = About(command.file, [&] {
      return SolveAsConfigured(&graph, has_guess, configuration, Watch(console, command.file));
    });
  } catch (const graticule::Error& error) {
    if (command.json && error.Kind() == ErrorKind::kIllPosed) PrintIllPosed(graph, error, command);
    throw;
  }
  Solution& solution = solved.solution;
  if (draws && !has_guess) before = graph.InitialValues();
  console.Progress("");
  // What certificate, marginals and drawings are of.  The graph itself keeps all its factors.
  std::optional<Graph> without;
  if (!solved.rejection.rejected.empty()) without = KeepFactors(graph, solved.is_kept);
  Graph& kept = without ? *without : graph;
  ReportContext context;
  if (command.certify && solution.report.termination != Termination::kFailed) {
    context.certificate = About(command.file, [&] {
      return CertifySolution(kept, configuration.solve, Watch(console, command.file), &solution);
    });
    console.Progress("");
    if (context.certificate->improved) solved.initialisation += "; then solved again";
  }
  Report& report = solution.report;
  const bool is_cut_short = context.certificate && Interruptible::WasAsked();
  if (is_cut_short) report.warnings.push_back("stopped before the certificate was whole");
  if (recording.repaired) report.warnings.push_back(ToString(*recording.repaired));
  report.timing.load = load;
  report.timing.initialise = solved.initialise;
  if (report.termination == Termination::kFailed) {
    console.Error(command.file + ": " + report.message);
    return kOtherFailure;
  }
  graph.SetValues(solution.values);
  kept.SetValues(solution.values);
  if (solved.rejection.method != Rejection::kNone)
    context.rejection = Summarise(graph, solved.rejection);

  MarginalsResult marginals;
  if (!marginal_keys.empty())
    marginals = About(command.file, [&] {
      return FindMarginals(AsSolved(kept, configuration.solve), solution.values, marginal_keys);
    });

  context.file = command.file;
  context.configuration = configuration.name;
  context.initialisation = solved.initialisation;
  context.second_look = solved.second_look;
  context.repaired = recording.repaired;
  context.accuracy = truth.Judge(graph, solution.values);
  recording.has_initial_guess = true;
  recording.solved_by = fmt::format("graticule {}, ceres {}: {}", Version(),
                                    report.provenance.size() > 1 ? report.provenance[1].second : "",
                                    ToString(report.termination));
  clock.Restart();
  Outputs outputs(console);
  outputs.Try(command.output, [&] {
    WriteOptions options;
    options.binary = command.binary;
    recording.report = SolutionLine(report, command, solved.rejection);
    Recording dropped(Registry{});
    const bool drop = command.drop_rejected && without;
    if (drop) {
      dropped = recording;
      dropped.graph = kept;
    }
    for (const std::string& note :
         WriteProblem(command.output, drop ? dropped : recording, options))
      console.Note(command.output + ": " + note);
  });
  for (const auto& [path, family] : trajectories)
    outputs.Try(path, [&, path = path, family = family] {
      WriteFile(path, FormatTum(Trajectory(graph, solution.values, family)));
    });
  std::string drawing;
  if (draws) {
    GraphPlot plot = PlotOf(kept, before, solution.values, command.file);
    plot.before_label = has_guess ? "Before: as in the file" : "Before: " + solved.start_label;
    drawing = DrawGraph(plot);
  }
  outputs.Try(command.plot, [&] {
    WriteFile(command.plot, Ending(command.plot) == ".svg" ? drawing : PngFromSvg(drawing, 1600));
  });
  outputs.Try(command.marginals_output, [&] {
    WriteFile(command.marginals_output, JsonText(MarginalsJson(marginals), 1) + "\n");
  });
  report.timing.write = clock.Elapsed();
  report.timing.total = total.Elapsed();
  context.peak_memory_bytes = PeakMemory();
  context.outputs = outputs.Written();
  outputs.Try(command.report, [&] {
    WriteFile(command.report, Ending(command.report) == ".html"
                                  ? ReportHtml(report, context, drawing)
                                  : ReportJson(report, context) + "\n");
  });
  context.outputs = outputs.Written();

  if (command.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(ReportJson(report, context));
    if (!marginal_keys.empty()) json["marginals"] = MarginalsJson(marginals);
    fmt::print("{}\n", JsonText(json, 1));
  } else {
    PrintSummary(command, kept, report, context);
    if (context.certificate) PrintCertificate(*context.certificate);
    if (!marginal_keys.empty()) PrintMarginals(marginals);
    for (const std::string& path : outputs.Written()) fmt::print("  wrote      {}\n", path);
  }
  if (!marginals.diagnosis.empty()) {
    console.Error(command.file + ": no marginals: " + marginals.diagnosis);
    return kIllPosed;
  }
  if (outputs.Failure() != kDone) return outputs.Failure();
  const int code = ExitOf(report.termination);
  return code == kDone && is_cut_short ? kNotConverged : code;
}

}  // namespace graticule::apps
