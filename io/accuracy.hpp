#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace graticule {

/// An error over all poses, or pairs of poses.  Without any: nan.
struct ErrorSummary {
  std::size_t count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
};

/// Of poses: of where they are, and of how they are turned.
struct PoseError {
  ErrorSummary translation_m;
  ErrorSummary rotation_deg;
};

/// How far the poses of one key family, or of all together, are from the truth
/// (problems/pose_graph/trajectory_error.hpp defines the errors).
struct FamilyAccuracy {
  std::string family;  ///< empty: all together
  std::size_t poses = 0;
  std::size_t matched = 0;  ///< of these, the poses whose truth is known
  std::string alignment;    ///< "se2 (Umeyama, no scale)"
  double scale = 1;         ///< of the alignment
  PoseError ate;            ///< absolute, after alignment
  PoseError rpe_step;       ///< relative, from each pose to the next
  PoseError rpe_distance;   ///< relative, over a driven distance
};

struct Accuracy {
  std::string truth;  ///< the file that has it
  double rpe_distance_m = 0;
  FamilyAccuracy together;               ///< aligned as one
  std::vector<FamilyAccuracy> families;  ///< aligned each by itself; empty where there is but one
};

/// What was compared, and how: one line, for people.
std::string AccuracyTitle(const Accuracy& accuracy);
/// The errors, a few lines for people.
std::vector<std::string> AccuracyLines(const Accuracy& accuracy);

}  // namespace graticule
