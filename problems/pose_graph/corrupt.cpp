#include "graticule/problems/pose_graph/corrupt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/suspects.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kGroup = 10;  // as Suenderhauf and Protzel
constexpr std::size_t kLocalRange = 20;
// Draws without a fresh pair in a row, after which the graph is taken to have no more.
constexpr int kMaxTries = 10000;

class Corruptor {
 public:
  Corruptor(const Graph& graph, const CorruptOptions& options)
      : graph_(graph), options_(options), random_(options.seed), result_{graph, {}} {
    for (const FactorId id : ChooseSuspects(graph))
      if (PoseRoleOf(graph.FactorAt(id).type->name) == PoseRole::kBetween) closures_.push_back(id);
    for (FactorId id = 0; id < graph.FactorCount(); ++id) {
      const FactorView factor = graph.FactorAt(id);
      if (PoseRoleOf(factor.type->name) != PoseRole::kBetween) continue;
      taken_.insert(std::minmax(factor.variables[0], factor.variables[1]));
    }
    const std::vector<VariableId> order = graph.KeyOrder();
    place_.resize(order.size());
    for (const VariableId id : order) {
      auto& family = families_[std::string(graph.KeyOf(id).Family())];
      place_[id] = family.size();
      family.push_back(id);
    }
  }

  Corrupted Run() {
    if (!(options_.fraction >= 0 && options_.fraction < 1))
      throw Error("expected a fraction of false closures from 0 to below 1, found " +
                      Shown(options_.fraction),
                  ErrorKind::kUsage);
    if (closures_.empty())
      throw Error("there are no loop closures that false ones could take after", ErrorKind::kUsage);
    if (options_.kind == Corruption::kGrouped) CollectOdometry();
    const auto wanted = static_cast<std::size_t>(std::llround(
        options_.fraction / (1 - options_.fraction) * static_cast<double>(closures_.size())));
    int tries = 0;
    while (result_.outliers.size() < wanted) {
      const std::size_t before = result_.outliers.size();
      AddSome(wanted - before);
      tries = result_.outliers.size() > before ? 0 : tries + 1;
      if (tries == kMaxTries)
        throw Error("found room for " + std::to_string(result_.outliers.size()) + " of " +
                        std::to_string(wanted) + " false closures: the graph has too few poses",
                    ErrorKind::kUsage);
    }
    return std::move(result_);
  }

 private:
  using Pose = std::array<double, 7>;
  using Family = std::vector<VariableId>;  // in the order of the keys
  struct Step {
    bool is_there = false;
    Pose to_next{};
  };

  Family& FamilyOf(VariableId id) { return families_[std::string(graph_.KeyOf(id).Family())]; }

  // The odometry from each pose to the next of its family.
  void CollectOdometry() {
    steps_.resize(graph_.VariableCount());
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const FactorView factor = graph_.FactorAt(id);
      if (PoseRoleOf(factor.type->name) != PoseRole::kBetween || !IsOdometry(graph_, factor))
        continue;
      const VariableId a = factor.variables[0], b = factor.variables[1];
      if (&FamilyOf(a) != &FamilyOf(b)) continue;
      const bool planar = graph_.ValueOf(a).size() == 3;
      Pose a_from_b{};
      CopyPose(planar, factor.measurement.data(), a_from_b.data());
      if (place_[a] + 1 == place_[b]) {
        steps_[a] = {true, a_from_b};
      } else if (place_[b] + 1 == place_[a]) {
        steps_[b].is_there = true;
        Invert(planar, a_from_b.data(), steps_[b].to_next.data());
      }
    }
  }

  bool Draw(const FactorView& like, VariableId* a, VariableId* b) {
    const Family& from = FamilyOf(like.variables[0]);
    const Family& to = FamilyOf(like.variables[1]);
    *a = from[random_.Below(from.size())];
    if (options_.kind != Corruption::kLocal || &from != &to) {
      *b = to[random_.Below(to.size())];
    } else {
      const std::size_t apart = 2 + random_.Below(kLocalRange - 1);
      if (place_[*a] + apart >= to.size()) return false;
      *b = to[place_[*a] + apart];
    }
    // A neighbour's closure would pass for odometry.
    return &from != &to || std::max(place_[*a], place_[*b]) - std::min(place_[*a], place_[*b]) > 1;
  }

  bool Add(const FactorView& like, FactorId like_id, VariableId a, VariableId b,
           const double* a_from_b) {
    if (a == b || graph_.TypeOf(a).name != graph_.TypeOf(like.variables[0]).name ||
        graph_.TypeOf(b).name != graph_.TypeOf(like.variables[1]).name ||
        !taken_.insert(std::minmax(a, b)).second)
      return false;
    const VariableId ends[2] = {a, b};
    result_.outliers.push_back(result_.graph.Add(graph_.FactorTypeIndex(like_id), {ends, 2},
                                                 {a_from_b, like.measurement.size()}, like.noise,
                                                 like.loss, like.source));
    return true;
  }

  // One, or a run of at most so many.
  void AddSome(std::size_t most) {
    const FactorId like_id = closures_[random_.Below(closures_.size())];
    const FactorView like = graph_.FactorAt(like_id);
    VariableId a = 0, b = 0;
    if (!Draw(like, &a, &b) || !Add(like, like_id, a, b, like.measurement.data())) return;
    if (options_.kind != Corruption::kGrouped) return;
    const bool planar = graph_.ValueOf(a).size() == 3;
    Pose a_from_b{};
    CopyPose(planar, like.measurement.data(), a_from_b.data());
    const Family &along_a = FamilyOf(a), &along_b = FamilyOf(b);
    for (std::size_t i = 1; i < std::min(kGroup, most); ++i) {
      if (!steps_[a].is_there || !steps_[b].is_there) return;
      Pose next_a_from_a{}, next_a_from_b{};
      Invert(planar, steps_[a].to_next.data(), next_a_from_a.data());
      Compose(planar, next_a_from_a.data(), a_from_b.data(), next_a_from_b.data());
      Compose(planar, next_a_from_b.data(), steps_[b].to_next.data(), a_from_b.data());
      a = along_a[place_[a] + 1];
      b = along_b[place_[b] + 1];
      if (!Add(like, like_id, a, b, a_from_b.data())) return;
    }
  }

  const Graph& graph_;
  const CorruptOptions options_;
  RandomNumbers random_;
  Corrupted result_;
  std::vector<FactorId> closures_;
  std::set<std::pair<VariableId, VariableId>> taken_;
  std::map<std::string, Family> families_;
  std::vector<std::size_t> place_;  // in its family
  std::vector<Step> steps_;         // by pose; grouped only
};

}  // namespace

Corrupted AddFalseClosures(const Graph& graph, const CorruptOptions& options) {
  return Corruptor(graph, options).Run();
}

}  // namespace graticule
