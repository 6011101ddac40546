#include "graticule/problems/segmentation/coregister_evaluate.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/factors/camera_model.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

std::vector<std::string> ParameterNames(const CameraIntrinsics& camera) {
  std::vector<std::string> names;
  std::string word;
  for (const char* c = CameraModelOf(camera.model).fields;; ++c) {
    if (*c != ' ' && *c != '\0') {
      word += *c;
      continue;
    }
    names.push_back(word.substr(0, word.find(':')));
    word.clear();
    if (*c == '\0') return names;
  }
}

HeldOut LeaveOneOut(const Registry& types, const CoregisterData& data, const Coregistration& whole,
                    const CoregisterOptions& options) {
  HeldOut held_out;
  double squares = 0, counted_squares = 0, counted = 0;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    CoregisterData others = data;
    others.points.erase(others.points.begin() + static_cast<std::ptrdiff_t>(i));
    double distance = HUGE_VAL;
    try {
      const Coregistration without = RefineCoregistration(types, others, whole.state, options);
      distance = PointResiduals(without.state, {data.points[i]})[0].norm();
      if (!std::isfinite(distance)) distance = HUGE_VAL;
    } catch (const Error& error) {
      if (error.Kind() != ErrorKind::kIllPosed) throw;
    }
    held_out.distances_px.push_back(distance);
    squares += distance * distance;
    if (!whole.use[i]) continue;
    counted_squares += distance * distance;
    ++counted;
  }
  if (held_out.distances_px.empty()) return held_out;
  held_out.rms_px = std::sqrt(squares / static_cast<double>(data.points.size()));
  held_out.rms_counted_px = counted > 0 ? std::sqrt(counted_squares / counted) : HUGE_VAL;
  std::vector<double> sorted = held_out.distances_px;
  std::sort(sorted.begin(), sorted.end());
  held_out.median_px = sorted[sorted.size() / 2];
  return held_out;
}

FreedCoregistration FreeParameters(const Registry& types, const CoregisterData& data,
                                   const Coregistration& solved, const CoregisterOptions& options,
                                   double least_gain) {
  FreedCoregistration result{solved, LeaveOneOut(types, data, solved, options), options, {}};
  const std::vector<std::string> names = ParameterNames(solved.state.camera);
  result.options.free_parameters.resize(names.size(), 0);
  // The same points in every round, else a model could win by naming more outliers.
  const CoregisterUse counted = solved.use;
  const auto error_of = [&](const HeldOut& held_out) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      if (!counted[i]) continue;
      sum += held_out.distances_px[i] * held_out.distances_px[i];
      ++count;
    }
    return count > 0 ? std::sqrt(sum / count) : HUGE_VAL;
  };
  double least = error_of(result.held_out);
  for (;;) {
    FreedCoregistration best = result;
    std::vector<FreedParameter> round;
    double best_error = HUGE_VAL;
    for (std::size_t p = 0; p < names.size(); ++p) {
      if (result.options.free_parameters[p]) continue;
      CoregisterOptions freed = result.options;
      freed.free_parameters[p] = 1;
      double error = HUGE_VAL;
      try {
        // From the held camera: a path over other parameters must not decide.
        const Coregistration with = RefineCoregistration(types, data, solved.state, freed);
        const HeldOut held_out = LeaveOneOut(types, data, with, freed);
        error = error_of(held_out);
        if (error < best_error) {
          best_error = error;
          best.solved = with;
          best.held_out = held_out;
          best.options = freed;
        }
      } catch (const Error& refused) {
        if (refused.Kind() != ErrorKind::kIllPosed) throw;
      }
      round.push_back({names[p], error, false});
    }
    std::stable_sort(round.begin(), round.end(),
                     [](const auto& a, const auto& b) { return a.held_out_px < b.held_out_px; });
    const bool is_better = best_error < (1 - least_gain) * least;
    if (!is_better) {
      result.tried.insert(result.tried.end(), round.begin(), round.end());
      return result;
    }
    round[0].is_kept = true;
    best.tried = result.tried;
    best.tried.push_back(round[0]);
    result = std::move(best);
    least = best_error;
  }
}

}  // namespace graticule
