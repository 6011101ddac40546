#include "graticule/problems/pose_graph/initialise.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "graticule/problems/pose_graph/landmarks.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

const std::vector<std::pair<std::string, InitialGuess>> kNames = {
    {"automatic", InitialGuess::kAutomatic},
    {"file", InitialGuess::kFile},
    {"odometry", InitialGuess::kOdometry},
    {"spanning_tree", InitialGuess::kSpanningTree}};

enum class Role : std::uint8_t { kOther, kBetween, kPrior, kPriorWithOffset };

Role RoleOf(std::string_view type) {
  if (type == "between_se2/1" || type == "between_se3/1" || type == "between_se3_quaternion/1")
    return Role::kBetween;
  if (type == "prior_se2/1" || type == "prior_se3/1" || type == "prior_se3_quaternion/1")
    return Role::kPrior;
  if (type == "prior_offset_se3/1" || type == "prior_offset_se3_quaternion/1")
    return Role::kPriorWithOffset;
  return Role::kOther;
}

// Walks a pose graph breadth first and places what it meets.
class Walk {
 public:
  Walk(const Graph& graph, Values* values, bool along_chains)
      : graph_(graph), values_(values), order_(graph.KeyOrder()), placed_(graph.VariableCount()) {
    const auto& variable_types = graph.UsedVariableTypes();
    for (const VariableType& type : variable_types)
      pose_type_.push_back(type.name == "se2/1" || type.name == "se3/1");
    for (const FactorType& type : graph.UsedFactorTypes()) roles_.push_back(RoleOf(type.name));
    CollectEdges();
    if (along_chains) CollectChains();
  }

  bool HasPoses() const {
    for (VariableId id = 0; id < graph_.VariableCount(); ++id)
      if (IsPose(id)) return true;
    return false;
  }

  void Run(InitialiseReport* report) {
    for (const VariableId id : order_)
      if (IsPose(id) && graph_.IsFixed(id)) AddRoot(id, report);
    const std::vector<FactorId> priors = FirstPriors();
    for (const VariableId id : order_) {
      if (priors[id] == kNone || placed_[id]) continue;
      PlaceFromPrior(id, graph_.FactorAt(priors[id]));
      ++report->poses;
      AddRoot(id, report);
    }
    Spread(report);
    for (const VariableId id : order_) {
      if (!IsPose(id) || placed_[id]) continue;
      ++report->free_roots;
      AddRoot(id, report);
      Spread(report);
    }
  }

 private:
  static constexpr FactorId kNone = 0xffffffffu;
  struct Edge {
    VariableId other;
    FactorId factor;
    bool is_a;  // this end is the factor's a
  };
  // The between factors to the pose's neighbours in the order of keys, if there are any.
  struct Links {
    FactorId to_next = kNone;
    VariableId next = Layout::kNone, previous = Layout::kNone;
    FactorId to_previous = kNone;
  };

  bool IsPose(VariableId id) const { return pose_type_[graph_.VariableTypeIndex(id)]; }
  bool IsPlanar(VariableId id) const { return graph_.ValueOf(id).size() == 3; }

  // Edges of variable i: edges_[first_[i]] .. edges_[first_[i + 1]], in the factors' order.
  void CollectEdges() {
    first_.assign(graph_.VariableCount() + 1, 0);
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      if (roles_[graph_.FactorTypeIndex(id)] != Role::kBetween) continue;
      for (const VariableId end : graph_.FactorAt(id).variables) ++first_[end + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    edges_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      if (roles_[graph_.FactorTypeIndex(id)] != Role::kBetween) continue;
      const auto ends = graph_.FactorAt(id).variables;
      edges_[next[ends[0]]++] = {ends[1], id, true};
      edges_[next[ends[1]]++] = {ends[0], id, false};
    }
  }

  void CollectChains() {
    links_.resize(graph_.VariableCount());
    for (std::size_t i = 0; i + 1 < order_.size(); ++i) {
      const VariableId a = order_[i], b = order_[i + 1];
      if (graph_.KeyOf(a).Family() != graph_.KeyOf(b).Family()) continue;
      for (std::size_t e = first_[a]; e < first_[a + 1]; ++e) {
        if (edges_[e].other != b) continue;
        links_[a].next = b;
        links_[b].previous = a;
        links_[a].to_next = links_[b].to_previous = edges_[e].factor;
        break;
      }
    }
  }

  std::vector<FactorId> FirstPriors() const {
    std::vector<FactorId> priors(graph_.VariableCount(), kNone);
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const Role role = roles_[graph_.FactorTypeIndex(id)];
      if (role != Role::kPrior && role != Role::kPriorWithOffset) continue;
      FactorId& prior = priors[graph_.FactorAt(id).variables[0]];
      if (prior == kNone) prior = id;
    }
    return priors;
  }

  void PlaceFromPrior(VariableId id, const FactorView& prior) {
    const bool planar = IsPlanar(id);
    double world_from_sensor[7];
    CopyPose(planar, prior.measurement.data(), world_from_sensor);
    double* world_from_body = values_->Mutable(id);
    if (RoleOf(prior.type->name) == Role::kPriorWithOffset) {
      double body_from_sensor[7], sensor_from_body[7];
      CopyPose(planar, prior.measurement.data() + 7, body_from_sensor);
      Invert(planar, body_from_sensor, sensor_from_body);
      Compose(planar, world_from_sensor, sensor_from_body, world_from_body);
    } else {
      std::copy_n(world_from_sensor, PoseSize(planar), world_from_body);
    }
  }

  void AddRoot(VariableId id, InitialiseReport* report) {
    ++report->roots;
    placed_[id] = 1;
    queue_.push_back(id);
  }

  // Places `to` from `from`, over a between factor of the two.
  void Place(VariableId from, VariableId to, FactorId factor, bool from_is_a) {
    const bool planar = IsPlanar(from);
    double a_from_b[7];
    CopyPose(planar, graph_.FactorAt(factor).measurement.data(), a_from_b);
    const double* pose = (*values_)[from].data();
    if (from_is_a) {
      Compose(planar, pose, a_from_b, values_->Mutable(to));
    } else {
      double b_from_a[7];
      Invert(planar, a_from_b, b_from_a);
      Compose(planar, pose, b_from_a, values_->Mutable(to));
    }
    placed_[to] = 1;
    queue_.push_back(to);
  }

  void FollowChain(VariableId from, bool forward, InitialiseReport* report) {
    for (;;) {
      const Links& links = links_[from];
      const VariableId to = forward ? links.next : links.previous;
      if (to == Layout::kNone || placed_[to]) return;
      const FactorId factor = forward ? links.to_next : links.to_previous;
      Place(from, to, factor, graph_.FactorAt(factor).variables[0] == from);
      ++report->poses;
      from = to;
    }
  }

  void FollowChains(VariableId from, InitialiseReport* report) {
    if (links_.empty()) return;
    FollowChain(from, true, report);
    FollowChain(from, false, report);
  }

  // From all roots in the queue at once.
  void Spread(InitialiseReport* report) {
    const std::size_t roots = queue_.size();
    for (std::size_t i = head_; i < roots; ++i) FollowChains(queue_[i], report);
    for (; head_ < queue_.size(); ++head_) {
      const VariableId from = queue_[head_];
      for (std::size_t e = first_[from]; e < first_[from + 1]; ++e) {
        const Edge& edge = edges_[e];
        if (placed_[edge.other]) continue;
        Place(from, edge.other, edge.factor, edge.is_a);
        ++report->poses;
        FollowChains(edge.other, report);
      }
    }
  }

  const Graph& graph_;
  Values* values_;
  std::vector<VariableId> order_;
  std::vector<std::uint8_t> placed_;
  std::vector<bool> pose_type_;
  std::vector<Role> roles_;
  std::vector<std::size_t> first_;
  std::vector<Edge> edges_;
  std::vector<Links> links_;  // empty: chains play no part
  std::vector<VariableId> queue_;
  std::size_t head_ = 0;
};

std::string Summary(const InitialiseReport& report) {
  std::string text = ToString(report.used) + ": " + std::to_string(report.poses) + " poses from " +
                     std::to_string(report.roots) + (report.roots == 1 ? " root" : " roots");
  if (report.free_roots) text += " (" + std::to_string(report.free_roots) + " that nothing holds)";
  if (report.landmarks)
    text += ", " + std::to_string(report.landmarks) + " landmarks from their first sighting";
  if (report.assumed)
    text += " (" + std::to_string(report.assumed) + " at an assumed range or direction)";
  return text;
}

}  // namespace

std::string ToString(InitialGuess guess) {
  for (const auto& [name, value] : kNames)
    if (value == guess) return name;
  return "";
}

const std::vector<OptionRow<InitialiseOptions>>& InitialiseOptionTable() {
  static const std::vector<OptionRow<InitialiseOptions>> table = {
      ChoiceOption("initialise", &InitialiseOptions::initialise, kNames,
                   "where a pose graph's initial values come from")};
  return table;
}

InitialiseReport Initialise(Graph* graph, InitialGuess how, bool file_has_guess) {
  InitialiseReport report;
  report.used = how;
  if (how == InitialGuess::kAutomatic)
    report.used = file_has_guess ? InitialGuess::kFile : InitialGuess::kSpanningTree;
  if (report.used == InitialGuess::kFile) {
    report.summary = file_has_guess ? "file: initial values kept as they are"
                                    : "file: it has no initial values, so the graph's are kept";
    return report;
  }
  Values values = graph->InitialValues();
  Walk walk(*graph, &values, report.used == InitialGuess::kOdometry);
  if (!walk.HasPoses()) {
    report.used = InitialGuess::kFile;
    report.summary = "file: no poses to place (se2/1, se3/1), initial values kept as they are";
    return report;
  }
  walk.Run(&report);
  const PlacedLandmarks landmarks = PlaceLandmarks(*graph, &values);
  report.landmarks = landmarks.placed;
  report.assumed = landmarks.assumed;
  report.set = report.poses + report.landmarks;
  graph->SetValues(values);
  report.summary = Summary(report);
  return report;
}

}  // namespace graticule
