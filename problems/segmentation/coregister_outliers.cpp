#include "graticule/problems/segmentation/coregister_outliers.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "graticule/factors/camera_model.hpp"
#include "graticule/factors/lie.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/f_quantile.hpp"

namespace graticule {
namespace {

// Of a fitted point's residual, as a share of its noise: less is no check of the point.
constexpr double kLeastCheck = 1e-6;

CoregisterStatement StatementOf(const Correspondence& point, const Eigen::Vector2d& residual,
                                const CoregisterState& state, const CoregisterOptions& options) {
  CoregisterStatement statement;
  const Eigen::Isometry3d camera_from_lidar = IsometryOf(state.camera_from_lidar);
  const Eigen::Vector3d in_lidar(point.in_lidar.data());
  const Eigen::Vector3d in_camera = camera_from_lidar * in_lidar;
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  const auto count = static_cast<Eigen::Index>(state.camera.parameters.size());
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor> by_camera(2, count);
  const bool is_seen = CameraModelOf(state.camera.model)
                           .project(state.camera.parameters.data(), in_camera.data(), pixel.data(),
                                    by_point.data(), by_camera.data());
  if (!is_seen || !residual.allFinite()) {
    statement.squared = HUGE_VAL;
    return statement;
  }
  const auto free = std::count_if(options.free_parameters.begin(), options.free_parameters.end(),
                                  [](std::uint8_t is_free) { return is_free != 0; });
  Eigen::MatrixXd by_numbers(2, 6 + free);
  by_numbers.leftCols<3>() = by_point * camera_from_lidar.linear();
  by_numbers.middleCols<3>(3) = -by_numbers.leftCols<3>() * Skew(in_lidar);
  Eigen::Index column = 6;
  for (Eigen::Index p = 0; p < count && free > 0; ++p)
    if (options.free_parameters[static_cast<std::size_t>(p)] != 0)
      by_numbers.col(column++) = by_camera.col(p);
  const Eigen::LLT<Eigen::Matrix2d> root(PixelCovariance(state, point, options));
  statement.residual = root.matrixL().solve(residual);
  statement.by_numbers = root.matrixL().solve(by_numbers);
  statement.squared = statement.residual.squaredNorm();
  return statement;
}

CoregisterStatement StatementOf(const BoardSighting& board, const CoregisterState& state,
                                const CoregisterOptions& options) {
  CoregisterStatement statement;
  statement.is_board = true;
  const Eigen::Isometry3d camera_from_lidar = IsometryOf(state.camera_from_lidar);
  const Eigen::Isometry3d camera_from_board = IsometryOf(board.camera_from_board);
  const Eigen::Vector3d normal = camera_from_lidar.linear() * board.normal_in_lidar;
  const Eigen::Vector3d off = camera_from_board.translation() - camera_from_lidar.translation();
  // As board_plane/1 has it.
  const Eigen::Matrix3d turned = -camera_from_lidar.linear() * Skew(board.normal_in_lidar);
  const auto sides = camera_from_board.linear().leftCols<2>().transpose();
  Eigen::Vector3d residual;
  residual << sides * normal, normal.dot(off) - board.offset_m;
  const auto free = std::count_if(options.free_parameters.begin(), options.free_parameters.end(),
                                  [](std::uint8_t is_free) { return is_free != 0; });
  Eigen::MatrixXd by_numbers = Eigen::MatrixXd::Zero(3, 6 + free);
  by_numbers.block<2, 3>(0, 3) = sides * turned;
  by_numbers.block<1, 3>(2, 0) = -board.normal_in_lidar.transpose();
  by_numbers.block<1, 3>(2, 3) = off.transpose() * turned;
  const Eigen::Vector3d weights(1 / options.sigma_tilt_rad, 1 / options.sigma_tilt_rad,
                                1 / options.sigma_m);
  statement.residual = weights.asDiagonal() * residual;
  statement.by_numbers = weights.asDiagonal() * by_numbers;
  statement.squared = statement.residual.squaredNorm();
  return statement;
}

double DimensionOf(const CoregisterStatement& statement) { return statement.is_board ? 3 : 2; }

}  // namespace

Eigen::Matrix2d PixelCovariance(const CoregisterState& state, const Correspondence& point,
                                const CoregisterOptions& options) {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity() * (options.sigma_px * options.sigma_px);
  const Eigen::Vector3d in_camera =
      IsometryOf(state.camera_from_lidar) * Eigen::Vector3d(point.in_lidar.data());
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
  if (CameraModelOf(state.camera.model)
          .project(state.camera.parameters.data(), in_camera.data(), pixel.data(), by_point.data(),
                   nullptr))
    covariance += options.sigma_m * options.sigma_m * by_point * by_point.transpose();
  return covariance;
}

std::vector<CoregisterStatement> StatementsOf(const CoregisterData& data,
                                              const CoregisterState& state,
                                              const CoregisterOptions& options) {
  std::vector<CoregisterStatement> statements;
  const std::vector<Eigen::Vector2d> residuals = PointResiduals(state, data.points);
  for (std::size_t i = 0; i < data.points.size(); ++i)
    statements.push_back(StatementOf(data.points[i], residuals[i], state, options));
  for (const BoardSighting& board : data.boards)
    statements.push_back(StatementOf(board, state, options));
  return statements;
}

double KeptVariance(const std::vector<CoregisterStatement>& statements, const CoregisterUse& use,
                    double share) {
  double kept = 0, rows = 0;
  for (std::size_t i = 0; i < use.size(); ++i) {
    if (!use[i]) continue;
    const double k = DimensionOf(statements[i]), gate = ChiSquareQuantile(1 - share, k);
    kept += k * ChiSquareShare(gate, k + 2) / ChiSquareShare(gate, k);
    rows += k;
  }
  return rows > 0 ? kept / rows : 1;
}

OutlierDecision DecideOutliers(const std::vector<CoregisterStatement>& statements,
                               const CoregisterUse& use, int numbers, double kept,
                               const CoregisterOptions& options) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(numbers, numbers);
  double sum = 0, rows = 0;
  for (std::size_t i = 0; i < use.size(); ++i) {
    if (!use[i]) continue;
    const Eigen::MatrixXd& by = statements[i].by_numbers;
    information += by.transpose() * by;
    sum += statements[i].squared;
    rows += DimensionOf(statements[i]);
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  std::vector<double> shares;  // of right ones that are as far off
  for (std::size_t i = 0; i < use.size(); ++i) {
    const CoregisterStatement& statement = statements[i];
    if (!std::isfinite(statement.squared)) {
      shares.push_back(0);
      continue;
    }
    const double k = DimensionOf(statement);
    const Eigen::MatrixXd& by = statement.by_numbers;
    const Eigen::MatrixXd leverage = by * solver.solve(by.transpose());
    const Eigen::MatrixXd covariance =
        Eigen::MatrixXd::Identity(by.rows(), by.rows()) + (use[i] ? -1. : 1.) * leverage;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of(covariance);
    double share = 1;
    if (of.eigenvalues().minCoeff() > kLeastCheck) {
      const double squared = (of.eigenvectors().transpose() * statement.residual)
                                 .cwiseAbs2()
                                 .cwiseQuotient(of.eigenvalues())
                                 .sum();
      const double left = rows - numbers - (use[i] ? k : 0);
      if (options.sigmas_are_known) {
        share = 1 - ChiSquareShare(squared, k);
      } else if (left > 0) {
        const double others = std::max(sum - (use[i] ? squared : 0), 1e-12);
        share = FExceeded(squared / k * kept / (others / left), k, left);
      }
    }
    shares.push_back(share);
  }
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shares[a] < shares[b]; });
  const double one = options.outlier_share / static_cast<double>(shares.size());
  std::size_t named = 0;
  for (std::size_t k = 1; k <= order.size(); ++k)
    if (shares[order[k - 1]] <= one * static_cast<double>(k)) named = k;
  OutlierDecision decision{CoregisterUse(shares.size(), 1), 0};
  for (std::size_t k = 0; k < named; ++k) decision.use[order[k]] = 0;
  decision.share = one * static_cast<double>(std::max<std::size_t>(named, 1));
  return decision;
}

}  // namespace graticule
