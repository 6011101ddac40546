#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "graticule/io/occupancy.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/growing_map.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/tune.hpp"

namespace graticule {

/// A number that a method's predictions depend on, and that measurements do not tell while it runs.
struct MetaParameter {
  std::string name;  ///< "matte.phi_structure", "gp.length_m"
  std::function<double*(MethodOptions*)> value;
  bool is_log = true;  ///< searched by factors of two; false: by steps of `step`
  double step = 1;
  double least = 0, most = 0;
};

/// Those of a method, of its mean first (thesis Table 3.1 and what came to it since): cell size,
/// lambda, rho and phi of each class, deviation of the biases; lengths and deviations of the
/// Gaussian processes unless they are learnt.  None: mean, log-fit.  Throws Error (kUsage): no such
/// method.
std::vector<MetaParameter> MetaParameters(const std::string& method,
                                          const MethodOptions& options = {});

/// A log to tune on, and the map that came with it (null: none), or as it grew.
struct TrainingLog {
  SignalLog log;
  std::shared_ptr<const OccupancyGrid> map;
  std::vector<TimedMap> maps = {};
};

enum class TuneBy { kMse, kNegativeLogLikelihood };

struct TuneOptions {
  TuneBy by = TuneBy::kNegativeLogLikelihood;
  ReplayOptions replay;
  std::vector<std::string> only;  ///< names of parameters; empty: all of the method
  double first_step = 1, last_step = 0.25;
  std::size_t max_evaluations = 200, threads = 1;
  std::string state_path;  ///< as CompassOptions has it
};

struct TuneResult {
  MethodOptions options;
  std::vector<MetaParameter> parameters;  ///< those that were searched
  double before = 0, after = 0;           ///< mean of all logs' scores, all horizons together
  CompassResult search;
};

/// Compass search (thesis 3.3.1) for the meta-parameters with which a method predicts recorded logs
/// best, in the replay's way.  Throws Error (kUsage): no log, no such method or parameter, a method
/// without parameters; and what Replay and CompassSearch throw.
TuneResult TuneMethod(const std::string& method, const std::vector<TrainingLog>& logs,
                      const MethodOptions& start, const TuneOptions& options);

}  // namespace graticule
