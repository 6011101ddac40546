#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {

/// The files that a command writes.  Every one is tried, also after one failed: a full disk for the
/// plot must not cost the solution.
class Outputs {
 public:
  explicit Outputs(const Console& console) : console_(console) {}

  /// Writes what goes to this path; nothing where that is empty.  An Error is said on stderr.
  template <class Write>
  void Try(const std::string& path, const Write& write) {
    if (path.empty()) return;
    try {
      write();
      written_.push_back(path);
    } catch (const graticule::Error& error) {
      console_.Error(error.what());
      if (failure_ == kDone) failure_ = ExitOf(error.Kind());
    }
  }
  /// How the command ends for the first that could not be written; kDone where all were.
  Exit Failure() const { return failure_; }
  const std::vector<std::string>& Written() const { return written_; }

 private:
  const Console& console_;
  Exit failure_ = kDone;
  std::vector<std::string> written_;
};

}  // namespace graticule::apps
