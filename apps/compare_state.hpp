#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "graticule/io/comparison.hpp"

namespace graticule::apps {

/// The finished runs of a comparison in a file, so that one which was stopped goes on where it was.
class CompareState {
 public:
  /// `fingerprint` is one word for all that the runs depend on, of which there are `count`.  Throws
  /// Error: a file that is not one, is damaged, or is another comparison's.  Without a path nothing
  /// is kept.
  CompareState(std::string path, const std::string& fingerprint, std::size_t count);

  /// By their numbers, those that the file had.
  const std::map<std::size_t, ComparisonRun>& Kept() const { return kept_; }

  /// Writes the file anew, with this one.  Throws Error (kOther).
  void Keep(std::size_t number, const ComparisonRun& run);

 private:
  std::string path_, text_;
  std::map<std::size_t, ComparisonRun> kept_;
};

}  // namespace graticule::apps
