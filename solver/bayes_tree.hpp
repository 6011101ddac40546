#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "graticule/solver/evaluation.hpp"
#include "graticule/solver/front.hpp"
#include "graticule/solver/linearise.hpp"
#include "graticule/solver/marginalise.hpp"

namespace graticule {

/// A graph's linear least squares problem, factorised so that it can grow: the Bayes tree of
/// Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert (iSAM2, IJRR 2012), with Cholesky fronts that
/// keep what they pass on to their parents.
///
/// What is new, or is linearised anew, touches the cliques of its variables and their ancestors up
/// to the root: these alone are ordered and eliminated again.  The solution is then followed down
/// from the root only as far as it changes.
///
/// A Gaussian term hangs in the tree like a clique that eliminates nothing and tells its parent the
/// term's equations: its squares are added up once, not at every elimination.
class BayesTree {
 public:
  /// The evaluation, its graph and the terms may change between updates.
  BayesTree(const Evaluation& evaluation, const GaussianTerms& terms)
      : evaluation_(evaluation), terms_(terms) {}

  /// What is otherwise than at the last update, beyond what the graph and the terms have more.
  struct Changes {
    std::vector<VariableId> moved;    ///< their factors are linearised anew
    std::vector<VariableId> held;     ///< are constants from now on
    std::vector<FactorId> withdrawn;  ///< count no more
  };

  /// What an update did.
  struct Work {
    std::size_t cliques = 0;        ///< eliminated
    std::size_t variables = 0;      ///< of these
    std::size_t factors = 0;        ///< linearised
    std::vector<VariableId> loose;  ///< that nothing determines along what they are held
  };

  /// Takes in what the graph has beyond the last update, terms that came and went, and `changes`;
  /// and solves.  `points`, laid out as the graph's values, are what steps start from.  A fixed
  /// variable, and those in `held`, are constants; factors in `withdrawn` do not count.  Throws
  /// Error (kOther) where a factor cannot be evaluated; the tree is then to be cleared.
  Work Update(const double* points, const Changes& changes, const std::vector<char>& held,
              const std::vector<char>& withdrawn);

  /// Forgets everything: the next update begins from nothing.
  void Clear();

  /// The step of a variable, in its tangent: valid until the next update.
  const double* StepOf(VariableId id) const { return step_.data() + step_begin_[id]; }
  /// Variables whose step changed in the last update.
  const std::vector<VariableId>& Changed() const { return changed_; }
  bool IsHeld(VariableId id) const { return is_held_[id]; }
  const std::vector<char>& Held() const { return is_held_; }
  /// The factors of a variable that have been taken in and count.
  const std::vector<FactorId>& FactorsOf(VariableId id) const { return factors_of_[id]; }
  /// Sets a step to zero: its variable's point has moved along it.
  void ResetStep(VariableId id);
  /// Steps that have changed by less in every component, since they last were, are not followed
  /// further down.
  void SetPropagation(double threshold) { propagation_ = threshold; }

  /// The marginal covariance of a variable in its tangent, row by row; zero where it is held.
  /// Throws Error (kIllPosed) where it moves with what nothing determines.
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
    std::vector<int> held;                // columns that nothing determines
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

  // What an update touches.
  struct Touched {
    std::vector<int> cliques;
    std::vector<FactorId> stale;  // to be linearised
    std::vector<int> terms;       // to be hung in
  };

  int TangentSize(VariableId id) const { return step_begin_[id + 1] - step_begin_[id]; }
  void Grow(const std::vector<char>& held, const std::vector<char>& withdrawn);
  void Mark(VariableId variable, std::vector<int>* marked);
  void MarkFrom(int clique, std::vector<int>* marked);
  void Withdraw(FactorId id, Touched* touched);
  void Hold(VariableId id, Touched* touched);
  void FollowTerms(const Changes& changes, Touched* touched);
  Touched Follow(const Changes& changes);
  Part TakeApart(const std::vector<int>& marked, FactorId first_new, VariableId first_variable);
  void HangIn(int term, const double* points, Part* part);
  void Order(Part* part);
  std::vector<int> MakeCliques(const Part& part);
  void Linearise(FactorId id, const double* points);
  void Eliminate(int clique, Work* work);
  VariableId VariableAt(const Clique& clique, int row) const;
  void Assemble(const Clique& clique);
  void Solve(const std::vector<int>& made);
  void SolveFor(int clique, bool is_made);
  int NewClique();

  const Evaluation& evaluation_;
  const GaussianTerms& terms_;
  FactorId factors_ = 0;      // taken in
  VariableId variables_ = 0;  // taken in
  std::vector<char> is_held_;
  std::vector<char> is_withdrawn_;  // by factor
  std::vector<int> step_begin_{0};  // by variable
  std::vector<double> step_;
  std::vector<double> followed_step_;  // the step when cliques further down were last told of it
  std::vector<int> clique_of_;         // by variable, where it is eliminated
  std::vector<int> clique_of_factor_;  // where it is added
  std::vector<std::vector<FactorId>> factors_of_;  // by variable
  std::vector<std::size_t> linear_begin_{0};       // by factor
  std::vector<double> linear_;                     // residual and packed Jacobians, weighted
  std::vector<Clique> cliques_;
  std::vector<int> free_cliques_;
  std::map<int, int> clique_of_term_;  // kNone where all its variables are constants

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
