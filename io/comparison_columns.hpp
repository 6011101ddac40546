#pragma once

#include <string>
#include <vector>

#include "graticule/io/comparison.hpp"

namespace graticule {

/// What the page and the terminal both show of a comparison: the same cells, the same winners.
struct ComparisonCell {
  std::string text;
  bool best = false;  ///< the best of its column, or as good
  bool bad = false;
};

struct ComparisonColumn {
  std::string name, hint;
  bool number = true;
  bool main = true;                   ///< of the first rank: shown on a terminal too
  std::vector<ComparisonCell> cells;  ///< one for each run
};

/// The runs of one file.
struct ComparisonBlock {
  std::string file;
  std::vector<const ComparisonRun*> runs;
  std::vector<ComparisonColumn> columns;  ///< those that say something
  std::vector<std::string> remarks;       ///< about the file, a line each
};

/// One block for each file, in the order in which the files first come.  Points into `comparison`.
///
/// Best are the lowest costs and errors among all runs, but the lowest times and memory among those
/// that converged: to give up early is not to be fast.  Where fewer than two can compete, none is.
std::vector<ComparisonBlock> ComparisonBlocks(const Comparison& comparison);

}  // namespace graticule
