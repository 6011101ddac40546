#include "graticule/solver/bayes_tree.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {

void BayesTree::Clear() {
  factors_ = 0;
  variables_ = 0;
  is_held_.clear();
  is_withdrawn_.clear();
  step_begin_.assign(1, 0);
  step_.clear();
  followed_step_.clear();
  clique_of_.clear();
  clique_of_factor_.clear();
  factors_of_.clear();
  linear_begin_.assign(1, 0);
  linear_.clear();
  cliques_.clear();
  free_cliques_.clear();
  clique_of_term_.clear();
  changed_.clear();
  is_changed_.clear();
  place_.clear();
}

void BayesTree::ResetStep(VariableId id) {
  std::fill_n(step_.begin() + step_begin_[id], TangentSize(id), 0.0);
  std::fill_n(followed_step_.begin() + step_begin_[id], TangentSize(id), 0.0);
}

// Makes room for what the graph has that is not here yet.
void BayesTree::Grow(const std::vector<char>& held, const std::vector<char>& withdrawn) {
  const Graph& graph = evaluation_.TheGraph();
  for (VariableId id = variables_; id < graph.VariableCount(); ++id) {
    step_begin_.push_back(step_begin_.back() + graph.TypeOf(id).TangentSize());
    is_held_.push_back(graph.IsFixed(id) || held[id] || graph.TypeOf(id).TangentSize() == 0);
  }
  step_.resize(static_cast<std::size_t>(step_begin_.back()), 0.0);
  followed_step_.resize(step_.size(), 0.0);
  clique_of_.resize(graph.VariableCount(), kNone);
  factors_of_.resize(graph.VariableCount());
  is_changed_.resize(graph.VariableCount(), 0);
  place_.resize(graph.VariableCount(), kNone);
  for (FactorId id = factors_; id < graph.FactorCount(); ++id) {
    is_withdrawn_.push_back(withdrawn[id]);
    std::size_t columns = withdrawn[id] ? 0 : 1;
    if (!withdrawn[id])
      for (const VariableId variable : graph.VariablesOf(id)) {
        columns += static_cast<std::size_t>(TangentSize(variable));
        factors_of_[variable].push_back(id);
      }
    linear_begin_.push_back(linear_begin_.back() +
                            columns * static_cast<std::size_t>(graph.ResidualSize(id)));
  }
  linear_.resize(linear_begin_.back());
  clique_of_factor_.resize(graph.FactorCount(), kNone);
}

void BayesTree::Linearise(FactorId id, const double* points) {
  const Graph& graph = evaluation_.TheGraph();
  const int rows = graph.ResidualSize(id);
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  evaluation_.Blocks(id, points, &blocks);
  double* residual = linear_.data() + linear_begin_[id];
  double* next = residual + rows;
  for (const VariableId variable : graph.VariablesOf(id)) {
    jacobians.push_back(is_held_[variable] ? nullptr : next);
    next += rows * TangentSize(variable);
  }
  if (!evaluation_.Whitened(id, blocks.data(), residual, jacobians.data(), nullptr))
    throw Error(evaluation_.TakeFailure(), ErrorKind::kOther);
  double chi2 = 0, rho[3];
  for (int r = 0; r < rows; ++r) chi2 += residual[r] * residual[r];
  EvaluateLoss(graph.LossOf(id), chi2, rho);
  if (rho[1] == 1) return;
  const double weight = std::sqrt(std::max(rho[1], 0.0));
  for (double* value = residual; value < next; ++value) *value *= weight;
}

void BayesTree::MarkFrom(int clique, std::vector<int>* marked) {
  for (; clique != kNone && !cliques_[static_cast<std::size_t>(clique)].is_marked;
       clique = cliques_[static_cast<std::size_t>(clique)].parent) {
    cliques_[static_cast<std::size_t>(clique)].is_marked = true;
    marked->push_back(clique);
  }
}

void BayesTree::Mark(VariableId variable, std::vector<int>* marked) {
  if (!is_held_[variable]) MarkFrom(clique_of_[variable], marked);
}

void BayesTree::Withdraw(FactorId id, Touched* touched) {
  is_withdrawn_[id] = 1;
  MarkFrom(clique_of_factor_[id], &touched->cliques);
  for (const VariableId variable : evaluation_.TheGraph().VariablesOf(id)) {
    std::vector<FactorId>& of = factors_of_[variable];
    of.erase(std::find(of.begin(), of.end(), id));
  }
}

void BayesTree::Hold(VariableId id, Touched* touched) {
  if (is_held_[id]) return;
  // Whatever clique tells of it is above one of its factors' or terms'.
  Mark(id, &touched->cliques);
  clique_of_[id] = kNone;
  is_held_[id] = 1;
  for (const FactorId factor : factors_of_[id])
    if (factor < factors_) {
      touched->stale.push_back(factor);
      MarkFrom(clique_of_factor_[factor], &touched->cliques);
    }
}

// Terms that went, came, or are linearised anew: a few at any time.
void BayesTree::FollowTerms(const Changes& changes, Touched* touched) {
  for (auto it = clique_of_term_.begin(); it != clique_of_term_.end();) {
    if (terms_.count(it->first)) {
      ++it;
      continue;
    }
    MarkFrom(it->second, &touched->cliques);
    it = clique_of_term_.erase(it);
  }
  std::vector<VariableId> anew = changes.moved;
  anew.insert(anew.end(), changes.held.begin(), changes.held.end());
  std::sort(anew.begin(), anew.end());
  for (const auto& [number, term] : terms_) {
    const auto known = clique_of_term_.find(number);
    if (known != clique_of_term_.end()) {
      if (std::none_of(term.variables.begin(), term.variables.end(), [&](VariableId id) {
            return std::binary_search(anew.begin(), anew.end(), id);
          }))
        continue;
      MarkFrom(known->second, &touched->cliques);
      clique_of_term_.erase(known);
    } else {
      for (const VariableId id : term.variables) Mark(id, &touched->cliques);
    }
    touched->terms.push_back(number);
  }
}

BayesTree::Touched BayesTree::Follow(const Changes& changes) {
  const Graph& graph = evaluation_.TheGraph();
  Touched touched;
  for (const FactorId id : changes.withdrawn) Withdraw(id, &touched);
  for (const VariableId id : changes.held) Hold(id, &touched);
  FollowTerms(changes, &touched);
  for (FactorId id = factors_; id < graph.FactorCount(); ++id) {
    if (is_withdrawn_[id]) continue;
    touched.stale.push_back(id);
    for (const VariableId variable : graph.VariablesOf(id)) Mark(variable, &touched.cliques);
  }
  for (const VariableId variable : changes.moved)
    for (const FactorId id : factors_of_[variable])
      if (id < factors_) {
        touched.stale.push_back(id);
        MarkFrom(clique_of_factor_[id], &touched.cliques);
      }
  std::sort(touched.stale.begin(), touched.stale.end());
  touched.stale.erase(std::unique(touched.stale.begin(), touched.stale.end()), touched.stale.end());
  return touched;
}

BayesTree::Work BayesTree::Update(const double* points, const Changes& changes,
                                  const std::vector<char>& held,
                                  const std::vector<char>& withdrawn) {
  const Graph& graph = evaluation_.TheGraph();
  for (const VariableId id : changed_) is_changed_[id] = 0;
  changed_.clear();
  Grow(held, withdrawn);
  Work work;
  const Touched touched = Follow(changes);
  for (const FactorId id : touched.stale) Linearise(id, points);
  work.factors = touched.stale.size();

  Part part = TakeApart(touched.cliques, factors_, variables_);
  for (const int term : touched.terms) HangIn(term, points, &part);
  factors_ = static_cast<FactorId>(graph.FactorCount());
  variables_ = static_cast<VariableId>(graph.VariableCount());
  Order(&part);
  const std::vector<int> made = MakeCliques(part);
  for (const int clique : made) Eliminate(clique, &work);
  work.cliques = made.size();
  work.variables = part.variables.size();
  Solve(made);
  return work;
}

BayesTree::Part BayesTree::TakeApart(const std::vector<int>& marked, FactorId first_factor,
                                     VariableId first_variable) {
  const Graph& graph = evaluation_.TheGraph();
  Part part;
  // Old variables first, each in the order in which the graph has them: what is found does not
  // depend on the tree's past.
  for (const int id : marked) {
    Clique& clique = cliques_[static_cast<std::size_t>(id)];
    for (std::size_t i = 0; i < clique.eliminated; ++i)
      if (!is_held_[clique.variables[i]]) part.variables.push_back(clique.variables[i]);
    for (const FactorId factor : clique.factors) {
      clique_of_factor_[factor] = kNone;
      if (!is_withdrawn_[factor]) part.factors.push_back(factor);
    }
    for (const int child : clique.children)
      if (!cliques_[static_cast<std::size_t>(child)].is_marked) part.orphans.push_back(child);
  }
  for (const int id : marked) {
    cliques_[static_cast<std::size_t>(id)] = Clique();
    free_cliques_.push_back(id);
  }
  for (VariableId id = first_variable; id < graph.VariableCount(); ++id)
    if (!is_held_[id]) part.variables.push_back(id);
  for (FactorId id = first_factor; id < graph.FactorCount(); ++id)
    if (!is_withdrawn_[id]) part.factors.push_back(id);
  std::sort(part.variables.begin(), part.variables.end());
  std::sort(part.factors.begin(), part.factors.end());
  std::sort(part.orphans.begin(), part.orphans.end());

  // What the newest factors touch is what the next are likely to touch.
  std::vector<VariableId> recent;
  for (FactorId id = first_factor; id < graph.FactorCount(); ++id)
    for (const VariableId variable : graph.VariablesOf(id))
      if (!is_withdrawn_[id] && !is_held_[variable] && !is_changed_[variable]) {
        is_changed_[variable] = 1;
        recent.push_back(variable);
      }
  std::stable_partition(part.variables.begin(), part.variables.end(),
                        [&](VariableId id) { return !is_changed_[id]; });
  for (const VariableId id : recent) is_changed_[id] = 0;
  part.recent = recent.size();
  return part;
}

void BayesTree::HangIn(int number, const double* points, Part* part) {
  const GaussianTerm& term = terms_.at(number);
  const Graph& graph = evaluation_.TheGraph();
  const int id = NewClique();
  Clique& clique = cliques_[static_cast<std::size_t>(id)];
  for (const VariableId variable : term.variables)
    if (!is_held_[variable]) {
      clique.variables.push_back(variable);
      clique.rows += TangentSize(variable);
    }
  if (clique.variables.empty()) {
    free_cliques_.push_back(id);
    clique_of_term_[number] = kNone;
    return;
  }
  std::vector<double> jacobian(static_cast<std::size_t>(term.gaussian.rows * clique.rows)),
      residual(static_cast<std::size_t>(term.gaussian.rows));
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  double* next = jacobian.data();
  for (const VariableId variable : term.variables) {
    blocks.push_back(points + graph.Offset(variable));
    jacobians.push_back(is_held_[variable] ? nullptr : next);
    if (!is_held_[variable]) next += TangentSize(variable);
  }
  const std::vector<int> strides(term.variables.size(), clique.rows);
  term.gaussian.Evaluate(graph, term.variables, blocks.data(), residual.data(), jacobians.data(),
                         strides.data());
  Front::Square(jacobian.data(), residual.data(), term.gaussian.rows, clique.rows,
                &clique.remainder, &clique.rest);
  clique_of_term_[number] = id;
  part->orphans.push_back(id);
}

}  // namespace graticule
