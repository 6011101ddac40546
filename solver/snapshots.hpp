#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// Values of a growing graph, one publication after the other, each at the cost of what changed
/// since: whatever no reader holds any more is brought up to date and given out again.  One thread
/// makes them; any may hold, copy and let go of them, at any time.
class Snapshots {
 public:
  Snapshots();

  /// The values `data`, laid out as the graph's.  `changed`: the variables whose numbers are
  /// otherwise than at the last call; those that are new since need not be among them.
  std::shared_ptr<const Values> Make(const Graph& graph, const std::vector<double>& data,
                                     const std::vector<VariableId>& changed);

 private:
  struct Pool;
  struct Spare;
  std::shared_ptr<const Layout> MakeLayout(const Graph& graph);

  // Shared with what is given out: readers may outlive us.
  std::shared_ptr<Pool> pool_;
  std::uint64_t made_ = 0;
  std::deque<std::vector<VariableId>> changes_;  // of the latest calls
};

}  // namespace graticule
