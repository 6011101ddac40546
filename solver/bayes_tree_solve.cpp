// The numbers in the tree: fronts, steps, covariances.

#include <algorithm>
#include <cmath>

#include "graticule/solver/bayes_tree.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// What a variable moves, in its tangent, with a number that nothing determines: below this it is
// rounding.
constexpr double kMoves = 1e-6;

}  // namespace

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
  clique.held.clear();
  if (!front_.Eliminate()) {
    // Nothing determines some direction: held where it is, until something does.
    Assemble(clique);
    if (!front_.EliminateHolding(&clique.held))
      throw Error("the linear system is not finite", ErrorKind::kOther);
    VariableId last = Layout::kNone;
    for (const int column : clique.held) {
      const VariableId variable = VariableAt(clique, column);
      if (variable != last) work->loose.push_back(last = variable);
    }
  }
  const auto size =
      static_cast<std::size_t>(clique.rows) * static_cast<std::size_t>(clique.columns);
  clique.l.assign(front_.L(), front_.L() + size);
  clique.y.assign(front_.Y(), front_.Y() + clique.columns);
  front_.CopyRemainder(&clique.remainder, &clique.rest);
}

VariableId BayesTree::VariableAt(const Clique& clique, int row) const {
  std::size_t i = 0;
  while (row >= TangentSize(clique.variables[i])) row -= TangentSize(clique.variables[i++]);
  return clique.variables[i];
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
    // Those just made are children too, and so are terms.
    const bool is_followed =
        !clique.is_marked && clique.eliminated > 0 &&
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
    const int size = TangentSize(variable);
    std::copy_n(found, size, step_.data() + step_begin_[variable]);
    // Against what was followed, not against the update before: many small changes add up.
    double* followed = followed_step_.data() + step_begin_[variable];
    double change = 0;
    for (int k = 0; k < size; ++k) change = std::max(change, std::abs(found[k] - followed[k]));
    if (change > propagation_) std::copy_n(found, size, followed);
    found += size;
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
  std::map<VariableId, std::size_t> begin;  // in x
  std::size_t count = 0;
  for (const int i : path)
    for (const VariableId variable : cliques_[static_cast<std::size_t>(i)].variables)
      if (begin.emplace(variable, count).second)
        count += static_cast<std::size_t>(TangentSize(variable));
  std::vector<double> x, separator, solution;
  for (std::size_t c = 0; c < size; ++c) {
    x.assign(count, 0.0);
    x[begin[id] + c] = 1;
    std::vector<std::vector<double>> y;
    for (const int i : path) {  // L y = e
      const Clique& clique = cliques_[static_cast<std::size_t>(i)];
      std::vector<double> all;
      for (const VariableId variable : clique.variables)
        all.insert(all.end(), x.data() + begin[variable],
                   x.data() + begin[variable] + TangentSize(variable));
      for (int j = 0; j < clique.columns; ++j) {
        const double* column = clique.l.data() + j * clique.rows;
        const double value = all[static_cast<std::size_t>(j)] /= column[j];
        for (int r = j + 1; r < clique.rows; ++r)
          all[static_cast<std::size_t>(r)] -= column[r] * value;
      }
      for (const int j : clique.held) {
        if (std::abs(all[static_cast<std::size_t>(j)]) > kMoves) {
          const Graph& graph = evaluation_.TheGraph();
          throw Error(graph.KeyOf(id).ToString() + " has no covariance: nothing determines " +
                          graph.KeyOf(VariableAt(clique, j)).ToString() +
                          (VariableAt(clique, j) == id ? "" : ", which it moves with"),
                      ErrorKind::kIllPosed);
        }
        all[static_cast<std::size_t>(j)] = 0;
      }
      const double* next = all.data();
      for (const VariableId variable : clique.variables) {
        std::copy_n(next, TangentSize(variable), x.data() + begin[variable]);
        next += TangentSize(variable);
      }
      y.emplace_back(all.begin(), all.begin() + clique.columns);
    }
    for (std::size_t p = path.size(); p-- > 0;) {  // L' x = y
      const Clique& clique = cliques_[static_cast<std::size_t>(path[p])];
      separator.clear();
      for (std::size_t i = clique.eliminated; i < clique.variables.size(); ++i)
        for (int k = 0; k < TangentSize(clique.variables[i]); ++k)
          separator.push_back(x[begin[clique.variables[i]] + static_cast<std::size_t>(k)]);
      solution.resize(static_cast<std::size_t>(clique.columns));
      Front::BackSubstitute(clique.l.data(), y[p].data(), clique.rows, clique.columns,
                            separator.data(), solution.data());
      const double* next = solution.data();
      for (std::size_t i = 0; i < clique.eliminated; ++i) {
        std::copy_n(next, TangentSize(clique.variables[i]), x.data() + begin[clique.variables[i]]);
        next += TangentSize(clique.variables[i]);
      }
    }
    for (std::size_t r = 0; r < size; ++r) covariance[r * size + c] = x[begin[id] + r];
  }
  for (std::size_t r = 0; r < size; ++r)
    for (std::size_t c = 0; c < r; ++c)
      covariance[r * size + c] = covariance[c * size + r] =
          (covariance[r * size + c] + covariance[c * size + r]) / 2;
  return covariance;
}

}  // namespace graticule
