#include "graticule/problems/calibration/fit_model.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {

std::vector<double> PlainParameters(const CameraModel& model, double focal_px, double centre_x,
                                    double centre_y) {
  std::vector<double> parameters = {focal_px, focal_px, centre_x, centre_y};
  parameters.resize(static_cast<std::size_t>(model.parameters), 0);
  // Of angular ones zeros, too: straight is k = 1/3, 2/15, 17/315, ... (the series of the tangent),
  // and none is a fisheye.
  if (model.start) std::copy(model.start, model.start + model.parameters - 4, &parameters[4]);
  return parameters;
}

FittedModel FitModel(const Registry& types, const Camera& camera,
                     const std::vector<Eigen::Vector2d>& pixels, const std::string& name) {
  const CameraModel& model = CameraModelOf(name);
  const CameraIntrinsics& from = camera.Intrinsics();
  // A camera with a plane in front of it has images up to 90 degrees, which lie at infinity: what
  // is beyond 80 would rule the rest.
  const double max_angle = model.sees_behind ? M_PI : 80 * M_PI / 180;
  Factor factor{model.view_factor,
                {Key("camera", 0), Key("camera_from_rig", 0), Key("target", 0), Key("warp", 0)},
                {},
                Noise::Unit(),
                {},
                ""};
  FittedModel fitted;
  for (const Eigen::Vector2d& pixel : pixels) {
    const auto ray = camera.Unproject(pixel);
    if (!ray || std::atan2(std::hypot(ray->x(), ray->y()), ray->z()) > max_angle) {
      ++fitted.unseen;
      continue;
    }
    factor.measurement.insert(factor.measurement.end(),
                              {ray->x(), ray->y(), ray->z(), pixel.x(), pixel.y()});
  }
  fitted.camera = from;
  fitted.camera.model = name;
  const std::vector<double>& p = from.parameters;
  fitted.camera.parameters = PlainParameters(model, std::sqrt(p[0] * p[1]), p[2], p[3]);
  // As many rays as numbers, or the start is as good as it gets.
  if (factor.measurement.size() < 5 * fitted.camera.parameters.size()) return fitted;
  // One factor's coordinates are shared by three: the rays are the places of a target's corners.
  Graph graph(types);
  graph.Add(Key("camera", 0), model.variable, fitted.camera.parameters);
  const std::vector<double> identity(kIdentityPose.begin(), kIdentityPose.end());
  graph.Add(Key("camera_from_rig", 0), "se3/1", identity, true);
  graph.Add(Key("target", 0), "se3/1", identity, true);
  graph.Add(Key("warp", 0), "board_warp/1", {0, 0, 0}, true);
  graph.Add(factor);
  SolveOptions options;
  options.max_iterations = 200;
  options.initial_trust_region_radius = 1e4;
  const Solution solution = Solve(graph, options);
  const Span<const double> found = solution.values.At(Key("camera", 0));
  fitted.camera.parameters.assign(found.begin(), found.end());
  const auto rays = static_cast<double>(factor.measurement.size() / 5);
  fitted.rms_px = std::sqrt(solution.report.Chi2() / rays);
  return fitted;
}

}  // namespace graticule
