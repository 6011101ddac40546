#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/accuracy.hpp"
#include "graticule/io/certificate_summary.hpp"
#include "graticule/io/repaired_information.hpp"

namespace graticule {

/// What whoever called Solve knows about a run beside the solver's own Report.  Empty: left out.
struct ReportContext {
  std::string file;            ///< the problem
  std::string format;          ///< "g2o", "fg"
  std::string configuration;   ///< the configuration's name or file
  std::string initialisation;  ///< one line: "spanning tree, cost 5.21e4"
  std::vector<std::string> outputs;
  std::uint64_t peak_memory_bytes = 0;          ///< of the whole process; 0: not known
  std::vector<std::pair<std::string, std::string>> extras;
  /// What was done to the problem as it was read.
  std::optional<RepairedInformation> repaired = {};
  std::optional<Accuracy> accuracy = {};  ///< against a ground truth
  std::optional<CertificateSummary> certificate = {};
};

}  // namespace graticule
