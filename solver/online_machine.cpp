#include "graticule/solver/online_machine.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

void CheckThreshold(const char* name, double value) {
  if (!(value >= 0))
    throw Error(std::string(name) + ": expected a number of 0 or more, found " + Shown(value),
                ErrorKind::kUsage);
}

}  // namespace

Online::Machine::Machine(Registry types, OnlineOptions wanted)
    : graph(std::move(types)),
      options(std::move(wanted)),
      evaluation(graph),
      tree(evaluation, terms) {
  CheckThreshold("relinearise_above", options.relinearise_above);
  CheckThreshold("propagate_above", options.propagate_above);
  if (options.relinearise_every < 1)
    throw Error("relinearise_every: expected a number of 1 or more, found " +
                    std::to_string(options.relinearise_every),
                ErrorKind::kUsage);
  tree.SetPropagation(options.propagate_above);
  for (const auto& [family, count] : options.lag) by_family[family];
}

void Online::Machine::CheckStays(VariableId id) const {
  if (HasLeft(id))
    throw Error(graph.KeyOf(id).ToString() +
                " was marginalised: it has left the problem, and only its last value is known");
}

void Online::Machine::FindAbsolutes() {
  for (VariableId id = variables; id < graph.VariableCount(); ++id) absolutes += graph.IsFixed(id);
  for (FactorId id = factors; id < graph.FactorCount(); ++id)
    absolutes += StandingOf(id) == kCounts && !graph.FactorAt(id).type->IsRelative();
}

// The first variable stands in for whatever will say where the graph is.
void Online::Machine::ReviewAnchor() {
  if (graph.VariableCount() == 0 || has_left[0]) return;
  const bool is_needed = absolutes == 0;
  if (is_held[0] == static_cast<char>(is_needed)) return;
  is_held[0] = is_needed;
  if (variables > 0 && !graph.IsFixed(0)) is_broken = true;
}

// Factors are linearised where the variable is now, from the next update on.
void Online::Machine::MoveTo(VariableId id) {
  const auto begin = static_cast<std::ptrdiff_t>(graph.Offset(id));
  std::copy_n(estimate.begin() + begin, graph.TypeOf(id).Size(), points.begin() + begin);
  tree.ResetStep(id);
}

// Moves the points of variables that have gone far along their steps.
void Online::Machine::Relinearise() {
  for (const VariableId id : movable) {
    if (tree.IsHeld(id)) continue;
    const double* step = tree.StepOf(id);
    double largest = 0;
    for (int k = 0; k < graph.TypeOf(id).TangentSize(); ++k)
      largest = std::max(largest, std::abs(step[k]));
    if (largest <= options.relinearise_above) continue;
    changes.moved.push_back(id);
    MoveTo(id);
  }
}

void Online::Machine::TakeIn(OnlineReport* report) {
  standing.resize(graph.FactorCount(), kCounts);
  evaluation.Grow(standing);
  is_held.resize(graph.VariableCount(), 0);
  has_left.resize(graph.VariableCount(), 0);
  FindAbsolutes();
  ReviewAnchor();
  report->new_variables = graph.VariableCount() - variables;
  report->new_factors = static_cast<std::size_t>(
      std::count(standing.begin() + static_cast<std::ptrdiff_t>(factors), standing.end(), kCounts));
  for (VariableId id = variables; id < graph.VariableCount(); ++id) {
    const Span<const double> value = graph.ValueOf(id);
    points.insert(points.end(), value.begin(), value.end());
    estimate.insert(estimate.end(), value.begin(), value.end());
    const auto family = by_family.find(std::string(graph.KeyOf(id).Family()));
    if (family != by_family.end()) family->second.push_back(id);
  }
  if (is_broken) {
    points = estimate;
    tree.Clear();
    changes = {};
    report->relinearised = variables;
  } else if (++updates % options.relinearise_every == 0) {
    Relinearise();
    report->relinearised = changes.moved.size();
  }
  for (VariableId id = variables; id < graph.VariableCount(); ++id)
    if (!graph.IsFixed(id)) movable.push_back(id);
  variables = static_cast<VariableId>(graph.VariableCount());
  factors = static_cast<FactorId>(graph.FactorCount());

  is_broken = true;  // unless it ends well
  const BayesTree::Work work = tree.Update(points.data(), changes, is_held, standing);
  is_broken = false;
  changes = {};
  report->eliminated = work.variables;
  report->changed = tree.Changed().size();
  for (const VariableId id : work.loose) report->loose.push_back(graph.KeyOf(id));
  for (const VariableId id : tree.Changed()) {
    graph.TypeOf(id).Plus(points.data() + graph.Offset(id), tree.StepOf(id),
                          estimate.data() + graph.Offset(id));
    unpublished.push_back(id);
  }
}

void Online::Machine::Step(OnlineReport* report) {
  if (!is_broken && !by_family.empty()) {
    const std::vector<VariableId> leaving = Lagging();
    if (!leaving.empty()) Marginalise(leaving);
    report->marginalised = leaving.size();
  }
  TakeIn(report);
}

void Online::Machine::Publish() {
  std::shared_ptr<const Values> values = snapshots.Make(graph, estimate, unpublished);
  unpublished.clear();
  const std::lock_guard<std::mutex> lock(latest_mutex);
  latest.swap(values);
}

// Those beyond their family's lag that no new factor touches.
std::vector<VariableId> Online::Machine::Lagging() const {
  std::map<std::string, std::size_t> coming;
  for (VariableId id = variables; id < graph.VariableCount(); ++id)
    ++coming[std::string(graph.KeyOf(id).Family())];
  std::set<VariableId> wanted;
  for (FactorId id = factors; id < graph.FactorCount(); ++id)
    if (StandingOf(id) == kCounts)
      for (const VariableId variable : graph.VariablesOf(id)) wanted.insert(variable);
  std::vector<VariableId> leaving;
  for (const auto& [family, ids] : by_family) {
    const std::size_t stay = std::max<std::size_t>(options.lag.at(family), 1),
                      all = ids.size() + coming[family];
    for (std::size_t i = 0; i < ids.size() && i + stay < all; ++i)
      if (!wanted.count(ids[i])) leaving.push_back(ids[i]);
  }
  std::sort(leaving.begin(), leaving.end());
  return leaving;
}

// `ids` are sorted.
void Online::Machine::StopMoving(const std::vector<VariableId>& ids) {
  movable.erase(
      std::remove_if(movable.begin(), movable.end(),
                     [&](VariableId id) { return std::binary_search(ids.begin(), ids.end(), id); }),
      movable.end());
}

void Online::Machine::Freeze(const std::vector<VariableId>& ids) {
  std::vector<VariableId> frozen;
  for (const VariableId id : ids) {
    if (graph.IsFixed(id)) continue;
    graph.SetFixed(id, true);
    if (id >= variables) continue;
    ++absolutes;
    frozen.push_back(id);
    if (is_broken) continue;
    changes.held.push_back(id);
    MoveTo(id);
  }
  std::sort(frozen.begin(), frozen.end());
  StopMoving(frozen);
}

void Online::Machine::Marginalise(const std::vector<VariableId>& ids) {
  std::vector<FactorId> said;
  for (const VariableId id : ids)
    for (const FactorId factor : tree.FactorsOf(id))
      if (StandingOf(factor) == kCounts) said.push_back(factor);
  std::sort(said.begin(), said.end());
  said.erase(std::unique(said.begin(), said.end()), said.end());
  std::vector<int> used;
  std::vector<const GaussianTerm*> said_before;
  for (const auto& [number, term] : terms)
    if (std::any_of(term.variables.begin(), term.variables.end(), [&](VariableId id) {
          return std::binary_search(ids.begin(), ids.end(), id);
        })) {
      used.push_back(number);
      said_before.push_back(&term);
    }
  std::vector<GaussianTerm> left = MarginaliseOut(
      ids, said, said_before, evaluation, estimate.data(),
      [this](VariableId id) { return graph.IsFixed(id) || is_held[id] || tree.IsHeld(id); });

  for (const int number : used) terms.erase(number);
  for (GaussianTerm& term : left) terms.emplace(next_term++, std::move(term));
  for (const FactorId factor : said) {
    standing[factor] = kMarginalised;
    changes.withdrawn.push_back(factor);
  }
  for (const VariableId id : ids) {
    has_left[id] = is_held[id] = 1;
    changes.held.push_back(id);
    MoveTo(id);
    const auto family = by_family.find(std::string(graph.KeyOf(id).Family()));
    if (family != by_family.end())
      family->second.erase(std::find(family->second.begin(), family->second.end(), id));
  }
  StopMoving(ids);
  is_whole = false;
  // What was said of others is said in the frame that the anchor holds.
  if (absolutes == 0) Freeze({0});
}

void Online::Machine::Remove(FactorId id) {
  standing.resize(graph.FactorCount(), kCounts);
  standing[id] = kRemoved;
  is_whole = false;
  if (id >= factors) return;
  absolutes -= !graph.FactorAt(id).type->IsRelative();
  if (!is_broken) changes.withdrawn.push_back(id);
}

template <class KeepsVariable, class KeepsFactor>
Graph Online::Machine::Part(KeepsVariable&& keeps_variable, KeepsFactor&& keeps_factor) const {
  Graph part(graph.Types());
  std::vector<VariableId> places(graph.VariableCount(), Layout::kNone), variables_there;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    if (!keeps_variable(id)) continue;
    const Span<const double> first = graph.ValueOf(id);
    const std::size_t begin = graph.Offset(id);
    const Span<const double> value =
        id < variables ? Span<const double>(estimate.data() + begin, first.size()) : first;
    places[id] = part.Add(graph.KeyOf(id), part.VariableTypeId(graph.TypeOf(id).name), value,
                          graph.IsFixed(id));
  }
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    if (!keeps_factor(id)) continue;
    const FactorView factor = graph.FactorAt(id);
    variables_there.clear();
    for (const VariableId variable : factor.variables) variables_there.push_back(places[variable]);
    part.Add(part.FactorTypeId(factor.type->name), variables_there, factor.measurement,
             factor.noise, factor.loss, factor.source);
  }
  return part;
}

Graph Online::Machine::Remaining() const {
  if (is_whole) return Recorded();
  Graph part = Part([this](VariableId id) { return !HasLeft(id); },
                    [this](FactorId id) { return StandingOf(id) == kCounts; });
  for (const auto& [number, term] : terms) {
    Factor factor;
    factor.type = kGaussian;
    for (const VariableId id : term.variables) factor.keys.push_back(graph.KeyOf(id));
    factor.measurement = term.gaussian.Measurement();
    factor.source = "marginal";
    part.Add(factor);
  }
  return part;
}

Graph Online::Machine::Recorded() const {
  if (std::find(standing.begin(), standing.end(), kRemoved) != standing.end())
    return Part([](VariableId) { return true; },
                [this](FactorId id) { return StandingOf(id) != kRemoved; });
  Graph all = graph;
  Values values = all.InitialValues();
  std::copy(estimate.begin(), estimate.end(), values.MutableData().begin());
  all.SetValues(values);
  return all;
}

}  // namespace graticule
