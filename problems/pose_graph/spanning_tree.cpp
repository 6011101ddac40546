#include "graticule/problems/pose_graph/spanning_tree.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/placing.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"

namespace graticule {
namespace {

// Walks over the between factors and places what it meets.
class Walk {
 public:
  Walk(const Graph& graph, Growth growth, Values* values)
      : graph_(graph),
        growth_(growth),
        values_(values),
        order_(graph.KeyOrder()),
        placed_(graph.VariableCount()),
        depth_(graph.VariableCount()) {
    for (const VariableType& type : graph.UsedVariableTypes())
      pose_type_.push_back(graticule::IsPose(type));
    for (const FactorType& type : graph.UsedFactorTypes()) roles_.push_back(PoseRoleOf(type.name));
    CollectEdges();
    if (growth == Growth::kAlongChains) CollectChains();
    if (growth == Growth::kLeastUncertainty) weights_ = Uncertainties();
  }

  void Run(SpanningTreeReport* report) {
    for (const VariableId id : order_)
      if (IsPose(id) && graph_.IsFixed(id)) AddRoot(id, report);
    const std::vector<FactorId> priors = FirstPriors();
    for (const VariableId id : order_) {
      if (priors[id] == kNone || placed_[id]) continue;
      PoseFromPrior(IsPlanar(id), graph_.FactorAt(priors[id]), values_->Mutable(id));
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
      if (roles_[graph_.FactorTypeIndex(id)] != PoseRole::kBetween) continue;
      for (const VariableId end : graph_.FactorAt(id).variables) ++first_[end + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    edges_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      if (roles_[graph_.FactorTypeIndex(id)] != PoseRole::kBetween) continue;
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
      const PoseRole role = roles_[graph_.FactorTypeIndex(id)];
      if (role != PoseRole::kPrior && role != PoseRole::kPriorWithOffset) continue;
      FactorId& prior = priors[graph_.FactorAt(id).variables[0]];
      if (prior == kNone) prior = id;
    }
    return priors;
  }

  void AddRoot(VariableId id, SpanningTreeReport* report) {
    ++report->roots;
    placed_[id] = 1;
    queue_.push_back(id);
  }

  // Places `to` from `from`, over a between factor of the two.
  void Place(VariableId from, VariableId to, FactorId factor, bool from_is_a) {
    PoseFromBetween(IsPlanar(from), graph_.FactorAt(factor), from_is_a, (*values_)[from].data(),
                    values_->Mutable(to));
    placed_[to] = 1;
    queue_.push_back(to);
  }

  void FollowChain(VariableId from, bool forward, SpanningTreeReport* report) {
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

  void FollowChains(VariableId from, SpanningTreeReport* report) {
    if (links_.empty()) return;
    FollowChain(from, true, report);
    FollowChain(from, false, report);
  }

  // From all roots in the queue at once.
  void Spread(SpanningTreeReport* report) {
    if (growth_ == Growth::kLeastUncertainty) return SpreadByUncertainty(report);
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

  // Prim's algorithm; among factors that are equally certain, the one nearest to a root, so that
  // equal weights give the breadth-first tree.
  void SpreadByUncertainty(SpanningTreeReport* report) {
    struct Step {
      double weight;
      std::size_t depth, number;  // of measurements to a root; of the step, as it was found
      VariableId from;
      std::size_t edge;
      bool operator<(const Step& other) const {  // the least stands first in the queue
        return std::tie(other.weight, other.depth, other.number) < std::tie(weight, depth, number);
      }
    };
    std::priority_queue<Step> steps;
    std::size_t number = 0;
    const auto leave = [&](VariableId from) {
      for (std::size_t e = first_[from]; e < first_[from + 1]; ++e)
        if (!placed_[edges_[e].other])
          steps.push({weights_[edges_[e].factor], depth_[from] + 1, number++, from, e});
    };
    for (; head_ < queue_.size(); ++head_) leave(queue_[head_]);
    while (!steps.empty()) {
      const Step step = steps.top();
      steps.pop();
      const Edge& edge = edges_[step.edge];
      if (placed_[edge.other]) continue;
      Place(step.from, edge.other, edge.factor, edge.is_a);
      depth_[edge.other] = step.depth;
      ++report->poses;
      ++head_;
      leave(edge.other);
    }
  }

  // By factor: the trace of a between factor's covariance.
  std::vector<double> Uncertainties() const {
    std::vector<double> weights(graph_.FactorCount());
    for (FactorId id = 0; id < graph_.FactorCount(); ++id)
      if (roles_[graph_.FactorTypeIndex(id)] == PoseRole::kBetween)
        weights[id] = CovarianceTrace(graph_.FactorAt(id), graph_.ResidualSize(id));
    return weights;
  }

  const Graph& graph_;
  const Growth growth_;
  Values* values_;
  std::vector<VariableId> order_;
  std::vector<std::uint8_t> placed_;
  std::vector<std::size_t> depth_;  // measurements to the root; by uncertainty only
  std::vector<bool> pose_type_;
  std::vector<PoseRole> roles_;
  std::vector<std::size_t> first_;
  std::vector<Edge> edges_;
  std::vector<double> weights_;  // by factor; by uncertainty only
  std::vector<Links> links_;     // empty: chains play no part
  std::vector<VariableId> queue_;
  std::size_t head_ = 0;
};

}  // namespace

SpanningTreeReport PlaceBySpanningTree(const Graph& graph, Growth growth, Values* values) {
  SpanningTreeReport report;
  Walk(graph, growth, values).Run(&report);
  return report;
}

}  // namespace graticule
