#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graticule/io/accuracy.hpp"
#include "graticule/io/repaired_information.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

/// One problem solved with one configuration, once or several times over.
struct ComparisonRun {
  std::string file, configuration;
  std::string error;  ///< why there is no result; then only file and configuration count
  Report report;
  /// The lowest cost known for this file; nan: none is.
  double best_known = std::numeric_limits<double>::quiet_NaN();
  /// (final cost - best known) / best known; where that is nearly zero, relative to 1e-12 of the
  /// initial cost; nan: unknown.
  double gap = std::numeric_limits<double>::quiet_NaN();
  std::size_t repeats = 1;
  Timing median;  ///< over the repeats, each phase for itself
  double min_total_s = 0, max_total_s = 0;
  std::uint64_t peak_memory_bytes = 0;          ///< 0: not known
  std::optional<RepairedInformation> repaired;  ///< what was done to the file as it was read
  std::optional<Accuracy> accuracy;             ///< where there is a ground truth
};

/// Runs in the order in which they are shown; those of one file need not stand together.
struct Comparison {
  std::vector<ComparisonRun> runs;
  std::vector<std::pair<std::string, std::string>> provenance;
};

/// One JSON object with `runs` and `provenance`; each run has its figures, and the whole report as
/// ReportJson writes it.
std::string ComparisonJson(const Comparison& comparison);

/// One self-contained page: for each file a table, convergence against time, and time by phase.
std::string ComparisonHtml(const Comparison& comparison);

/// Aligned columns for a terminal, at most 120 wide, a block for each file; `colour`: with ANSI
/// escapes.
std::string ComparisonTable(const Comparison& comparison, bool colour);

}  // namespace graticule
