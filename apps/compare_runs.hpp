#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "configuration.hpp"
#include "graticule/io/comparison.hpp"
#include "graticule/solver/registry.hpp"
#include "ground_truth.hpp"

namespace graticule::apps {

/// The runs of a comparison: each file with each configuration, numbered in this order.  Every
/// process that works on it makes the same.
class CompareRuns {
 public:
  /// Throws Error: a configuration, an option or a plug-in that there is not.
  CompareRuns(const CompareCommand& command, const Console& console);

  std::size_t Count() const { return command_.files.size() * configurations_.size(); }
  std::size_t FileOf(std::size_t run) const { return run / configurations_.size(); }
  std::string ConfigurationOf(std::size_t run) const {
    return configurations_[run % configurations_.size()].name;
  }

  /// Reads a file before any of its runs, so that one that is refused is refused once.  Throws
  /// Error.
  std::optional<RepairedInformation> Check(const std::string& file);

  /// What a run found, as ResultOf reads it.
  std::string Handle(std::size_t run);

  /// One word for all that the runs depend on: words, what is in the files (as Check found them),
  /// versions.
  std::string Fingerprint() const;

 private:
  Report RunOnce(const std::string& file, const Configuration& configuration,
                 const std::string& what, std::optional<Accuracy>* accuracy);
  ComparisonRun Repeat(const std::string& file, const Configuration& configuration);

  const CompareCommand& command_;
  const Console& console_;
  std::vector<Configuration> configurations_;
  Registry types_;
  std::map<std::string, TruthOf> truths_;  // by file, of those that this process has read
  std::string inputs_;                     // checksums of what was checked
};

struct CompareResult {
  ComparisonRun run;
  bool is_whole = false;  ///< false: stopped before its end
};
CompareResult ResultOf(const std::string& text);

}  // namespace graticule::apps
