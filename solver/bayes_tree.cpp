#include "graticule/solver/bayes_tree.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Added to the diagonal, relative to its largest, where a front is not positive definite.
constexpr double kWeakly = 1e-8;

}  // namespace

void BayesTree::Clear() {
  factors_ = 0;
  variables_ = 0;
  is_held_.clear();
  step_begin_.assign(1, 0);
  step_.clear();
  clique_of_.clear();
  clique_of_factor_.clear();
  factors_of_.clear();
  linear_begin_.assign(1, 0);
  linear_.clear();
  cliques_.clear();
  free_cliques_.clear();
  changed_.clear();
  is_changed_.clear();
  place_.clear();
}

void BayesTree::ResetStep(VariableId id) {
  std::fill_n(step_.begin() + step_begin_[id], TangentSize(id), 0.0);
}

// Makes room for what the graph has that is not here yet.
void BayesTree::Grow(const std::vector<char>& held) {
  const Graph& graph = evaluation_.TheGraph();
  for (VariableId id = variables_; id < graph.VariableCount(); ++id) {
    step_begin_.push_back(step_begin_.back() + graph.TypeOf(id).TangentSize());
    is_held_.push_back(graph.IsFixed(id) || held[id] || graph.TypeOf(id).TangentSize() == 0);
  }
  step_.resize(static_cast<std::size_t>(step_begin_.back()), 0.0);
  clique_of_.resize(graph.VariableCount(), kNone);
  factors_of_.resize(graph.VariableCount());
  is_changed_.resize(graph.VariableCount(), 0);
  place_.resize(graph.VariableCount(), kNone);
  for (FactorId id = factors_; id < graph.FactorCount(); ++id) {
    std::size_t columns = 1;
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

BayesTree::Work BayesTree::Update(const double* points, const std::vector<VariableId>& moved,
                                  const std::vector<char>& held) {
  const Graph& graph = evaluation_.TheGraph();
  for (const VariableId id : changed_) is_changed_[id] = 0;
  changed_.clear();
  Grow(held);
  Work work;
  std::vector<int> marked;
  std::vector<FactorId> stale;
  for (FactorId id = factors_; id < graph.FactorCount(); ++id) {
    stale.push_back(id);
    for (const VariableId variable : graph.VariablesOf(id)) Mark(variable, &marked);
  }
  for (const VariableId variable : moved)
    for (const FactorId id : factors_of_[variable])
      if (id < factors_) {
        stale.push_back(id);
        MarkFrom(clique_of_factor_[id], &marked);
      }
  std::sort(stale.begin(), stale.end());
  stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
  for (const FactorId id : stale) Linearise(id, points);
  work.factors = stale.size();

  Part part = TakeApart(marked, factors_, variables_);
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
    part.variables.insert(
        part.variables.end(), clique.variables.begin(),
        clique.variables.begin() + static_cast<std::ptrdiff_t>(clique.eliminated));
    part.factors.insert(part.factors.end(), clique.factors.begin(), clique.factors.end());
    for (const int child : clique.children)
      if (!cliques_[static_cast<std::size_t>(child)].is_marked) part.orphans.push_back(child);
  }
  for (const int id : marked) {
    cliques_[static_cast<std::size_t>(id)] = Clique();
    free_cliques_.push_back(id);
  }
  for (VariableId id = first_variable; id < graph.VariableCount(); ++id)
    if (!is_held_[id]) part.variables.push_back(id);
  for (FactorId id = first_factor; id < graph.FactorCount(); ++id) part.factors.push_back(id);
  std::sort(part.variables.begin(), part.variables.end());
  std::sort(part.factors.begin(), part.factors.end());
  std::sort(part.orphans.begin(), part.orphans.end());

  // What the newest factors touch is what the next are likely to touch.
  std::vector<VariableId> recent;
  for (FactorId id = first_factor; id < graph.FactorCount(); ++id)
    for (const VariableId variable : graph.VariablesOf(id))
      if (!is_held_[variable] && !is_changed_[variable]) {
        is_changed_[variable] = 1;
        recent.push_back(variable);
      }
  std::stable_partition(part.variables.begin(), part.variables.end(),
                        [&](VariableId id) { return !is_changed_[id]; });
  for (const VariableId id : recent) is_changed_[id] = 0;
  part.recent = recent.size();
  return part;
}

// Constrained minimum degree: a row a variable, a column a factor or an orphan's others.
void BayesTree::Order(Part* part) {
  const std::size_t count = part->variables.size();
  if (count <= 2) return;
  for (std::size_t i = 0; i < count; ++i) place_[part->variables[i]] = static_cast<int>(i);
  std::vector<int> begins{0}, rows;
  const auto add = [&](VariableId variable) {
    if (place_[variable] != kNone) rows.push_back(place_[variable]);
  };
  for (const FactorId id : part->factors) {
    for (const VariableId variable : evaluation_.TheGraph().VariablesOf(id))
      if (!is_held_[variable]) add(variable);
    begins.push_back(static_cast<int>(rows.size()));
  }
  for (const int orphan : part->orphans) {
    const Clique& clique = cliques_[static_cast<std::size_t>(orphan)];
    for (std::size_t i = clique.eliminated; i < clique.variables.size(); ++i)
      add(clique.variables[i]);
    begins.push_back(static_cast<int>(rows.size()));
  }
  cholmod_sparse view{};
  view.nrow = count;
  view.ncol = begins.size() - 1;
  view.nzmax = rows.size();
  view.p = begins.data();
  view.i = rows.data();
  view.stype = 0;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 0;
  view.packed = 1;
  // Constrained orderings take empty groups badly: all one group where all is recent.
  std::vector<int> group(count, 0), order(count);
  if (part->recent < count)
    std::fill(group.end() - static_cast<std::ptrdiff_t>(part->recent), group.end(), 1);
  // cholmod_camd (3.0.14) keeps pointers into a workspace that cholmod_aat, inside it, lets go
  // where there are more columns than it reckoned with: so it is made large enough beforehand.
  if (!cholmod_allocate_work(count, 8 * count + view.ncol, 0, cholmod_()))
    throw Error("CHOLMOD ran out of memory", ErrorKind::kOther);
  if (cholmod_camd(&view, nullptr, 0, group.data(), order.data(), cholmod_())) {
    std::vector<VariableId> ordered;
    ordered.reserve(count);
    for (const int i : order) ordered.push_back(part->variables[static_cast<std::size_t>(i)]);
    for (const VariableId id : part->variables) place_[id] = kNone;
    part->variables = std::move(ordered);
    return;
  }
  for (const VariableId id : part->variables) place_[id] = kNone;
}

int BayesTree::NewClique() {
  if (free_cliques_.empty()) {
    cliques_.emplace_back();
    return static_cast<int>(cliques_.size()) - 1;
  }
  const int id = free_cliques_.back();
  free_cliques_.pop_back();
  return id;
}

// Symbolic elimination.  Returns the cliques, children before parents.
std::vector<int> BayesTree::MakeCliques(const Part& part) {
  const std::size_t count = part.variables.size();
  for (std::size_t i = 0; i < count; ++i) place_[part.variables[i]] = static_cast<int>(i);
  // By place: who is eliminated there, and what hangs on it.
  std::vector<std::vector<FactorId>> factors(count);
  std::vector<std::vector<int>> orphans(count), children(count), others(count);
  const Graph& graph = evaluation_.TheGraph();
  const auto first_of = [&](const VariableId* begin, const VariableId* end) {
    int first = static_cast<int>(count);
    for (const VariableId* id = begin; id != end; ++id)
      if (!is_held_[*id]) first = std::min(first, place_[*id]);
    return static_cast<std::size_t>(first);
  };
  for (const FactorId id : part.factors) {
    const Span<const VariableId> variables = graph.VariablesOf(id);
    const std::size_t first = first_of(variables.begin(), variables.end());
    if (first < count) factors[first].push_back(id);
  }
  for (const int id : part.orphans) {
    const std::vector<VariableId>& variables = cliques_[static_cast<std::size_t>(id)].variables;
    const std::size_t eliminated = cliques_[static_cast<std::size_t>(id)].eliminated;
    orphans[first_of(variables.data() + eliminated, variables.data() + variables.size())].push_back(
        id);
  }

  std::vector<int> seen(count, kNone), clique_at(count, kNone);
  for (std::size_t j = 0; j < count; ++j) {
    const int place = static_cast<int>(j);
    seen[j] = place;
    const auto see = [&](int other) {
      if (other == place || seen[static_cast<std::size_t>(other)] == place) return;
      seen[static_cast<std::size_t>(other)] = place;
      others[j].push_back(other);
    };
    for (const FactorId id : factors[j])
      for (const VariableId variable : graph.VariablesOf(id))
        if (!is_held_[variable]) see(place_[variable]);
    for (const int id : orphans[j]) {
      const Clique& orphan = cliques_[static_cast<std::size_t>(id)];
      for (std::size_t i = orphan.eliminated; i < orphan.variables.size(); ++i)
        see(place_[orphan.variables[i]]);
    }
    for (const int child : children[j])
      for (const int other : others[static_cast<std::size_t>(child)]) see(other);
    std::sort(others[j].begin(), others[j].end());
    // A child that tells of everything that this one has takes this one into its clique.
    int home = kNone;
    for (const int child : children[j])
      if (others[static_cast<std::size_t>(child)].size() == others[j].size() + 1)
        home = clique_at[static_cast<std::size_t>(child)];
    if (home == kNone) home = NewClique();
    clique_at[j] = home;
    Clique& clique = cliques_[static_cast<std::size_t>(home)];
    clique.variables.push_back(part.variables[j]);
    clique.factors.insert(clique.factors.end(), factors[j].begin(), factors[j].end());
    clique.children.insert(clique.children.end(), orphans[j].begin(), orphans[j].end());
    for (const int child : children[j])
      if (clique_at[static_cast<std::size_t>(child)] != home)
        clique.children.push_back(clique_at[static_cast<std::size_t>(child)]);
    if (!others[j].empty()) children[static_cast<std::size_t>(others[j].front())].push_back(place);
  }

  // Each clique once, where its last variable is eliminated.
  std::vector<int> made;
  for (std::size_t j = 0; j < count; ++j) {
    const int id = clique_at[j];
    Clique& clique = cliques_[static_cast<std::size_t>(id)];
    if (clique.variables.back() != part.variables[j]) continue;
    made.push_back(id);
    clique.eliminated = clique.variables.size();
    for (const VariableId variable : clique.variables) {
      clique_of_[variable] = id;
      clique.columns += TangentSize(variable);
    }
    clique.rows = clique.columns;
    for (const int other : others[j]) {
      clique.variables.push_back(part.variables[static_cast<std::size_t>(other)]);
      clique.rows += TangentSize(clique.variables.back());
    }
    for (const FactorId factor : clique.factors) clique_of_factor_[factor] = id;
    for (const int child : clique.children) cliques_[static_cast<std::size_t>(child)].parent = id;
  }
  for (const VariableId id : part.variables) place_[id] = kNone;
  return made;
}

void BayesTree::Assemble(const Clique& clique) {
  const Graph& graph = evaluation_.TheGraph();
  front_.Reset(clique.rows, clique.columns);
  const int n = clique.rows;
  int row = 0;
  for (const VariableId id : clique.variables) {
    place_[id] = row;
    row += TangentSize(id);
  }
  double* matrix = front_.Matrix();
  double* rhs = front_.Rhs();
  for (const FactorId id : clique.factors) {
    const int rows = graph.ResidualSize(id);
    const double* residual = linear_.data() + linear_begin_[id];
    const double* b = residual + rows;
    const Span<const VariableId> variables = graph.VariablesOf(id);
    for (std::size_t j = 0; j < variables.size(); ++j) {
      const int b_size = TangentSize(variables[j]);
      if (!is_held_[variables[j]]) {
        const int b_place = place_[variables[j]];
        const double* a = residual + rows;
        for (std::size_t i = 0; i <= j; ++i) {
          const int a_size = TangentSize(variables[i]);
          if (!is_held_[variables[i]]) {
            const int a_place = place_[variables[i]];
            // Below the diagonal: the later of the two has the rows.
            const bool b_has_rows = b_place >= a_place;
            const int first = b_has_rows ? b_place : a_place,
                      column = b_has_rows ? a_place : b_place;
            const int height = b_has_rows ? b_size : a_size, width = b_has_rows ? a_size : b_size;
            const double* by_row = b_has_rows ? b : a;
            const double* by_column = b_has_rows ? a : b;
            for (int c = 0; c < width; ++c) {
              double* to = matrix + (column + c) * n + first;
              for (int k = 0; k < rows; ++k) {
                const double factor = by_column[k * width + c];
                for (int r = 0; r < height; ++r) to[r] += factor * by_row[k * height + r];
              }
            }
          }
          a += rows * a_size;
        }
        for (int k = 0; k < rows; ++k)
          for (int c = 0; c < b_size; ++c) rhs[b_place + c] -= residual[k] * b[k * b_size + c];
      }
      b += rows * b_size;
    }
  }
  for (const int id : clique.children) {
    const Clique& child = cliques_[static_cast<std::size_t>(id)];
    rows_.clear();
    for (std::size_t i = child.eliminated; i < child.variables.size(); ++i)
      for (int k = 0; k < TangentSize(child.variables[i]); ++k)
        rows_.push_back(place_[child.variables[i]] + k);
    const std::size_t s = rows_.size();
    for (std::size_t c = 0; c < s; ++c) {
      const double* from = child.remainder.data() + c * s;
      const int column = rows_[c];
      for (std::size_t r = c; r < s; ++r) {
        const int other = rows_[r];
        matrix[other >= column ? column * n + other : other * n + column] += from[r];
      }
      rhs[column] += child.rest[c];
    }
  }
  for (const VariableId id : clique.variables) place_[id] = kNone;
}

void BayesTree::Eliminate(int id, Work* work) {
  Clique& clique = cliques_[static_cast<std::size_t>(id)];
  Assemble(clique);
  if (!front_.Eliminate()) {
    // Nothing determines some direction: held where it is, weakly, until something does.
    for (double weakly = kWeakly;; weakly *= 100) {
      Assemble(clique);
      double* matrix = front_.Matrix();
      double largest = 0;
      for (int i = 0; i < clique.rows; ++i)
        largest = std::max(largest, matrix[i * clique.rows + i]);
      for (int i = 0; i < clique.columns; ++i)
        matrix[i * clique.rows + i] += weakly * (largest > 0 ? largest : 1);
      if (front_.Eliminate()) break;
      if (!(weakly < 1)) throw Error("the linear system is not finite", ErrorKind::kOther);
    }
    work->loose.insert(work->loose.end(), clique.variables.begin(),
                       clique.variables.begin() + static_cast<std::ptrdiff_t>(clique.eliminated));
  }
  const auto size =
      static_cast<std::size_t>(clique.rows) * static_cast<std::size_t>(clique.columns);
  clique.l.assign(front_.L(), front_.L() + size);
  clique.y.assign(front_.Y(), front_.Y() + clique.columns);
  front_.CopyRemainder(&clique.remainder, &clique.rest);
}

// From the roots down.
void BayesTree::Solve(const std::vector<int>& made) {
  std::vector<int> pending;
  for (auto id = made.rbegin(); id != made.rend(); ++id) SolveFor(*id, true);
  // What hangs on what was made.
  for (const int id : made)
    for (const int child : cliques_[static_cast<std::size_t>(id)].children)
      pending.push_back(child);
  while (!pending.empty()) {
    const int id = pending.back();
    pending.pop_back();
    const Clique& clique = cliques_[static_cast<std::size_t>(id)];
    // Those just made are children too.
    const bool is_followed =
        !clique.is_marked &&
        std::any_of(clique.variables.begin() + static_cast<std::ptrdiff_t>(clique.eliminated),
                    clique.variables.end(),
                    [&](VariableId variable) { return is_changed_[variable] == 1; });
    if (!is_followed) continue;
    SolveFor(id, false);
    pending.insert(pending.end(), clique.children.begin(), clique.children.end());
  }
  for (const int id : made) cliques_[static_cast<std::size_t>(id)].is_marked = false;
}

void BayesTree::SolveFor(int id, bool is_made) {
  Clique& clique = cliques_[static_cast<std::size_t>(id)];
  clique.is_marked = is_made;
  separator_.clear();
  for (std::size_t i = clique.eliminated; i < clique.variables.size(); ++i)
    for (int k = 0; k < TangentSize(clique.variables[i]); ++k)
      separator_.push_back(StepOf(clique.variables[i])[k]);
  solution_.resize(static_cast<std::size_t>(clique.columns));
  Front::BackSubstitute(clique.l.data(), clique.y.data(), clique.rows, clique.columns,
                        separator_.data(), solution_.data());
  const double* found = solution_.data();
  for (std::size_t i = 0; i < clique.eliminated; ++i) {
    const VariableId variable = clique.variables[i];
    double* step = step_.data() + step_begin_[variable];
    double change = 0;
    for (int k = 0; k < TangentSize(variable); ++k) {
      change = std::max(change, std::abs(found[k] - step[k]));
      step[k] = found[k];
    }
    found += TangentSize(variable);
    if (!is_changed_[variable]) changed_.push_back(variable);
    // 1: enough to be followed; 2: changed, that is all.
    is_changed_[variable] = change > propagation_ ? 1 : 2;
  }
}

std::vector<double> BayesTree::Covariance(VariableId id) const {
  const auto size = static_cast<std::size_t>(TangentSize(id));
  std::vector<double> covariance(size * size, 0.0);
  if (is_held_[id]) return covariance;
  // Two solves with the whole factor a column, along the path to the root: what is eliminated
  // elsewhere adds nothing to them.
  std::vector<int> path;
  for (int clique = clique_of_[id]; clique != kNone;
       clique = cliques_[static_cast<std::size_t>(clique)].parent)
    path.push_back(clique);
  std::vector<double> x(step_.size(), 0.0), separator, solution;
  for (std::size_t c = 0; c < size; ++c) {
    for (const int i : path)
      for (const VariableId variable : cliques_[static_cast<std::size_t>(i)].variables)
        std::fill_n(x.begin() + step_begin_[variable], TangentSize(variable), 0.0);
    x[static_cast<std::size_t>(step_begin_[id]) + c] = 1;
    std::vector<std::vector<double>> y;
    for (const int i : path) {  // L y = e
      const Clique& clique = cliques_[static_cast<std::size_t>(i)];
      std::vector<double> all;
      for (const VariableId variable : clique.variables)
        for (int k = 0; k < TangentSize(variable); ++k)
          all.push_back(x[static_cast<std::size_t>(step_begin_[variable] + k)]);
      for (int j = 0; j < clique.columns; ++j) {
        const double* column = clique.l.data() + j * clique.rows;
        const double value = all[static_cast<std::size_t>(j)] /= column[j];
        for (int r = j + 1; r < clique.rows; ++r)
          all[static_cast<std::size_t>(r)] -= column[r] * value;
      }
      const double* next = all.data();
      for (const VariableId variable : clique.variables) {
        std::copy_n(next, TangentSize(variable), x.begin() + step_begin_[variable]);
        next += TangentSize(variable);
      }
      y.emplace_back(all.begin(), all.begin() + clique.columns);
    }
    for (std::size_t p = path.size(); p-- > 0;) {  // L' x = y
      const Clique& clique = cliques_[static_cast<std::size_t>(path[p])];
      separator.clear();
      for (std::size_t i = clique.eliminated; i < clique.variables.size(); ++i)
        for (int k = 0; k < TangentSize(clique.variables[i]); ++k)
          separator.push_back(x[static_cast<std::size_t>(step_begin_[clique.variables[i]] + k)]);
      solution.resize(static_cast<std::size_t>(clique.columns));
      Front::BackSubstitute(clique.l.data(), y[p].data(), clique.rows, clique.columns,
                            separator.data(), solution.data());
      const double* next = solution.data();
      for (std::size_t i = 0; i < clique.eliminated; ++i) {
        std::copy_n(next, TangentSize(clique.variables[i]),
                    x.begin() + step_begin_[clique.variables[i]]);
        next += TangentSize(clique.variables[i]);
      }
    }
    for (std::size_t r = 0; r < size; ++r)
      covariance[r * size + c] = x[static_cast<std::size_t>(step_begin_[id]) + r];
  }
  for (std::size_t r = 0; r < size; ++r)
    for (std::size_t c = 0; c < r; ++c)
      covariance[r * size + c] = covariance[c * size + r] =
          (covariance[r * size + c] + covariance[c * size + r]) / 2;
  return covariance;
}

}  // namespace graticule
