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

// The trajectories that are there, by family.
std::map<std::string, std::vector<StampedPose>> ReadTrajectories(
    const std::string& file, const std::vector<std::pair<std::string, std::string>>& of_families,
    const char* whose, const Console& console) {
  std::map<std::string, std::vector<StampedPose>> truth;
  std::string missing;
  for (const auto& [path, family] : of_families) {
    if (path != file && !std::filesystem::exists(path)) {
      missing += (missing.empty() ? "" : ", ") + path;
      continue;
    }
    truth[family] = ParseTum(ReadFile(path), path);
  }
  if (truth.empty())
    throw Error(file + ": " + whose + ", and a trajectory holds one; there is none of " + missing);
  if (!missing.empty()) console.Note(file + ": there is no " + missing);
  return truth;
}

GroundTruth TruthOfTrajectories(const std::string& file, const Graph& graph,
                                const Console& console) {
  GroundTruth truth;
  for (auto& [family, poses] :
       ReadTrajectories(file, TrajectoryFiles(file, graph),
                        "the problem has poses of several families", console))
    truth[family] = std::move(poses);
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
  options_ = ErrorOptionsOf(comparing);
  truth_ = FormatOfName(file_) ? TruthOfProblem(file_, reading, graph.Types(), console)
                               : TruthOfTrajectories(file_, graph, console);
  About(file_, [&] { return PairWithTruth(graph, graph.InitialValues(), truth_); });
}

TrajectoryErrorOptions ErrorOptionsOf(const Comparing& comparing) {
  static const std::map<std::string, TrajectoryAlignment> kAlignments = {
      {"se", TrajectoryAlignment::kRigid},
      {"sim", TrajectoryAlignment::kSimilarity},
      {"first", TrajectoryAlignment::kFirst},
      {"none", TrajectoryAlignment::kNone}};
  TrajectoryErrorOptions options;
  options.align = kAlignments.at(comparing.align);
  options.rpe_distance_m = comparing.rpe_distance_m;
  return options;
}

std::map<std::string, std::vector<StampedPose>> TrueTrajectories(
    const std::string& path, const std::vector<std::string>& robots, const Console& console) {
  return ReadTrajectories(path, FilesOfFamilies(path, robots), "there are several robots", console);
}

std::optional<Accuracy> TruthOf::Judge(const Graph& graph, const Values& values) const {
  if (file_.empty()) return std::nullopt;
  Accuracy accuracy = TrajectoryErrors(PairWithTruth(graph, values, truth_), options_);
  accuracy.truth = file_;
  return accuracy;
}

}  // namespace graticule::apps
