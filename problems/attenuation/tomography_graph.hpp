#pragma once

#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/signal_rows.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"

namespace graticule {

/// Which variable of a graph is what.
struct TomographyLayout {
  RadioBias bias = RadioBias::kNone;
  std::uint32_t radios = 0;
  std::vector<AttenuationCell> cells;
  std::vector<Key> cell_keys;  ///< in the same order
};

struct TomographyGraph {
  Graph graph;
  TomographyLayout layout;
};

/// What a solved graph says, in dB, dBm and dB/m.
struct TomographyEstimate {
  double l0_dbm = 0, slope_db = 0;
  std::vector<double> receiver_bias_db, transmitter_bias_db;  ///< by radio
  std::vector<double> db_per_m;                               ///< losses, as layout.cells
};

/// The model of TomographyOptions as a factor graph, for Solve and for recording:
///
/// - `path_loss:0` [L0, a], `bias:R` (or `listener:R` and `sender:R`), `cell_CLASS:N` [dB/m], N
///   counting the cells of the rays' rectangle row by row; cells that no ray comes near have none;
/// - a signal_path/1 a row (path_loss/1 without attenuation and biases), signal_path_not_heard/1
///   for packets not heard; attenuation_smooth/1 between neighbours; priors on everything.
///
/// Noise and correlation are those of the options: what a Tomography has estimated may be put
/// there.  Throws Error as Tomography does.
TomographyGraph BuildTomography(Span<const SignalMeasurement> measurements,
                                std::shared_ptr<const ClassMap> map,
                                const TomographyOptions& options);

/// How to solve such a graph: it is linear unless it has a loss or packets that were not heard, so
/// one step is the solution, and a gradient of rounding errors must be seen to be that.  What is
/// left of the gradient, 1e-8 / dB, moves no unknown by more than 1e-8 times its prior variance.
SolveOptions TomographySolving();

/// Throws Error (kUsage): values of another graph.
TomographyEstimate ReadBackTomography(const TomographyLayout& layout, const Values& values);

}  // namespace graticule
