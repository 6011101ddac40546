#pragma once

#include <cstdint>
#include <vector>

#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/front.hpp"
#include "graticule/solver/linearise.hpp"

namespace graticule {

/// A graph's linear least squares problem, factorised so that it can grow: the Bayes tree of
/// Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert (iSAM2, IJRR 2012), with Cholesky fronts that
/// keep what they pass on to their parents.
///
/// What is new, or is linearised anew, touches the cliques of its variables and their ancestors up
/// to the root: these alone are ordered and eliminated again.  The solution is then followed down
/// from the root only as far as it changes.
class BayesTree {
 public:
  /// The evaluation, and its graph, may grow between updates.
  explicit BayesTree(const Evaluation& evaluation) : evaluation_(evaluation) {}

  /// What an update did.
  struct Work {
    std::size_t cliques = 0;        ///< eliminated
    std::size_t variables = 0;      ///< of these
    std::size_t factors = 0;        ///< linearised
    std::vector<VariableId> loose;  ///< that nothing determines: held where they are, weakly
  };

  /// Takes in what the graph has beyond the last update, linearises factors of `moved` anew, and
  /// solves.  `points`, laid out as the graph's values, are what steps start from.  A fixed
  /// variable, and those in `held`, are constants; they must be so from their first update on.
  /// Throws Error (kOther) where a factor cannot be evaluated; the tree is then to be cleared.
  Work Update(const double* points, const std::vector<VariableId>& moved,
              const std::vector<char>& held);

  /// Forgets everything: the next update begins from nothing.
  void Clear();

  /// The step of a variable, in its tangent: valid until the next update.
  const double* StepOf(VariableId id) const { return step_.data() + step_begin_[id]; }
  /// Variables whose step changed in the last update.
  const std::vector<VariableId>& Changed() const { return changed_; }
  bool IsHeld(VariableId id) const { return is_held_[id]; }
  /// Sets a step to zero: its variable's point has moved along it.
  void ResetStep(VariableId id);
  /// Steps that change by less, in any component, are not followed further down.
  void SetPropagation(double threshold) { propagation_ = threshold; }

  /// The marginal covariance of a variable in its tangent, row by row; zero where it is held.
  std::vector<double> Covariance(VariableId id) const;

 private:
  static constexpr int kNone = -1;

  struct Clique {
    std::vector<VariableId> variables;  // the eliminated, then the others, in order of elimination
    std::size_t eliminated = 0;         // how many of them
    int rows = 0, columns = 0;          // numbers of all, of the eliminated
    int parent = kNone;
    std::vector<int> children;
    std::vector<FactorId> factors;
    std::vector<double> l, y;             // as Front has them
    std::vector<double> remainder, rest;  // what the parent is told
    bool is_marked = false;
  };

  // A part of the tree that is taken apart, and what it is put together from.
  struct Part {
    std::vector<VariableId> variables;
    std::vector<FactorId> factors;
    std::vector<int> orphans;
    std::size_t recent = 0;  // of the variables, the last so many are to be eliminated last
  };

  int TangentSize(VariableId id) const { return step_begin_[id + 1] - step_begin_[id]; }
  void Grow(const std::vector<char>& held);
  void Mark(VariableId variable, std::vector<int>* marked);
  void MarkFrom(int clique, std::vector<int>* marked);
  Part TakeApart(const std::vector<int>& marked, FactorId first_new, VariableId first_variable);
  void Order(Part* part);
  std::vector<int> MakeCliques(const Part& part);
  void Linearise(FactorId id, const double* points);
  void Eliminate(int clique, Work* work);
  void Assemble(const Clique& clique);
  void Solve(const std::vector<int>& made);
  void SolveFor(int clique, bool is_made);
  int NewClique();

  const Evaluation& evaluation_;
  FactorId factors_ = 0;      // taken in
  VariableId variables_ = 0;  // taken in
  std::vector<char> is_held_;
  std::vector<int> step_begin_{0};  // by variable
  std::vector<double> step_;
  std::vector<int> clique_of_;                     // by variable, where it is eliminated
  std::vector<int> clique_of_factor_;              // where it is added
  std::vector<std::vector<FactorId>> factors_of_;  // by variable
  std::vector<std::size_t> linear_begin_{0};       // by factor
  std::vector<double> linear_;                     // residual and packed Jacobians, weighted
  std::vector<Clique> cliques_;
  std::vector<int> free_cliques_;

  double propagation_ = 1e-3;
  std::vector<VariableId> changed_;
  std::vector<char> is_changed_;  // by variable
  Front front_;
  Cholmod cholmod_;
  // Workspace: by variable, and as lists.
  std::vector<int> place_;
  std::vector<std::uint8_t> is_new_;
  std::vector<int> rows_;
  std::vector<double> separator_, solution_;
};

}  // namespace graticule
