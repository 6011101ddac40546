#pragma once

#include <string>
#include <vector>

#include "graticule/problems/calibration/study.hpp"

namespace graticule {

/// One lens, calibrated by everybody: suggestions, ROS' rules, novices.
constexpr Strategy kStrategies[] = {Strategy::kSuggestions, Strategy::kRosRules, Strategy::kNovice};
struct LensRuns {
  StudyLens lens;
  std::vector<StudyTrial> by[3];  ///< as kStrategies
};

/// Means over the trials of one lens and person, by number of frames, as the thesis' Figure 5.7 has
/// them; frame counts that leave half of the trials bootstrapping are left out.
struct FrameMeans {
  std::vector<double> frames, ere, p995, largest;
  void Add(const std::vector<StudyTrial>& run);
};

/// Trials of a person with a model, for Figure 5.5.
struct ParameterSpread {
  std::string name;
  std::vector<StudyTrial> run;
};

/// Writes figure_5_5, figure_5_7 (frames against Max ERE and test errors) and figure_5_7_pairs
/// (Max ERE against the 99.5th percentile), .svg and .png, into a folder that is there.
void WriteFigures(const std::string& folder, const std::vector<LensRuns>& all,
                  const std::vector<ParameterSpread>& spreads);

}  // namespace graticule
