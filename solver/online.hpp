#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// Thresholds are 0 or more, `relinearise_every` 1 or more.
struct OnlineOptions {
  /// A variable is linearised anew where a component of its step since then (m, rad) is larger.
  double relinearise_above = 0.05;
  /// ... which is looked for at every so many updates.
  int relinearise_every = 10;
  /// Changes smaller than this, in every component, are not followed to variables further off;
  /// they add up until they are.
  double propagate_above = 1e-4;
  /// Fixed lag: of each family named here so many stay, those added last; the others are
  /// marginalised (as by Online::Marginalise) at the next update that brings no factor of theirs.
  /// `{{"pose", 100}}` keeps 100 poses, and all landmarks.  A number below 1 counts as 1.
  std::map<std::string, std::size_t> lag;
  /// How UpdateExactly solves.
  SolveOptions solve;
};

/// What an update did.
struct OnlineReport {
  std::size_t new_variables = 0, new_factors = 0;
  std::size_t marginalised = 0;  ///< variables that left by OnlineOptions::lag
  std::size_t eliminated = 0;    ///< variables eliminated anew
  std::size_t relinearised = 0;  ///< variables linearised anew
  std::size_t changed = 0;       ///< variables whose value was computed anew
  /// Of what was eliminated anew: variables that nothing determines in some direction.  They are
  /// held along it where they are.  Of several that are loose together, as of a robot not yet met,
  /// the one that is held stands for all.
  std::vector<Key> loose;
  double objective = 0;  ///< of UpdateExactly: 0.5 sum rho(r' W r)
  /// Of UpdateExactly: how Solve ended, and why.  Update takes one step, and does not claim more.
  Termination termination = Termination::kNoConvergence;
  std::string message;
  double seconds = 0;  ///< wall time
};

/// A graph that grows and is solved as it grows: what a SLAM stack embeds.  Incremental smoothing
/// after Kaess et al. (iSAM2, IJRR 2012); a step costs what it changes.
///
/// One thread adds and updates.  Any thread may ask for Latest() at any time: it gets the values of
/// the last update that is complete, and waits for nothing but the copy of a pointer.
///
/// Where no factor is absolute and no variable fixed, the variable added first is held.
class Online {
 public:
  /// Throws Error (kUsage): an option out of its range.
  explicit Online(Registry types, OnlineOptions options = {});
  ~Online();
  Online(const Online&) = delete;
  Online& operator=(const Online&) = delete;

  /// As Graph::Add.  The value should be a guess made from Latest(): from there the first step is
  /// small.  Ids count up from 0 and stay what they are, whatever leaves or is removed.
  VariableId Add(const Key& key, std::string_view type, const std::vector<double>& value,
                 bool fixed = false);
  /// As Graph::Add.  Throws Error (kInput) also where a variable of the factor was marginalised.
  FactorId Add(const Factor& factor);

  /// Takes in what was added since the last update, and publishes new values.
  /// Throws Error, kOther where a factor cannot be evaluated, kInput where one refuses by now what
  /// it took when it was added: what was published stays, and the next update begins from there
  /// (without that factor, once it is removed).
  OnlineReport Update();
  /// The same, and then on to the minimum of Problem(), as Solve finds it from here.  Throws Error
  /// as Update and Solve do, and kOther where Solve fails.  Where Solve ends before the minimum,
  /// the report's termination says so, and its values are published.
  OnlineReport UpdateExactly();

  /// Holds variables where they are from now on: they cost nothing any more, and neither do factors
  /// that touch none but such (thesis ch. 6, "freeze parts of the map").  Throws Error (kInput)
  /// where a key is unknown, or was marginalised; then none is frozen.
  void Freeze(const std::vector<Key>& keys);

  /// Takes variables out of the problem.  What their factors said of the others stays, as Gaussians
  /// over their neighbours: linearised once, where the variables are now, losses at their weights
  /// there.  Their last values stay in Latest(); no factor can reach them any more.  Where nothing
  /// absolute has said where the graph is, the variable added first is fixed from now on.
  ///
  /// Throws Error; then nothing has left.  kInput: a key unknown, marginalised already, or with
  /// something new (itself, a factor of its) that no update has taken in; or the last update
  /// failed.  kOther: a factor cannot be evaluated.
  void Marginalise(const std::vector<Key>& keys);

  /// Whether a variable was marginalised.  Throws Error (kInput): unknown key.
  bool HasLeft(const Key& key) const;

  /// Takes a factor back, from the next update on: a loop closure that proved false.  Throws Error
  /// (kInput) where there is no such factor, it was removed already, or one of its variables was
  /// marginalised, so that what it said can no longer be told apart.
  void Remove(FactorId id);

  /// The values of the last update, those of marginalised variables as they left.  Thread-safe.
  /// Before the first update: null.
  std::shared_ptr<const Values> Latest() const;

  /// The marginal covariance of a variable, in its tangent, row by row, as of the last update and
  /// where factors were last linearised.  Zero where it is held.  Throws Error (kInput): unknown
  /// key, one added since the last update, or one that was marginalised.  kIllPosed: the variable
  /// moves with something that nothing determines (OnlineReport::loose).
  std::vector<double> Covariance(const Key& key) const;

  /// The problem as it stands, to be written or solved by others, at the values of the last update:
  /// without what was removed, and with `gaussian/1` factors (source "marginal") in place of what
  /// was marginalised.  Positions are not those of Add once something has gone.
  Graph Problem() const;

  /// All that was added and not removed, marginalised variables and their factors as well, at the
  /// values of the last update.  What was frozen, or holds the graph in place of something absolute
  /// since Marginalise, is fixed.
  Graph Recorded() const;

 private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace graticule
