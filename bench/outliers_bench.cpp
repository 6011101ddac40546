// How well false loop closures are found: recorded pose graphs with false closures added, solved by
// each method, as rows of a Markdown table (docs/outliers.md).
//
//   graticule_outliers --kind random --seeds 1 --methods gnc_tls,huber --fractions 0.1,0.3 FILES
//
// Recall: of the false closures, those rejected.  Precision: of those rejected, the false ones.
// Methods that reject nothing are asked which closures end beyond the limit.  Trajectory error:
// root mean square of the positions against the clean optimum's, after the best rigid motion. Time:
// CPU, of all that follows reading the file; beside it, as a multiple of solving the clean graph.

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/pose_graph/corrupt.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "graticule/problems/pose_graph/suspects.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

struct Answer {
  Values values;
  std::vector<FactorId> rejected;
  std::string remark;
};

struct Words {
  std::vector<std::string> files, fractions = {"0.1", "0.2", "0.3", "0.4", "0.5", "0.6"};
  std::vector<std::string> methods = {"least_squares", "huber",  "cauchy",
                                      "gnc_tls",       "gnc_gm", "pcm"};
  std::string kind = "random";
  int seeds = 1;
};

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

Words ReadWords(int argc, char** argv) {
  Words words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--fractions" && has_value)
      words.fractions = SplitList(argv[++i]);
    else if (word == "--methods" && has_value)
      words.methods = SplitList(argv[++i]);
    else if (word == "--kind" && has_value)
      words.kind = argv[++i];
    else if (word == "--seeds" && has_value)
      words.seeds = std::atoi(argv[++i]);
    else
      words.files.push_back(word);
  }
  return words;
}

double TrajectoryError(const Graph& graph, const Values& found, const Values& truth) {
  std::vector<VariableId> poses;
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    if (graph.TypeOf(id).name == "se2/1" || graph.TypeOf(id).name == "se3/1") poses.push_back(id);
  Eigen::Matrix3Xd a = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(poses.size())), b = a;
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (int axis = 0; axis < (found[poses[i]].size() == 3 ? 2 : 3); ++axis) {
      a(axis, static_cast<Eigen::Index>(i)) = found[poses[i]][static_cast<std::size_t>(axis)];
      b(axis, static_cast<Eigen::Index>(i)) = truth[poses[i]][static_cast<std::size_t>(axis)];
    }
  const Eigen::Matrix4d motion = Eigen::umeyama(a, b, false);
  const Eigen::Matrix3Xd moved =
      (motion.topLeftCorner<3, 3>() * a).colwise() + motion.topRightCorner<3, 1>();
  return std::sqrt((moved - b).colwise().squaredNorm().mean());
}

// What `graticule solve --config` does with the ready configurations.
Answer SolveAll(const Recording& recording, Graph graph, const std::string& method) {
  SolveOptions options;
  if (method == "huber" || method == "cauchy") {
    options.loss = method;
    options.loss_scale = method == "huber" ? 1.345 : 2.3849;
    options.initial_trust_region_radius = 1e4;
    options.max_trust_region_radius = 1e16;
  }
  Initialise(&graph, InitialGuess::kAutomatic, recording.has_initial_guess);
  Answer answer;
  const Solution solution = Solve(graph, options);
  answer.values = solution.values;
  answer.remark = fmt::format("{} steps", solution.report.Steps());
  const std::vector<double> chi2 = FactorChi2(graph, answer.values);
  for (const FactorId id : ChooseSuspects(graph))
    if (!(chi2[id] <= ChiSquareQuantile(0.99, graph.ResidualSize(id))))
      answer.rejected.push_back(id);
  return answer;
}

Answer Reject(const Graph& graph, std::string method) {
  RejectionOptions options;
  if (const std::size_t scaled = method.find("+scale"); scaled != std::string::npos) {
    options.inlier_noise_scale = 0;
    method.resize(scaled);
  }
  SetOption(RejectionOptionTable(), "reject_outliers", method, &options);
  RobustSolution robust = SolveWithoutOutliers(graph, options);
  Answer answer;
  for (const RejectionReport::Factor& factor : robust.rejection.rejected)
    answer.rejected.push_back(factor.id);
  answer.values = std::move(robust.solution.values);
  const auto& attempts = robust.rejection.attempts;
  const auto best = std::min_element(
      attempts.begin(), attempts.end(),
      [](const auto& a, const auto& b) { return a.truncated_cost < b.truncated_cost; });
  if (best != attempts.end())
    answer.remark = fmt::format("{} attempts ({} rounds), {}, cost {:.6g}", attempts.size(),
                                robust.rejection.rounds, best->start, best->truncated_cost);
  if (options.inlier_noise_scale == 0)
    answer.remark += fmt::format(", scale {:.3g}", robust.rejection.inlier_noise_scale);
  return answer;
}

void Row(const Recording& recording, const Words& words, const std::string& file,
         const std::string& fraction, const std::string& method, const Solution& clean,
         double clean_s) {
  double recall = 0, precision = 0, error = 0, seconds = 0;
  std::size_t suspects = 0, false_ones = 0;
  std::string remark;
  for (int seed = 1; seed <= words.seeds; ++seed) {
    CorruptOptions options;
    options.fraction = std::atof(fraction.c_str());
    options.seed = static_cast<std::uint64_t>(seed);
    options.kind = words.kind == "grouped" ? Corruption::kGrouped
                   : words.kind == "local" ? Corruption::kLocal
                                           : Corruption::kRandom;
    const Corrupted corrupted = AddFalseClosures(recording.graph, options);
    suspects = ChooseSuspects(corrupted.graph).size();
    false_ones = corrupted.outliers.size();
    const Stopwatch clock;
    Answer answer;
    try {
      answer = method == "least_squares" || method == "huber" || method == "cauchy"
                   ? SolveAll(recording, corrupted.graph, method)
                   : Reject(corrupted.graph, method);
    } catch (const Error& problem) {
      fmt::print("| {} | {} | {} | {} | | | | {} |\n", file, fraction, false_ones, method,
                 problem.what());
      return;
    }
    seconds += clock.Elapsed().cpu;
    std::size_t found = 0;
    for (const FactorId id : answer.rejected)
      found += std::binary_search(corrupted.outliers.begin(), corrupted.outliers.end(), id);
    recall += false_ones ? static_cast<double>(found) / static_cast<double>(false_ones) : 1;
    precision += answer.rejected.empty()
                     ? 1
                     : static_cast<double>(found) / static_cast<double>(answer.rejected.size());
    error += TrajectoryError(corrupted.graph, answer.values, clean.values);
    remark = answer.remark;
  }
  const double n = words.seeds;
  fmt::print("| {} | {} | {} of {} | {} | {:.4f} | {:.4f} | {:.4g} | {:.2f} | {:.0f} | {} |\n",
             file, fraction, false_ones, suspects, method, recall / n, precision / n, error / n,
             seconds / n, seconds / n / clean_s, remark);
  std::fflush(stdout);
}

void Rows(const std::string& path, const Words& words) {
  const Recording recording = ReadProblem(path, Builtins());
  Graph clean = recording.graph;
  const Stopwatch clock;
  Initialise(&clean, InitialGuess::kAutomatic, recording.has_initial_guess);
  const Solution solution = Solve(clean);
  const double seconds = clock.Elapsed().cpu;
  const std::string file = path.substr(path.rfind('/') + 1);
  fmt::print("<!-- {}: clean solve {:.3f} s, chi2 per degree of freedom {:.4g} -->\n", file,
             seconds, solution.report.ReducedChi2());
  for (const std::string& fraction : words.fractions)
    for (const std::string& method : words.methods)
      Row(recording, words, file, fraction, method, solution, seconds);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  const graticule::Words words = graticule::ReadWords(argc, argv);
  fmt::print(
      "| file | share | false of suspects | method | recall | precision | trajectory error [m] | "
      "CPU [s] | clean solves | remark |\n|---|---|---|---|---|---|---|---|---|---|\n");
  try {
    for (const std::string& file : words.files) graticule::Rows(file, words);
  } catch (const graticule::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
