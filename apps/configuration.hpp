#pragma once

#include <string>
#include <vector>

#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "graticule/solver/options.hpp"

namespace graticule::apps {

/// How to solve, by name: where to start from, what to reject, and the solver's options.
struct Configuration {
  std::string name = "default";
  InitialiseOptions initialise;
  RejectionOptions rejection;
  SolveOptions solve;

  /// Throws Error (kUsage).
  void Set(std::string_view option, std::string_view value);
  /// "name=value".  Throws Error (kUsage).
  void Set(std::string_view assignment);
};

/// A ready configuration ("dogleg"), or a YAML file (anything with a slash or a dot).  Throws
/// Error: kUsage for a name or option that does not exist (with the nearest one), kInput for a file
/// that cannot be read.
Configuration LoadConfiguration(const std::string& name_or_file);

/// Names of the ready configurations.
std::vector<std::string> ReadyConfigurations();

/// A name, what it accepts, its value and help: every option, for `graticule options` and the docs.
struct OptionLine {
  std::string name, accepts, value, help;
};
std::vector<OptionLine> DescribeOptions(const Configuration& configuration = {});

}  // namespace graticule::apps
