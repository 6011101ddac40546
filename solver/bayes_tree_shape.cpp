// Which variables a part of the tree eliminates together, and in which order.

#include <algorithm>

#include "graticule/solver/bayes_tree.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

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

}  // namespace graticule
