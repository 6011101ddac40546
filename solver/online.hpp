#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"

namespace graticule {

struct OnlineOptions {
  /// A variable is linearised anew where a component of its step since then (m, rad) is larger.
  double relinearise_above = 0.05;
  /// ... which is looked for at every so many updates.
  int relinearise_every = 10;
  /// Changes smaller than this, in every component, are not followed to variables further off.
  double propagate_above = 1e-4;
  /// How UpdateExactly solves.
  SolveOptions solve;
};

/// What an update did.
struct OnlineReport {
  std::size_t new_variables = 0, new_factors = 0;
  std::size_t eliminated = 0;    ///< variables eliminated anew
  std::size_t relinearised = 0;  ///< variables linearised anew
  std::size_t changed = 0;       ///< variables whose value was computed anew
  /// Variables that nothing determines in some direction: they stay near where they are.
  std::vector<Key> loose;
  double objective = 0;  ///< of UpdateExactly: 0.5 sum rho(r' W r)
  double seconds = 0;    ///< wall time
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
  explicit Online(Registry types, OnlineOptions options = {});
  ~Online();
  Online(const Online&) = delete;
  Online& operator=(const Online&) = delete;

  /// As Graph::Add.  The value should be a guess made from Latest(): from there the first step is
  /// small.
  VariableId Add(const Key& key, std::string_view type, const std::vector<double>& value,
                 bool fixed = false);
  FactorId Add(const Factor& factor);

  /// Takes in what was added since the last update, and publishes new values.
  /// Throws Error (kOther) where a factor cannot be evaluated: what was published stays, and the
  /// next update begins from there.
  OnlineReport Update();
  /// The same, and then on to the minimum, as Solve finds it from here.
  OnlineReport UpdateExactly();

  /// Holds variables where they are from now on: they cost nothing any more, and neither do factors
  /// that touch none but such (thesis ch. 6, "freeze parts of the map").  Throws Error: unknown
  /// key.
  void Freeze(const std::vector<Key>& keys);

  /// The values of the last update.  Thread-safe.  Before the first: null.
  std::shared_ptr<const Values> Latest() const;

  /// The marginal covariance of a variable, in its tangent, row by row, as of the last update and
  /// where factors were last linearised.  Zero where it is held.  Throws Error: unknown key, or one
  /// added since the last update.
  std::vector<double> Covariance(const Key& key) const;

  /// The whole problem, to be written or solved by others.  Its values are those of the last
  /// update.
  Graph Problem() const;

 private:
  struct Machine;
  std::unique_ptr<Machine> machine_;
};

}  // namespace graticule
