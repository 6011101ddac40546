#include "graticule/solver/online.hpp"

#include <algorithm>

#include "graticule/solver/error.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/solver/online_machine.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {

Online::Online(Registry types, OnlineOptions options)
    : machine_(std::make_unique<Machine>(std::move(types), std::move(options))) {}

Online::~Online() = default;

VariableId Online::Add(const Key& key, std::string_view type, const std::vector<double>& value,
                       bool fixed) {
  return machine_->graph.Add(key, type, value, fixed);
}

FactorId Online::Add(const Factor& factor) {
  for (const Key& key : factor.keys) {
    const VariableId id = machine_->graph.Find(key);
    if (id != Layout::kNone && machine_->HasLeft(id))
      throw Error(factor.type + ": " + key.ToString() +
                  " was marginalised: no factor can reach it any more (a longer lag keeps it)");
  }
  return machine_->graph.Add(factor);
}

OnlineReport Online::Update() {
  const NumericGuard guard;
  const Stopwatch clock;
  OnlineReport report;
  machine_->Step(&report);
  machine_->Publish();
  report.seconds = clock.Elapsed().wall;
  return report;
}

OnlineReport Online::UpdateExactly() {
  const NumericGuard guard;
  const Stopwatch clock;
  Machine& m = *machine_;
  OnlineReport report;
  m.Step(&report);
  Graph problem = m.Remaining();
  if (problem.VariableCount() > 0 && m.absolutes == 0) problem.SetFixed(0, true);
  SolveOptions options = m.options.solve;
  options.allow_pieces = true;
  const Solution solution = Solve(problem, options);
  if (solution.report.termination == Termination::kFailed)
    throw Error(solution.report.message, ErrorKind::kOther);
  report.objective = solution.report.final_objective;
  report.termination = solution.report.termination;
  report.message = solution.report.message;
  std::vector<double> found = m.estimate;
  for (VariableId place = 0; place < problem.VariableCount(); ++place) {
    const VariableId id = m.is_whole ? place : m.graph.Find(problem.KeyOf(place));
    const Span<const double> value = solution.values[place];
    std::copy(value.begin(), value.end(),
              found.begin() + static_cast<std::ptrdiff_t>(m.graph.Offset(id)));
    m.unpublished.push_back(id);
  }
  m.estimate = found;
  m.is_broken = true;
  OnlineReport rebuilt;
  m.TakeIn(&rebuilt);
  report.loose = rebuilt.loose;
  m.points = m.estimate = std::move(found);  // the last step is below what was asked for
  report.relinearised = report.changed = report.eliminated = problem.VariableCount();
  m.Publish();
  report.seconds = clock.Elapsed().wall;
  return report;
}

void Online::Freeze(const std::vector<Key>& keys) {
  std::vector<VariableId> ids;
  for (const Key& key : keys) {
    ids.push_back(machine_->graph.IdOf(key));
    machine_->CheckStays(ids.back());
  }
  machine_->Freeze(ids);
}

void Online::Marginalise(const std::vector<Key>& keys) {
  Machine& m = *machine_;
  std::vector<VariableId> ids;
  for (const Key& key : keys) {
    const VariableId id = m.graph.IdOf(key);
    m.CheckStays(id);
    if (id >= m.variables) throw Error(key.ToString() + " is not in an update yet");
    ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  if (ids.empty()) return;
  if (m.is_broken)
    throw Error("the last update failed: variables can be marginalised after one that succeeds");
  for (FactorId id = m.factors; id < m.graph.FactorCount(); ++id)
    for (const VariableId variable : m.graph.VariablesOf(id))
      if (m.StandingOf(id) == Machine::kCounts &&
          std::binary_search(ids.begin(), ids.end(), variable))
        throw Error(m.graph.KeyOf(variable).ToString() + " has a factor, number " +
                    std::to_string(id) + ", that is not in an update yet");
  m.Marginalise(ids);
}

bool Online::HasLeft(const Key& key) const { return machine_->HasLeft(machine_->graph.IdOf(key)); }

void Online::Remove(FactorId id) {
  Machine& m = *machine_;
  const std::string name = "factor " + std::to_string(id);
  if (id >= m.graph.FactorCount())
    throw Error("there is no " + name + ": " + std::to_string(m.graph.FactorCount()) +
                " have been added");
  if (m.StandingOf(id) == Machine::kRemoved) throw Error(name + " was removed already");
  if (m.StandingOf(id) == Machine::kMarginalised) {
    std::string keys;
    for (const VariableId variable : m.graph.VariablesOf(id))
      keys += (keys.empty() ? "" : " ") + m.graph.KeyOf(variable).ToString();
    throw Error(name + " (" + keys +
                ") cannot be removed any more: a variable of it was marginalised");
  }
  m.Remove(id);
}

std::shared_ptr<const Values> Online::Latest() const {
  const std::lock_guard<std::mutex> lock(machine_->latest_mutex);
  return machine_->latest;
}

std::vector<double> Online::Covariance(const Key& key) const {
  const VariableId id = machine_->graph.IdOf(key);
  machine_->CheckStays(id);
  if (id >= machine_->variables || machine_->is_broken)
    throw Error(key.ToString() + " is not in an update yet");
  return machine_->tree.Covariance(id);
}

Graph Online::Problem() const { return machine_->Remaining(); }

Graph Online::Recorded() const { return machine_->Recorded(); }

}  // namespace graticule
