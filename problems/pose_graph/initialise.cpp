#include "graticule/problems/pose_graph/initialise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "graticule/problems/pose_graph/chordal.hpp"
#include "graticule/problems/pose_graph/incremental.hpp"
#include "graticule/problems/pose_graph/lago.hpp"
#include "graticule/problems/pose_graph/landmarks.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/spanning_tree.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

const std::vector<std::pair<std::string, InitialGuess>> kNames = {
    {"automatic", InitialGuess::kAutomatic},
    {"file", InitialGuess::kFile},
    {"odometry", InitialGuess::kOdometry},
    {"spanning_tree", InitialGuess::kSpanningTree},
    {"minimum_spanning_tree", InitialGuess::kMinimumSpanningTree},
    {"chordal", InitialGuess::kChordal},
    {"lago", InitialGuess::kLago},
    {"incremental", InitialGuess::kIncremental}};

// Whether there is something to place, and something to gain from more than a tree.
struct Shape {
  bool has_poses = false;
  std::size_t closures = 0;  // between and landmark factors that a spanning tree leaves out
};

Shape ShapeOf(const Graph& graph) {
  Shape shape;
  for (const VariableType& type : graph.UsedVariableTypes()) shape.has_poses |= IsPose(type);
  if (!shape.has_poses) return shape;
  std::vector<bool> joins;
  for (const FactorType& type : graph.UsedFactorTypes()) {
    const PoseRole role = PoseRoleOf(type.name);
    joins.push_back(role == PoseRole::kBetween || role == PoseRole::kLandmark ||
                    role == PoseRole::kLandmarkWithOffset || role == PoseRole::kBearingRange);
  }
  UnionFind pieces(graph.VariableCount());
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    if (!joins[graph.FactorTypeIndex(id)]) continue;
    const auto ends = graph.FactorAt(id).variables;
    shape.closures += !pieces.Join(ends[0], ends[1]);
  }
  return shape;
}

Growth GrowthOf(InitialGuess guess) {
  if (guess == InitialGuess::kOdometry) return Growth::kAlongChains;
  if (guess == InitialGuess::kMinimumSpanningTree) return Growth::kLeastUncertainty;
  return Growth::kBreadthFirst;
}

// Values of a method, and the report of how they came about.
struct Start {
  Values values;
  InitialiseReport report;
};

Start FromTree(const Graph& graph, InitialGuess how) {
  Start start{graph.InitialValues(), {}};
  const SpanningTreeReport tree = PlaceBySpanningTree(graph, GrowthOf(how), &start.values);
  const PlacedLandmarks landmarks = PlaceLandmarks(graph, &start.values);
  start.report.used = how;
  start.report.poses = tree.poses;
  start.report.roots = tree.roots;
  start.report.free_roots = tree.free_roots;
  start.report.landmarks = landmarks.placed;
  start.report.assumed = landmarks.assumed;
  return start;
}

Start FromChordal(const Graph& graph, const Start& tree) {
  Start start = tree;
  const ChordalReport chordal = PlaceByChordal(graph, &start.values);
  start.report.used = InitialGuess::kChordal;
  start.report.kept_pieces = chordal.kept_pieces;
  start.report.landmarks = chordal.landmarks.placed;
  start.report.assumed = chordal.landmarks.assumed;
  return start;
}

Start FromLago(const Graph& graph, const Start& tree) {
  Start start = tree;
  const LagoReport lago = PlaceByLago(graph, &start.values);
  start.report.used = InitialGuess::kLago;
  start.report.kept_pieces = lago.kept_pieces;
  start.report.landmarks = lago.landmarks.placed;
  start.report.assumed = lago.landmarks.assumed;
  return start;
}

Start FromIncremental(const Graph& graph, const Observer& watch) {
  Start start{graph.InitialValues(), {}};
  const IncrementalReport grown = PlaceIncrementally(graph, &start.values, {}, watch);
  start.report.used = InitialGuess::kIncremental;
  start.report.poses = grown.poses;
  start.report.roots = grown.roots;
  start.report.free_roots = grown.free_roots;
  start.report.landmarks = grown.landmarks.placed;
  start.report.assumed = grown.landmarks.assumed;
  start.report.updates = grown.updates;
  if (!grown.is_complete) start.report.failure = grown.failure.empty() ? "stopped" : grown.failure;
  return start;
}

std::string Count(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string Summary(const InitialiseReport& report) {
  std::string text = ToString(report.used) + ": ";
  if (report.used == InitialGuess::kFile) {
    text += "initial values kept as they are";
  } else {
    text += std::to_string(report.poses) + " poses from " + Count(report.roots, "root", "roots");
    if (report.free_roots)
      text += " (" + std::to_string(report.free_roots) + " that nothing holds)";
    if (report.kept_pieces)
      text += ", " + Count(report.kept_pieces, "piece", "pieces") +
              " by the spanning tree for want of measurements";
    if (report.landmarks && report.used == InitialGuess::kChordal)
      text += ", " + std::to_string(report.landmarks) + " landmarks";
    else if (report.landmarks)
      text += ", " + std::to_string(report.landmarks) + " landmarks from their first sighting";
    if (report.assumed)
      text += " (" + std::to_string(report.assumed) + " at an assumed range or direction)";
    if (report.updates) text += ", solved in " + Count(report.updates, "update", "updates");
    if (!report.failure.empty()) text += ", then given up: " + report.failure;
  }
  if (report.candidates.empty()) return text;
  text += "; of the costs";
  for (const InitialCost& candidate : report.candidates) {
    char number[32];
    std::snprintf(number, sizeof(number), "%.4g", candidate.cost);
    text += (&candidate == &report.candidates.front() ? " " : ", ") + ToString(candidate.guess) +
            (candidate.guess == report.used ? " " : " over ") + number;
  }
  return text + ", the least";
}

Start FromMethod(const Graph& graph, InitialGuess how, const Observer& watch) {
  if (how == InitialGuess::kIncremental) return FromIncremental(graph, watch);
  if (how != InitialGuess::kChordal && how != InitialGuess::kLago) return FromTree(graph, how);
  const Start tree = FromTree(graph, InitialGuess::kSpanningTree);
  return how == InitialGuess::kLago ? FromLago(graph, tree) : FromChordal(graph, tree);
}

// The candidate of the least objective; of equal ones the first.
Start Best(const Graph& graph, bool file_has_guess) {
  // Chordal, nearly always the best, first: of the others no more is added up than tells.
  std::vector<Start> starts;
  Start tree = FromTree(graph, InitialGuess::kSpanningTree);
  starts.push_back(FromChordal(graph, tree));
  if (file_has_guess) starts.push_back({graph.InitialValues(), {}});
  starts.push_back(std::move(tree));

  std::vector<const Values*> values;
  for (const Start& start : starts) values.push_back(&start.values);
  std::vector<double> costs;
  try {
    costs = Objectives(graph, values, true);
  } catch (const Error&) {
    // A type or a measurement that Solve refuses: it says so better than we can.
    return std::move(file_has_guess ? starts[1] : starts.back());
  }
  std::vector<InitialCost> candidates;
  std::size_t best = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    candidates.push_back({starts[i].report.used, costs[i]});
    if (costs[i] < costs[best] || std::isnan(costs[best])) best = i;
  }
  starts[best].report.candidates = std::move(candidates);
  return std::move(starts[best]);
}

}  // namespace

std::string ToString(InitialGuess guess) {
  for (const auto& [name, value] : kNames)
    if (value == guess) return name;
  return "";
}

const std::vector<OptionRow<InitialiseOptions>>& InitialiseOptionTable() {
  static const std::vector<OptionRow<InitialiseOptions>> table = {ChoiceOption(
      "initialise", &InitialiseOptions::initialise, kNames,
      "where a pose graph's initial values come from; automatic: the best of several, by cost")};
  return table;
}

InitialiseReport Initialise(Graph* graph, InitialGuess how, bool file_has_guess,
                            const Observer& watch) {
  InitialiseReport report;
  const Shape shape = how == InitialGuess::kFile ? Shape{} : ShapeOf(*graph);
  const bool choose = how == InitialGuess::kAutomatic && shape.closures > 0;
  if (how == InitialGuess::kAutomatic && !choose)
    how = file_has_guess ? InitialGuess::kFile : InitialGuess::kSpanningTree;
  if (how == InitialGuess::kFile) {
    report.summary = file_has_guess ? "file: initial values kept as they are"
                                    : "file: it has no initial values, so the graph's are kept";
    return report;
  }
  if (!shape.has_poses) {
    report.summary = "file: no poses to place (se2/1, se3/1), initial values kept as they are";
    return report;
  }
  Start start = choose ? Best(*graph, file_has_guess) : FromMethod(*graph, how, watch);
  report = std::move(start.report);
  if (report.used != InitialGuess::kFile) graph->SetValues(start.values);
  report.set = report.poses + report.landmarks;
  report.summary = Summary(report);
  return report;
}

}  // namespace graticule
