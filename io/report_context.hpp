#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/accuracy.hpp"
#include "graticule/io/certificate_summary.hpp"
#include "graticule/io/repaired_information.hpp"
#include "graticule/io/second_look_summary.hpp"
#include "graticule/solver/factor.hpp"

namespace graticule {

/// A factor that was left out because it is wrong, and what says so.
struct RejectedFactor {
  FactorId id = 0;
  std::string type;
  std::string source;
  std::vector<Key> keys;
  double chi2 = 0;   ///< r' W r at the solution without it
  double limit = 0;  ///< the chi2 up to which it would have been kept
};

/// What was rejected before the graph was solved.
struct RejectionSummary {
  std::string method;
  std::size_t suspects = 0, trusted = 0;                             ///< factors
  std::vector<std::pair<std::string, std::size_t>> suspect_sources;  ///< how many of each
  double inlier_quantile = 0, inlier_noise_scale = 1;
  std::vector<RejectedFactor> rejected;  ///< all, in the graph's order
  double seconds = 0;
};

/// What whoever called Solve knows about a run beside the solver's own Report.  Empty: left out.
struct ReportContext {
  std::string file;            ///< the problem
  std::string format;          ///< "g2o", "fg"
  std::string configuration;   ///< the configuration's name or file
  std::string initialisation;  ///< one line: "spanning tree, cost 5.21e4"
  std::vector<std::string> outputs;
  std::uint64_t peak_memory_bytes = 0;  ///< of the whole process; 0: not known
  std::vector<std::pair<std::string, std::string>> extras;
  /// What was done to the problem as it was read.
  std::optional<RepairedInformation> repaired = {};
  std::optional<Accuracy> accuracy = {};  ///< against a ground truth
  std::optional<CertificateSummary> certificate = {};
  std::optional<SecondLookSummary> second_look = {};
  std::optional<RejectionSummary> rejection = {};  ///< none: nothing was looked for
};

}  // namespace graticule
