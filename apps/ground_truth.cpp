#include "ground_truth.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <map>

#include "graticule/io/file.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

GroundTruth TruthOfProblem(const std::string& file, const Reading& reading, const Registry& types,
                           const Console& console) {
  const Recording recording = Load(file, reading, types, console);
  GroundTruth truth;
  for (const std::string& family : PoseFamilies(recording.graph))
    truth[family] = Trajectory(recording.graph, recording.graph.InitialValues(), family);
  return truth;
}

GroundTruth TruthOfTrajectories(const std::string& file, const Graph& graph,
                                const Console& console) {
  GroundTruth truth;
  std::string missing;
  for (const auto& [path, family] : TrajectoryFiles(file, graph)) {
    if (path != file && !std::filesystem::exists(path)) {
      missing += (missing.empty() ? "" : ", ") + path;
      continue;
    }
    truth[family] = ParseTum(ReadFile(path), path);
  }
  if (truth.empty())
    throw Error(file +
                ": the problem has poses of several families, and a trajectory holds one; "
                "there is none of " +
                missing);
  if (!missing.empty()) console.Note(file + ": there is no " + missing);
  return truth;
}

}  // namespace

TruthOf::TruthOf(const Comparing& comparing, const Reading& reading, const Graph& graph,
                 const Console& console)
    : file_(comparing.ground_truth) {
  if (file_.empty()) return;
  if (PoseFamilies(graph).empty())
    throw Error("--ground-truth: the problem has no poses (se2/1, se3/1) to compare with it",
                ErrorKind::kUsage);
  static const std::map<std::string, TrajectoryAlignment> kAlignments = {
      {"se", TrajectoryAlignment::kRigid},
      {"sim", TrajectoryAlignment::kSimilarity},
      {"first", TrajectoryAlignment::kFirst},
      {"none", TrajectoryAlignment::kNone}};
  options_.align = kAlignments.at(comparing.align);
  options_.rpe_distance_m = comparing.rpe_distance_m;
  truth_ = FormatOfName(file_) ? TruthOfProblem(file_, reading, graph.Types(), console)
                               : TruthOfTrajectories(file_, graph, console);
  About(file_, [&] { return PairWithTruth(graph, graph.InitialValues(), truth_); });
}

std::optional<Accuracy> TruthOf::Judge(const Graph& graph, const Values& values) const {
  if (file_.empty()) return std::nullopt;
  Accuracy accuracy = TrajectoryErrors(PairWithTruth(graph, values, truth_), options_);
  accuracy.truth = file_;
  return accuracy;
}

}  // namespace graticule::apps
