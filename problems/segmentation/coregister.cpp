#include "graticule/problems/segmentation/coregister.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "graticule/factors/camera_model.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/f_quantile.hpp"
#include "graticule/problems/segmentation/coregister_outliers.hpp"
#include "graticule/problems/segmentation/coregister_start.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

const Key kCamera("camera", 0);
const Key kExtrinsics("camera_from_lidar", 0);

// Cauchy's loss is as wide as the noise: 95 % of least squares' efficiency at 2.385 of it in one
// dimension, and outliers of a few deviations are still let go.
constexpr double kCauchyScale = 2.385;

// Of right ones that least squares begins without.
constexpr double kFirstShare = 0.01;
constexpr int kMostRounds = 20;

// Standard deviations of a parameter that is taken from the camera's file, against the data's.
constexpr double kHeld = 1e-9;

std::vector<double> VectorOf(const Se3Array& pose) { return {pose.begin(), pose.end()}; }

bool AnyFree(const CoregisterOptions& options) {
  return std::any_of(options.free_parameters.begin(), options.free_parameters.end(),
                     [](std::uint8_t is_free) { return is_free != 0; });
}

int CountFree(const CoregisterOptions& options) {
  return static_cast<int>(std::count_if(options.free_parameters.begin(),
                                        options.free_parameters.end(),
                                        [](std::uint8_t is_free) { return is_free != 0; }));
}

std::vector<double> UpperTriangle(const Eigen::Matrix2d& m) { return {m(0, 0), m(0, 1), m(1, 1)}; }

// r' W r of every point and board at scale one; infinite where the camera has no image.
std::vector<double> SquaredDistances(const CoregisterData& data, const CoregisterState& state,
                                     const CoregisterOptions& options) {
  std::vector<double> squares;
  for (const CoregisterStatement& statement : StatementsOf(data, state, options))
    squares.push_back(statement.squared);
  return squares;
}

// Rows of residuals of what counts.
int RowsOf(const CoregisterData& data, const CoregisterUse& use) {
  int rows = 0;
  for (std::size_t i = 0; i < use.size(); ++i)
    if (use[i]) rows += i < data.points.size() ? 2 : 3;
  return rows;
}

// Standard deviation of the better half of the data and two more, as Rousseeuw (1984) has it.
double ScaleOf(std::vector<double> squares, double rows, int freedoms) {
  const std::size_t rank = std::min(squares.size() - 1, (squares.size() + 3) / 2);
  const auto at = squares.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(squares.begin(), at, squares.end());
  // Of a distance in the plane, at that share.
  const double share = (static_cast<double>(rank) + 0.5) / static_cast<double>(squares.size());
  const double expected = std::sqrt(-2 * std::log(1 - share));
  const double few = 1 + 5 / std::max(1.0, rows - freedoms);
  return std::isfinite(*at) ? std::max(1e-6, few * std::sqrt(*at) / expected) : 1e6;
}

struct Fit {
  CoregisterState state;
  Report report;
};

Fit SolveOnce(const Registry& types, const CoregisterData& data, const CoregisterState& state,
              const CoregisterUse& use, const CoregisterOptions& options, double scale,
              const Loss& loss) {
  const Graph graph = BuildCoregistration(types, data, state, use, options, scale, loss);
  Solution solution = Solve(graph, options.solve);
  return {ReadBackCoregistration(solution.values, state), std::move(solution.report)};
}

}  // namespace

std::vector<Eigen::Vector2d> PointResiduals(const CoregisterState& state,
                                            const std::vector<Correspondence>& points) {
  const CameraModel& model = CameraModelOf(state.camera.model);
  const Eigen::Isometry3d camera_from_lidar = IsometryOf(state.camera_from_lidar);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector2d> residuals;
  for (const Correspondence& point : points) {
    const Eigen::Vector3d in_camera = camera_from_lidar * Eigen::Vector3d(point.in_lidar.data());
    Eigen::Vector2d pixel(nan, nan);
    if (!model.project(state.camera.parameters.data(), in_camera.data(), pixel.data(), nullptr,
                       nullptr))
      pixel.setConstant(nan);
    residuals.push_back(pixel - Eigen::Vector2d(point.pixel.data()));
  }
  return residuals;
}

Graph BuildCoregistration(const Registry& types, const CoregisterData& data,
                          const CoregisterState& state, const CoregisterUse& use,
                          const CoregisterOptions& options, double scale, const Loss& loss) {
  const CameraModel& model = CameraModelOf(state.camera.model);
  const auto parameters = static_cast<std::size_t>(model.parameters);
  if (use.size() != data.points.size() + data.boards.size() ||
      (!options.free_parameters.empty() && options.free_parameters.size() != parameters) ||
      state.camera.parameters.size() != parameters)
    throw Error("a co-registration's state does not fit its data", ErrorKind::kUsage);
  Graph graph(types);
  const bool any_free = AnyFree(options);
  // With boards alone nothing is asked of the camera's parameters.
  const bool sees_points =
      std::any_of(use.begin(), use.begin() + static_cast<std::ptrdiff_t>(data.points.size()),
                  [](std::uint8_t counts) { return counts != 0; });
  if (sees_points) graph.Add(kCamera, model.variable, state.camera.parameters, !any_free);
  graph.Add(kExtrinsics, "se3/1", VectorOf(state.camera_from_lidar));
  if (any_free && sees_points) {
    // A row of zeros: not known at all.
    std::vector<double> information;
    for (std::size_t i = 0; i < parameters; ++i)
      for (std::size_t k = i; k < parameters; ++k) {
        const double held = kHeld * std::max(1.0, std::abs(state.camera.parameters[i]));
        information.push_back(i == k && !options.free_parameters[i] ? 1 / (held * held) : 0);
      }
    graph.Add(Factor{model.prior_factor,
                     {kCamera},
                     state.camera.parameters,
                     Noise::Information(information),
                     {},
                     "camera file"});
  }
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    if (!use[i]) continue;
    const Correspondence& point = data.points[i];
    const Eigen::Matrix2d information =
        (scale * scale * PixelCovariance(state, point, options)).inverse();
    Factor factor{model.point_factor,
                  {kCamera, kExtrinsics},
                  {},
                  Noise::Information(UpperTriangle(information)),
                  loss,
                  point.name};
    factor.measurement.assign(point.in_lidar.begin(), point.in_lidar.end());
    factor.measurement.insert(factor.measurement.end(), point.pixel.begin(), point.pixel.end());
    graph.Add(factor);
  }
  for (std::size_t i = 0; i < data.boards.size(); ++i) {
    if (!use[data.points.size() + i]) continue;
    const BoardSighting& board = data.boards[i];
    std::vector<double> measurement = VectorOf(board.camera_from_board);
    for (int k = 0; k < 3; ++k) measurement.push_back(board.normal_in_lidar[k]);
    measurement.push_back(board.offset_m);
    graph.Add(Factor{"board_plane/1",
                     {kExtrinsics},
                     measurement,
                     Noise::Sigmas({scale * options.sigma_tilt_rad, scale * options.sigma_tilt_rad,
                                    scale * options.sigma_m}),
                     loss,
                     board.name});
  }
  return graph;
}

CoregisterState ReadBackCoregistration(const Values& values, CoregisterState state) {
  if (values.Has(kCamera)) {
    const Span<const double> camera = values.At(kCamera);
    state.camera.parameters.assign(camera.begin(), camera.end());
  }
  const Span<const double> pose = values.At(kExtrinsics);
  std::copy(pose.begin(), pose.end(), state.camera_from_lidar.begin());
  return state;
}

Coregistration RefineCoregistration(const Registry& types, const CoregisterData& data,
                                    const CoregisterState& start,
                                    const CoregisterOptions& options) {
  const std::size_t count = data.points.size() + data.boards.size();
  Coregistration result;
  result.freedoms = 6 + CountFree(options);
  result.use.assign(count, 1);
  // Least squares begins with the camera as its file says: a few wrong points must not bend it.
  CoregisterOptions held = options;
  held.free_parameters.clear();

  CoregisterState state = start;
  const double rows = RowsOf(data, result.use);
  double scale = 1;
  // What the camera has no image of cannot be evaluated, and is off in any case.
  const auto visible = [&] {
    CoregisterUse use(count, 1);
    const std::vector<double> squares = SquaredDistances(data, state, options);
    for (std::size_t i = 0; i < count; ++i) use[i] = std::isfinite(squares[i]);
    return use;
  };
  // The least scale of all rounds (an MM-estimate, Yohai 1987): a fit that gives way to wrong data
  // has a larger one, and would believe them.
  if (!options.sigmas_are_known) scale = HUGE_VAL;
  for (int round = 0; round < 5; ++round) {
    if (!options.sigmas_are_known)
      scale =
          std::min(scale, ScaleOf(SquaredDistances(data, state, options), rows, result.freedoms));
    state = SolveOnce(types, data, state, visible(), held, scale, {LossKind::kCauchy, kCauchyScale})
                .state;
  }

  // What is not far off by the robust scale begins; then each datum is held against what the others
  // say, until they stay the same.
  double share = kFirstShare, kept = 1;
  CoregisterUse use = visible(), before;
  {
    const std::vector<CoregisterStatement> statements = StatementsOf(data, state, options);
    for (std::size_t i = 0; i < count; ++i)
      use[i] = statements[i].squared <=
               scale * scale * ChiSquareQuantile(1 - share, statements[i].is_board ? 3 : 2);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    // Too few are left to say more than the robust fit does.
    if (RowsOf(data, use) <= result.freedoms) use = visible();
    if (use == before) break;
    before = use;
    Fit fit = SolveOnce(types, data, state, use, options, scale, {});
    state = fit.state;
    result.report = std::move(fit.report);
    result.use = use;
    const std::vector<CoregisterStatement> statements = StatementsOf(data, state, options);
    kept = KeptVariance(statements, use, share);
    const double left = RowsOf(data, use) - result.freedoms;
    if (!options.sigmas_are_known && left > 0) {
      double sum = 0;
      for (std::size_t i = 0; i < count; ++i)
        if (use[i]) sum += statements[i].squared;
      scale = std::max(1e-6, std::sqrt(sum / left / kept));
    }
    const OutlierDecision decision =
        DecideOutliers(statements, use, result.freedoms, kept, options);
    use = decision.use;
    share = decision.share;
  }
  if (options.sigmas_are_known) scale = 1 / std::sqrt(kept);

  result.state = state;
  result.scale = scale;
  double squared = 0, points = 0;
  const std::vector<Eigen::Vector2d> residuals = PointResiduals(state, data.points);
  for (std::size_t i = 0; i < count; ++i) {
    if (!result.use[i]) result.outliers.push_back(i);
    if (!result.use[i] || i >= data.points.size()) continue;
    squared += residuals[i].squaredNorm();
    ++points;
  }
  result.rms_px = points > 0 ? std::sqrt(squared / points) : 0;

  const Graph graph = BuildCoregistration(types, data, state, result.use, options, scale);
  std::vector<Key> keys = {kExtrinsics};
  const bool any_free = AnyFree(options) && graph.Find(kCamera) != Layout::kNone;
  if (any_free) keys.push_back(kCamera);
  const auto marginals = ComputeMarginals(graph, graph.InitialValues(), keys);
  if (const auto* diagnosis = std::get_if<Diagnosis>(&marginals))
    throw Error("these data do not say where the camera is: " + diagnosis->summary,
                ErrorKind::kIllPosed);
  const auto& block = std::get<Marginals>(marginals);
  result.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(
      block.Covariance(kExtrinsics).data());
  if (any_free) {
    const std::vector<double>& camera = block.Covariance(kCamera);
    const std::size_t n = state.camera.parameters.size();
    for (std::size_t i = 0; i < n; ++i)
      if (options.free_parameters[i])
        result.free_deviations.push_back(std::sqrt(camera[i * n + i]));
  }
  const double left = RowsOf(data, result.use) - result.freedoms;
  result.region_95 = options.sigmas_are_known || left <= 0 ? ChiSquareQuantile(0.95, 6)
                                                           : 6 * FQuantile(0.95, 6, left);
  return result;
}

namespace {

// Angle [rad] between two poses, and distance [m] between their cameras.
std::pair<double, double> Apart(const Se3Array& a, const Se3Array& b) {
  const Eigen::Isometry3d between = IsometryOf(a).inverse() * IsometryOf(b);
  return {Eigen::AngleAxisd(between.linear()).angle(), between.translation().norm()};
}

// Sum of Cauchy's loss, which tells how well a pose explains all of the data.
double RobustCost(const CoregisterData& data, const CoregisterState& state,
                  const CoregisterOptions& options, double scale) {
  double cost = 0;
  const Loss loss{LossKind::kCauchy, kCauchyScale};
  for (const double square : SquaredDistances(data, state, options)) {
    double rho[3];
    EvaluateLoss(loss, std::min(square / (scale * scale), 1e12), rho);
    cost += rho[0];
  }
  return cost;
}

}  // namespace

Coregistration Coregister(const Registry& types, const CoregisterData& data,
                          const CameraIntrinsics& camera, const CoregisterOptions& options) {
  if (!(options.sigma_px > 0) || !(options.sigma_m >= 0) || !(options.sigma_tilt_rad > 0) ||
      (!data.boards.empty() && !(options.sigma_m > 0)))
    throw Error("standard deviations have to be above zero", ErrorKind::kUsage);
  const Camera checked(camera);
  CoregisterOptions held = options;
  held.free_parameters.clear();
  std::vector<Coregistration> found;
  for (const CoregisterStart& start : FindCoregisterStarts(data, checked, options))
    found.push_back(RefineCoregistration(types, data, {camera, start.camera_from_lidar}, held));
  std::size_t best = 0;
  const auto cost = [&](std::size_t i, double scale) {
    return RobustCost(data, found[i].state, options, scale);
  };
  for (std::size_t i = 1; i < found.size(); ++i)
    if (cost(i, found[best].scale) < cost(best, found[best].scale)) best = i;
  // Two answers that the data do not tell apart, by Fisher's test, are none.
  const double left = 2. * static_cast<double>(data.points.size()) +
                      3. * static_cast<double>(data.boards.size()) - 6;
  const double alike = options.sigmas_are_known ? ChiSquareQuantile(0.95, 1)
                                                : FQuantile(0.95, 1, std::max(1.0, left));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double scale = found[best].scale;
    const auto [angle, distance] =
        Apart(found[i].state.camera_from_lidar, found[best].state.camera_from_lidar);
    if (i == best || angle < 0.05 || cost(i, scale) - cost(best, scale) > alike) continue;
    throw Error("two poses of the camera explain these correspondences alike, " +
                    Shown(angle * 180 / M_PI) + " degrees and " + Shown(distance) +
                    " m apart: expected more of them, not in one plane",
                ErrorKind::kIllPosed);
  }
  if (!AnyFree(options)) return found[best];
  return RefineCoregistration(types, data, found[best].state, options);
}

}  // namespace graticule
