#include "graticule/problems/pose_graph/replay.hpp"

#include <algorithm>
#include <limits>

#include "graticule/problems/pose_graph/odometry_tree.hpp"
#include "graticule/problems/pose_graph/placing.hpp"
#include "graticule/solver/diagnose.hpp"

namespace graticule {
namespace {

template <int kSize>
double TurnVarianceOf(const FactorView& between) {
  constexpr int kTurn = kSize == 3 ? 1 : 3;
  UncertainPose<kSize> measured;
  if (!MeasuredPoseOf<kSize>(between, &measured)) return std::numeric_limits<double>::infinity();
  return measured.covariance.template bottomRightCorner<kTurn, kTurn>().trace();
}

}  // namespace

Replay::Replay(const Graph& graph, Online* online)
    : graph_(graph),
      online_(online),
      guess_(graph.InitialValues()),
      order_(graph.KeyOrder()),
      rank_(graph.VariableCount()),
      is_pose_(graph.VariableCount()),
      is_anchor_(graph.VariableCount()),
      awaits_sight_(graph.VariableCount()),
      is_queued_(graph.VariableCount()),
      factors_(graph.VariableCount()),
      prior_(graph.VariableCount(), kNoFactor),
      first_bearing_(graph.VariableCount(), kNoFactor),
      missing_(graph.FactorCount()),
      place_(graph.VariableCount(), Layout::kNone) {
  for (const FactorType& type : graph.UsedFactorTypes()) {
    roles_.push_back(PoseRoleOf(type.name));
    sights_.push_back(SightOf(type.name));
  }
  for (std::size_t rank = 0; rank < order_.size(); ++rank) rank_[order_[rank]] = rank;
  Sort();
  for (const Structure::Piece& piece : AnalyseStructure(graph).pieces)
    if (piece.IsLoose()) is_anchor_[piece.anchor] = 1;
}

// Who is what, and which factors wait for whom.
void Replay::Sort() {
  for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
    const Span<const VariableId> variables = graph_.VariablesOf(id);
    missing_[id] = variables.size();
    for (const VariableId variable : variables) factors_[variable].push_back(id);
    const PoseRole role = roles_[graph_.FactorTypeIndex(id)];
    if ((role == PoseRole::kPrior || role == PoseRole::kPriorWithOffset) &&
        prior_[variables[0]] == kNoFactor)
      prior_[variables[0]] = id;
    if (sights_[graph_.FactorTypeIndex(id)] != Sight::kNone && !graph_.IsFixed(variables[1]))
      awaits_sight_[variables[1]] = 1;
  }
  for (const VariableId id : order_) {
    is_pose_[id] = graticule::IsPose(graph_.TypeOf(id));
    if (!is_pose_[id] || factors_[id].empty()) continue;
    ++awaited_poses_;
    if (prior_[id] == kNoFactor) continue;
    queue_.push(rank_[id]);
    is_queued_[id] = 1;
  }
}

const double* Replay::At(VariableId id) const {
  const bool is_updated = latest_ && IsIn(id) && place_[id] < latest_->Count();
  return is_updated ? (*latest_)[place_[id]].data() : guess_[id].data();
}

void Replay::Refresh() {
  if (online_) latest_ = online_->Latest();
}

void Replay::Next() {
  if (is_done_) return;
  Refresh();
  const bool is_first = entered_ == 0;
  if (is_first) EnterFixed();
  if (awaited_poses_ > 0) {
    const VariableId pose = NextPose();
    Place(pose);
    EnterPose(pose);
  }
  if (is_first) EnterOthers();
  if (awaited_poses_ > 0) return;
  EnterUnseen();
  is_done_ = true;
}

void Replay::PlaceTheRest() {
  Refresh();
  online_ = nullptr;
  while (!is_done_) Next();
}

VariableId Replay::NextPose() {
  while (!queue_.empty()) {
    const VariableId pose = order_[queue_.top()];
    queue_.pop();
    if (!IsIn(pose)) return pose;
  }
  const auto is_awaited = [&](VariableId id) {
    return is_pose_[id] && !IsIn(id) && !factors_[id].empty();
  };
  while (!is_awaited(order_[next_root_])) ++next_root_;
  return order_[next_root_];
}

void Replay::Place(VariableId pose) {
  FactorId best = kNoFactor;
  VariableId from = Layout::kNone;
  for (const FactorId id : factors_[pose]) {
    if (roles_[graph_.FactorTypeIndex(id)] != PoseRole::kBetween) continue;
    const Span<const VariableId> ends = graph_.VariablesOf(id);
    const VariableId other = ends[ends[0] == pose ? 1 : 0];
    if (!IsIn(other) || (best != kNoFactor && place_[other] <= place_[from])) continue;
    best = id;
    from = other;
  }
  double* value = guess_.Mutable(pose);
  turn_variance_ = 0;
  if (best != kNoFactor) {
    const FactorView between = graph_.FactorAt(best);
    PoseFromBetween(IsPlanar(pose), between, between.variables[0] == from, At(from), value);
    turn_variance_ = IsPlanar(pose) ? TurnVarianceOf<3>(between) : TurnVarianceOf<6>(between);
    ++poses_;
    return;
  }
  ++roots_;
  if (prior_[pose] != kNoFactor) {
    PoseFromPrior(IsPlanar(pose), graph_.FactorAt(prior_[pose]), value);
    ++poses_;
  } else {
    ++free_roots_;
  }
}

void Replay::Enter(VariableId id) {
  if (online_) {
    const Span<const double> value = guess_[id];
    online_->Add(graph_.KeyOf(id), graph_.TypeOf(id).name, {value.begin(), value.end()},
                 graph_.IsFixed(id) || is_anchor_[id]);
  }
  place_[id] = entered_++;
  for (const FactorId factor : factors_[id])
    if (--missing_[factor] == 0 && online_) Say(factor);
}

void Replay::Say(FactorId id) {
  for (const VariableId variable : graph_.VariablesOf(id))
    if (online_->HasLeft(graph_.KeyOf(variable))) {
      ++passed_over_;
      return;
    }
  online_->Add(graph_.FactorRecord(id));
}

void Replay::EnterPose(VariableId pose) {
  --awaited_poses_;
  Enter(pose);
  for (const FactorId id : factors_[pose]) {
    if (roles_[graph_.FactorTypeIndex(id)] != PoseRole::kBetween) continue;
    for (const VariableId other : graph_.VariablesOf(id)) {
      if (IsIn(other) || is_queued_[other]) continue;
      queue_.push(rank_[other]);
      is_queued_[other] = 1;
    }
  }
  SeeFrom(pose);
}

void Replay::SeeFrom(VariableId pose) {
  for (const FactorId id : factors_[pose]) {
    const Sight sight = sights_[graph_.FactorTypeIndex(id)];
    if (sight == Sight::kNone) continue;
    const FactorView sighting = graph_.FactorAt(id);
    const VariableId landmark = sighting.variables[1];
    if (IsIn(landmark) || !awaits_sight_[landmark]) continue;
    bool is_known = SaysAll(sight);
    if (is_known) {
      PlaceFromSight(sight, At(pose), sighting.measurement.data(), guess_.Mutable(landmark));
    } else if (sight == Sight::kBearing) {
      FactorId& first = first_bearing_[landmark];
      if (first == kNoFactor) first = id;
      const FactorView before = graph_.FactorAt(first);
      PartialSightings two;
      two.Add(sight, At(before.variables[0]), before.measurement.data());
      two.Add(sight, At(pose), sighting.measurement.data());
      is_known = two.Place(guess_.Mutable(landmark));
    }
    if (!is_known) continue;
    ++landmarks_;
    Enter(landmark);
  }
}

void Replay::EnterFixed() {
  for (const VariableId id : order_) {
    if (!graph_.IsFixed(id) || factors_[id].empty()) continue;
    if (!is_pose_[id]) {
      Enter(id);
      continue;
    }
    ++roots_;
    EnterPose(id);
  }
}

void Replay::EnterOthers() {
  for (const VariableId id : order_)
    if (!is_pose_[id] && !awaits_sight_[id] && !IsIn(id) && !factors_[id].empty()) Enter(id);
}

void Replay::EnterUnseen() {
  for (const VariableId id : order_) {
    if (!awaits_sight_[id] || IsIn(id)) continue;
    PartialSightings all;
    for (const FactorId factor : factors_[id]) {
      const Sight sight = sights_[graph_.FactorTypeIndex(factor)];
      if (sight == Sight::kNone) continue;
      const FactorView sighting = graph_.FactorAt(factor);
      all.Add(sight, At(sighting.variables[0]), sighting.measurement.data());
    }
    if (!all.Place(guess_.Mutable(id))) ++assumed_;
    ++landmarks_;
    Enter(id);
  }
}

Values Replay::Current() {
  Refresh();
  Values values = guess_;
  for (VariableId id = 0; id < graph_.VariableCount(); ++id)
    std::copy_n(At(id), values[id].size(), values.Mutable(id));
  return values;
}

}  // namespace graticule
