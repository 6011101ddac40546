#include "graticule/solver/online.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "graticule/solver/bayes_tree.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/numeric_guard.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {

struct Online::Machine {
  Graph graph;
  OnlineOptions options;
  Evaluation evaluation;
  BayesTree tree;
  std::vector<double> points;    // where factors are linearised; laid out as the graph's values
  std::vector<double> estimate;  // points plus steps
  std::vector<char> held;
  bool has_absolute = false;  // something says where the graph is
  bool is_broken = false;     // the tree is to be made anew
  int updates = 0;
  VariableId variables = 0;  // taken in
  FactorId factors = 0;      // taken in

  mutable std::mutex latest_mutex;  // held for the copy of a pointer only
  std::shared_ptr<const Values> latest;

  Machine(Registry types, OnlineOptions wanted)
      : graph(std::move(types)), options(std::move(wanted)), evaluation(graph), tree(evaluation) {
    tree.SetPropagation(options.propagate_above);
  }

  void FindAnchor();
  std::vector<VariableId> Relinearise();
  void TakeIn(OnlineReport* report);
  void Publish();
};

// The first variable stands in for whatever will say where the graph is.
void Online::Machine::FindAnchor() {
  for (VariableId id = variables; id < graph.VariableCount(); ++id)
    has_absolute = has_absolute || graph.IsFixed(id);
  for (FactorId id = factors; id < graph.FactorCount(); ++id)
    has_absolute = has_absolute || !graph.FactorAt(id).type->IsRelative();
  held.resize(graph.VariableCount(), 0);
  if (graph.VariableCount() == 0 || held[0] == (has_absolute ? 0 : 1)) return;
  held[0] = has_absolute ? 0 : 1;
  if (variables > 0) is_broken = true;
}

// Moves the points of variables that have gone far along their steps.
std::vector<VariableId> Online::Machine::Relinearise() {
  std::vector<VariableId> moved;
  for (VariableId id = 0; id < variables; ++id) {
    if (tree.IsHeld(id)) continue;
    const double* step = tree.StepOf(id);
    double largest = 0;
    for (int k = 0; k < graph.TypeOf(id).TangentSize(); ++k)
      largest = std::max(largest, std::abs(step[k]));
    if (largest <= options.relinearise_above) continue;
    moved.push_back(id);
    const std::size_t begin = graph.Offset(id);
    std::copy_n(estimate.begin() + static_cast<std::ptrdiff_t>(begin), graph.TypeOf(id).Size(),
                points.begin() + static_cast<std::ptrdiff_t>(begin));
    tree.ResetStep(id);
  }
  return moved;
}

void Online::Machine::TakeIn(OnlineReport* report) {
  evaluation.Grow();
  FindAnchor();
  report->new_variables = graph.VariableCount() - variables;
  report->new_factors = graph.FactorCount() - factors;
  for (VariableId id = variables; id < graph.VariableCount(); ++id) {
    const Span<const double> value = graph.ValueOf(id);
    points.insert(points.end(), value.begin(), value.end());
  }
  estimate.insert(estimate.end(), points.begin() + static_cast<std::ptrdiff_t>(estimate.size()),
                  points.end());
  std::vector<VariableId> moved;
  if (is_broken) {
    points = estimate;
    tree.Clear();
    report->relinearised = variables;
  } else if (++updates % options.relinearise_every == 0) {
    moved = Relinearise();
    report->relinearised = moved.size();
  }
  variables = static_cast<VariableId>(graph.VariableCount());
  factors = static_cast<FactorId>(graph.FactorCount());

  is_broken = true;  // unless it ends well
  const BayesTree::Work work = tree.Update(points.data(), moved, held);
  is_broken = false;
  report->eliminated = work.variables;
  report->changed = tree.Changed().size();
  for (const VariableId id : work.loose) report->loose.push_back(graph.KeyOf(id));
  for (const VariableId id : tree.Changed())
    graph.TypeOf(id).Plus(points.data() + graph.Offset(id), tree.StepOf(id),
                          estimate.data() + graph.Offset(id));
}

void Online::Machine::Publish() {
  auto values = std::make_shared<Values>(graph.InitialValues());
  values->MutableData() = estimate;
  const std::lock_guard<std::mutex> lock(latest_mutex);
  latest = std::move(values);
}

Online::Online(Registry types, OnlineOptions options)
    : machine_(std::make_unique<Machine>(std::move(types), std::move(options))) {}

Online::~Online() = default;

VariableId Online::Add(const Key& key, std::string_view type, const std::vector<double>& value,
                       bool fixed) {
  return machine_->graph.Add(key, type, value, fixed);
}

FactorId Online::Add(const Factor& factor) { return machine_->graph.Add(factor); }

OnlineReport Online::Update() {
  const NumericGuard guard;
  const Stopwatch clock;
  OnlineReport report;
  machine_->TakeIn(&report);
  machine_->Publish();
  report.seconds = clock.Elapsed().wall;
  return report;
}

OnlineReport Online::UpdateExactly() {
  const NumericGuard guard;
  const Stopwatch clock;
  Machine& m = *machine_;
  OnlineReport report;
  m.TakeIn(&report);
  Graph problem = Problem();
  if (problem.VariableCount() > 0 && m.held[0]) problem.SetFixed(0, true);
  SolveOptions options = m.options.solve;
  options.allow_pieces = true;
  const Solution solution = Solve(problem, options);
  if (solution.report.termination == Termination::kFailed)
    throw Error(solution.report.message, ErrorKind::kOther);
  report.objective = solution.report.final_objective;
  m.points = m.estimate = solution.values.Data();
  m.is_broken = true;
  OnlineReport rebuilt;
  m.TakeIn(&rebuilt);
  report.loose = rebuilt.loose;
  m.estimate = solution.values.Data();  // the last step is below what was asked for
  m.points = m.estimate;
  report.relinearised = report.changed = report.eliminated = m.variables;
  m.Publish();
  report.seconds = clock.Elapsed().wall;
  return report;
}

void Online::Freeze(const std::vector<Key>& keys) {
  Machine& m = *machine_;
  std::vector<VariableId> ids;
  for (const Key& key : keys) ids.push_back(m.graph.IdOf(key));
  for (const VariableId id : ids) m.graph.SetFixed(id, true);
  m.has_absolute = m.has_absolute || !ids.empty();
  if (!m.held.empty() && m.has_absolute) m.held[0] = 0;
  m.is_broken = true;
}

std::shared_ptr<const Values> Online::Latest() const {
  const std::lock_guard<std::mutex> lock(machine_->latest_mutex);
  return machine_->latest;
}

std::vector<double> Online::Covariance(const Key& key) const {
  const VariableId id = machine_->graph.IdOf(key);
  if (id >= machine_->variables || machine_->is_broken)
    throw Error(key.ToString() + " is not in an update yet");
  return machine_->tree.Covariance(id);
}

Graph Online::Problem() const {
  Graph problem = machine_->graph;
  Values values = problem.InitialValues();
  std::copy(machine_->estimate.begin(), machine_->estimate.end(), values.MutableData().begin());
  problem.SetValues(values);
  return problem;
}

}  // namespace graticule
