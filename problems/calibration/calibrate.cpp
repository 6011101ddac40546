#include "graticule/problems/calibration/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "graticule/factors/camera_model.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

std::vector<double> VectorOf(const Se3Array& pose) { return {pose.begin(), pose.end()}; }

Key CameraKey(std::size_t camera) { return {"camera", camera}; }
Key MountKey(std::size_t camera) { return {"camera_from_rig", camera}; }
Key TargetKey(std::size_t exposure) { return {"target", exposure}; }
Key CornerKey(int id) { return {"corner", static_cast<std::uint64_t>(id)}; }

void CheckFits(const Detections& detections, const CalibrationState& state, const CornerUse& use) {
  const auto refuse = [](const std::string& what) {
    throw Error("a calibration's state does not fit its detections: " + what, ErrorKind::kUsage);
  };
  if (state.cameras.size() != detections.cameras.size() ||
      state.camera_from_rig.size() != state.cameras.size())
    refuse("expected " + std::to_string(detections.cameras.size()) + " cameras");
  if (state.rig_from_target.size() != detections.exposures)
    refuse("expected " + std::to_string(detections.exposures) + " exposures");
  if (use.size() != detections.views.size())
    refuse("expected " + std::to_string(detections.views.size()) + " views");
}

// The median distance between neighbouring corners of a target: of each corner to its nearest.
double Spacing(const std::map<int, Eigen::Vector3d>& places) {
  std::vector<double> nearest;
  for (const auto& [id, place] : places) {
    double least = HUGE_VAL;
    for (const auto& [other, there] : places)
      if (other != id) least = std::min(least, (there - place).squaredNorm());
    nearest.push_back(least);
  }
  if (nearest.size() < 2) return 0;
  std::nth_element(nearest.begin(), nearest.begin() + nearest.size() / 2, nearest.end());
  return std::sqrt(nearest[nearest.size() / 2]);
}

std::map<int, Eigen::Vector3d> PlacesAsDescribed(const Detections& detections) {
  std::map<int, Eigen::Vector3d> places;
  for (const TargetView& view : detections.views)
    for (const DetectedCorner& corner : view.corners)
      places.emplace(corner.id, Eigen::Vector3d(corner.in_target.data()));
  return places;
}

// All of a view's corners that count, as one factor.
void AddView(const TargetView& view, const std::vector<std::uint8_t>& use, const std::string& type,
             double sigma_px, Graph* graph) {
  Factor factor{
      type,
      {CameraKey(view.camera), MountKey(view.camera), TargetKey(view.exposure), Key("warp", 0)},
      {},
      Noise::Sigma(sigma_px),
      {},
      view.image};
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    if (!use[i]) continue;
    const DetectedCorner& corner = view.corners[i];
    factor.measurement.insert(factor.measurement.end(), corner.in_target.begin(),
                              corner.in_target.end());
    factor.measurement.insert(factor.measurement.end(), corner.pixel.begin(), corner.pixel.end());
  }
  if (!factor.measurement.empty()) graph->Add(factor);
}

void AddViewWithFreeCorners(const TargetView& view, const std::vector<std::uint8_t>& use,
                            Graph::TypeId type, double sigma_px, Graph* graph) {
  const VariableId camera = graph->IdOf(CameraKey(view.camera));
  const VariableId mount = graph->IdOf(MountKey(view.camera));
  const VariableId target = graph->IdOf(TargetKey(view.exposure));
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    if (!use[i]) continue;
    const VariableId ids[4] = {camera, mount, target, graph->IdOf(CornerKey(view.corners[i].id))};
    graph->Add(type, {ids, 4}, {view.corners[i].pixel.data(), 2},
               {NoiseKind::kSigma, {&sigma_px, 1}}, {}, view.image);
  }
}

}  // namespace

double CornerSigma(const Detections& detections, const CalibrationOptions& options) {
  if (options.corner_sigma_m > 0) return options.corner_sigma_m;
  return Spacing(PlacesAsDescribed(detections)) / 50;
}

Graph BuildCalibration(const Registry& types, const Detections& detections,
                       const CalibrationState& state, const CornerUse& use,
                       const CalibrationOptions& options, double sigma_px) {
  CheckFits(detections, state, use);
  const bool is_free = options.board == BoardShape::kFree;
  Graph graph(types);
  for (std::size_t c = 0; c < state.cameras.size(); ++c) {
    const CameraModel& model = CameraModelOf(state.cameras[c].model);
    graph.Add(CameraKey(c), model.variable, state.cameras[c].parameters);
    graph.Add(MountKey(c), "se3/1", VectorOf(state.camera_from_rig[c]), c == 0);
    if (c < options.camera_priors.size()) {
      const CameraPrior& prior = options.camera_priors[c];
      graph.Add(Factor{model.prior_factor, {CameraKey(c)}, prior.mean, prior.noise, {}, "prior"});
    }
  }
  for (std::size_t e = 0; e < state.rig_from_target.size(); ++e)
    if (state.rig_from_target[e])
      graph.Add(TargetKey(e), "se3/1", VectorOf(*state.rig_from_target[e]));
  if (!is_free)
    graph.Add(Key("warp", 0), "board_warp/1", {state.warp.begin(), state.warp.end()},
              options.board == BoardShape::kFlat);

  if (is_free) {
    const std::map<int, Eigen::Vector3d> described = PlacesAsDescribed(detections);
    const double sigma = CornerSigma(detections, options);
    std::set<int> seen;
    for (std::size_t v = 0; v < detections.views.size(); ++v) {
      const TargetView& view = detections.views[v];
      if (!state.rig_from_target[view.exposure]) continue;
      for (std::size_t i = 0; i < view.corners.size(); ++i) {
        const DetectedCorner& corner = view.corners[i];
        if (!use[v][i] || !seen.insert(corner.id).second) continue;
        const Eigen::Vector3d place = PlaceOf(state, corner);
        graph.Add(CornerKey(corner.id), "point3/1", {place.x(), place.y(), place.z()});
        const Eigen::Vector3d& mean = described.at(corner.id);
        graph.Add(Factor{"prior_point3/1",
                         {CornerKey(corner.id)},
                         {mean.x(), mean.y(), mean.z()},
                         Noise::Sigma(sigma),
                         {},
                         "target"});
      }
    }
  }

  for (std::size_t v = 0; v < detections.views.size(); ++v) {
    const TargetView& view = detections.views[v];
    if (!state.rig_from_target[view.exposure]) continue;
    const CameraModel& model = CameraModelOf(state.cameras[view.camera].model);
    if (is_free) {
      AddViewWithFreeCorners(view, use[v], graph.FactorTypeId(model.corner_factor), sigma_px,
                             &graph);
    } else {
      AddView(view, use[v], model.view_factor, sigma_px, &graph);
    }
  }
  return graph;
}

CalibrationState ReadBackCalibration(const Graph& graph, const Values& values,
                                     CalibrationState state) {
  const auto pose = [&](const Key& key) {
    const Span<const double> x = values.At(key);
    Se3Array result;
    std::copy(x.begin(), x.end(), result.begin());
    return result;
  };
  for (std::size_t c = 0; c < state.cameras.size(); ++c) {
    const Span<const double> p = values.At(CameraKey(c));
    state.cameras[c].parameters.assign(p.begin(), p.end());
    state.camera_from_rig[c] = pose(MountKey(c));
  }
  for (std::size_t e = 0; e < state.rig_from_target.size(); ++e)
    if (state.rig_from_target[e]) state.rig_from_target[e] = pose(TargetKey(e));
  if (values.Has(Key("warp", 0))) {
    const Span<const double> w = values.At(Key("warp", 0));
    std::copy(w.begin(), w.end(), state.warp.begin());
    state.corners.clear();
  }
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const Key& key = graph.KeyOf(id);
    if (key.Family() != "corner") continue;
    const Span<const double> p = values[id];
    state.corners[static_cast<int>(key.Number())] = {p[0], p[1], p[2]};
  }
  return state;
}

std::vector<Eigen::Vector2d> ViewResiduals(const CalibrationState& state, const TargetView& view) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector2d> residuals(view.corners.size(), Eigen::Vector2d(nan, nan));
  if (!state.rig_from_target[view.exposure]) return residuals;
  const CameraIntrinsics& camera = state.cameras[view.camera];
  const CameraModel& model = CameraModelOf(camera.model);
  const Eigen::Isometry3d camera_from_target = IsometryOf(state.camera_from_rig[view.camera]) *
                                               IsometryOf(*state.rig_from_target[view.exposure]);
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_target * PlaceOf(state, view.corners[i]);
    Eigen::Vector2d pixel;
    if (model.project(camera.parameters.data(), in_camera.data(), pixel.data(), nullptr, nullptr))
      residuals[i] = pixel - Eigen::Vector2d(view.corners[i].pixel.data());
  }
  return residuals;
}

namespace {

using Residuals = std::vector<std::vector<Eigen::Vector2d>>;

Residuals AllResiduals(const CalibrationState& state, const Detections& detections) {
  Residuals residuals;
  for (const TargetView& view : detections.views) residuals.push_back(ViewResiduals(state, view));
  return residuals;
}

// Standard deviation of one coordinate, blind to outliers: the median distance of a corner is
// 1.1774 of it (Rayleigh).  Never below a thousandth of a pixel, where predictions are exact.
double RobustSigma(std::vector<double> distances) {
  distances.erase(std::remove_if(distances.begin(), distances.end(),
                                 [](double d) { return !std::isfinite(d); }),
                  distances.end());
  if (distances.empty()) return 1;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return std::max(*middle / 1.1774, 1e-3);
}

double RobustSigma(const Residuals& residuals) {
  std::vector<double> distances;
  for (const auto& view : residuals)
    for (const Eigen::Vector2d& r : view) distances.push_back(r.norm());
  return RobustSigma(std::move(distances));
}

// Corners within so many standard deviations; none of a view that would keep fewer than a pose
// needs.  Views differ: one that is blurred may be worse than the others by a factor of three, and
// keeps its corners.
CornerUse Near(const Residuals& residuals, double sigma, double sigmas) {
  constexpr std::ptrdiff_t kFewest = 4;
  constexpr double kWorse = 3;
  CornerUse use;
  for (const auto& view : residuals) {
    std::vector<double> distances;
    for (const Eigen::Vector2d& r : view) distances.push_back(r.norm());
    const double own = std::min(RobustSigma(distances), kWorse * sigma);
    std::vector<std::uint8_t> near;
    for (const double distance : distances)
      near.push_back(distance <= sigmas * std::max(sigma, own));
    if (std::count(near.begin(), near.end(), 1) < kFewest) near.assign(near.size(), 0);
    use.push_back(std::move(near));
  }
  return use;
}

// An exposure of which nothing counts has no pose.
void DropUnseen(const Detections& detections, const CornerUse& use, CalibrationState* state) {
  std::vector<char> is_seen(detections.exposures, 0);
  for (std::size_t v = 0; v < use.size(); ++v)
    if (std::count(use[v].begin(), use[v].end(), 1) > 0) is_seen[detections.views[v].exposure] = 1;
  for (std::size_t e = 0; e < detections.exposures; ++e)
    if (!is_seen[e]) state->rig_from_target[e].reset();
}

void Summarise(const Detections& detections, const Graph& graph, Calibration* calibration) {
  const Residuals residuals = AllResiduals(calibration->state, detections);
  double sum = 0;
  std::size_t count = 0;
  calibration->worst_px = 0;
  calibration->outliers.clear();
  calibration->left_out.clear();
  for (std::size_t v = 0; v < residuals.size(); ++v) {
    if (!calibration->state.rig_from_target[detections.views[v].exposure]) {
      calibration->left_out.push_back(v);
      continue;
    }
    for (std::size_t i = 0; i < residuals[v].size(); ++i) {
      const double distance = residuals[v][i].norm();
      if (!calibration->use[v][i]) {
        calibration->outliers.push_back({v, i, distance});
        continue;
      }
      sum += distance * distance;
      ++count;
      calibration->worst_px = std::max(calibration->worst_px, distance);
    }
  }
  std::stable_sort(calibration->outliers.begin(), calibration->outliers.end(),
                   [](const Outlier& a, const Outlier& b) {
                     // one without a prediction is the worst
                     if (std::isnan(a.error_px) || std::isnan(b.error_px))
                       return std::isnan(a.error_px) && !std::isnan(b.error_px);
                     return a.error_px > b.error_px;
                   });
  calibration->corners = count;
  calibration->freedoms = 0;
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    if (!graph.IsFixed(id)) calibration->freedoms += graph.TypeOf(id).TangentSize();
  calibration->rms_px = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
  // The priors of a free board's corners are measurements too: three for three numbers each.
  const double measured = 2.0 * static_cast<double>(count) +
                          3.0 * static_cast<double>(calibration->state.corners.size());
  const double left = measured - calibration->freedoms;
  calibration->sigma_px = left > 0 ? std::sqrt(sum / left) : 0;
}

}  // namespace

Calibration RefineCalibration(const Registry& types, const Detections& detections,
                              const CalibrationState& start, const CalibrationOptions& options) {
  constexpr int kRounds = 12;
  Calibration result;
  result.state = start;
  Residuals residuals = AllResiduals(start, detections);
  double sigma = options.sigma_px > 0 ? options.sigma_px : RobustSigma(residuals);
  // At first whatever the start can predict counts, unless it is far beyond the others: a start is
  // not yet near enough to judge by.
  constexpr double kGenerous = 30;  // px
  result.use = Near(residuals, std::max(sigma, kGenerous / options.outlier_sigmas / 10),
                    10 * options.outlier_sigmas);
  for (int round = 0; round < kRounds; ++round) {
    DropUnseen(detections, result.use, &result.state);
    const Graph graph =
        BuildCalibration(types, detections, result.state, result.use, options, sigma);
    if (options.before_solve) options.before_solve();
    Solution solution = Solve(graph, options.solve);
    result.weight_sigma_px = sigma;
    result.state = ReadBackCalibration(graph, solution.values, std::move(result.state));
    result.report = std::move(solution.report);
    residuals = AllResiduals(result.state, detections);
    if (!(options.sigma_px > 0)) sigma = RobustSigma(residuals);
    CornerUse use = Near(residuals, sigma, options.outlier_sigmas);
    const bool is_settled = use == result.use;
    Summarise(detections, graph, &result);
    if (is_settled) break;
    if (round + 1 < kRounds) result.use = std::move(use);
  }
  return result;
}

}  // namespace graticule
