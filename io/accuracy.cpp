#include "graticule/io/accuracy.hpp"

#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

std::string Spread(const ErrorSummary& error, const char* unit) {
  return "rmse " + ReadableNumber(error.rmse, 3) + ", mean " + ReadableNumber(error.mean, 3) +
         ", max " + ReadableNumber(error.max, 3) + " " + unit;
}

std::string Both(const PoseError& error) {
  return ReadableNumber(error.translation_m.rmse, 3) + " m, " +
         ReadableNumber(error.rotation_deg.rmse, 3) + " deg";
}

}  // namespace

std::string AccuracyTitle(const Accuracy& accuracy) {
  const FamilyAccuracy& all = accuracy.together;
  std::string title = accuracy.truth + ", " + std::to_string(all.matched) + " of " +
                      std::to_string(all.poses) + " poses, aligned: " + all.alignment;
  if (all.scale != 1) title += ", scale " + ReadableNumber(all.scale, 6);
  return title;
}

std::vector<std::string> AccuracyLines(const Accuracy& accuracy) {
  const FamilyAccuracy& all = accuracy.together;
  const std::string over = ReadableNumber(accuracy.rpe_distance_m, 4) + " m";
  std::vector<std::string> lines = {
      "ATE " + Spread(all.ate.translation_m, "m") + "; rotation " +
          Spread(all.ate.rotation_deg, "deg"),
      "RPE rmse a step " + Both(all.rpe_step) + "; over " + over + " " + Both(all.rpe_distance)};
  for (const FamilyAccuracy& family : accuracy.families)
    lines.push_back(family.family + " by itself: ATE rmse " + Both(family.ate) + "; RPE a step " +
                    Both(family.rpe_step) + ", over " + over + " " + Both(family.rpe_distance));
  return lines;
}

}  // namespace graticule
