#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "graticule/factors/make.hpp"
#include "graticule/io/correspondences.hpp"
#include "graticule/problems/calibration/camera.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/options.hpp"
#include "graticule/solver/report.hpp"

namespace graticule {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A board whose plane a LIDAR measured and whose pose a camera saw.
struct BoardSighting {
  std::string name;
  Se3Array camera_from_board = {0, 0, 0, 0, 0, 0, 1};  ///< the board is its plane z = 0
  Eigen::Vector3d normal_in_lidar;                     ///< unit, either way round
  double offset_m = 0;                                 ///< normal . p = offset
};

struct CoregisterOptions {
  /// Standard deviations of what was measured: of a pixel on either axis, and of a LIDAR's point
  /// on any.  A near point's error is many pixels: the two are added at each point's depth.
  double sigma_px = 1, sigma_m = 0.02;
  /// Whether these are right.  Else only their ratio is used, and the residuals say how large they
  /// are.
  bool sigmas_are_known = false;
  double sigma_tilt_rad = 0.01;  ///< of a board's plane against its pose in the camera
  /// Of the correspondences that are named as outliers this share may be right ones; where none is
  /// wrong, one is named in this share of sets.  A larger one names more that are a little wrong,
  /// and the 95 % region becomes too small.
  double outlier_share = 0.01;
  /// One a parameter of the camera: estimated, not taken from its file.  Empty: none.
  std::vector<std::uint8_t> free_parameters;
  std::uint64_t seed = 1;  ///< of the start's samples, where there are too many to try all
  SolveOptions solve;
};

/// What co-registration estimates.
struct CoregisterState {
  CameraIntrinsics camera;
  Se3Array camera_from_lidar = {0, 0, 0, 0, 0, 0, 1};
};

struct CoregisterData {
  std::vector<Correspondence> points;
  std::vector<BoardSighting> boards;
};

/// Which of the data count: one a point, then one a board.
using CoregisterUse = std::vector<std::uint8_t>;

/// The graph: `camera:0` (fixed, unless parameters are free), `camera_from_lidar:0`, a
/// point_reprojection_MODEL/1 each correspondence that counts and a board_plane/1 each board, named
/// by their sources.  The noise is the options' at the state's depths, times `scale`; the loss is
/// every factor's.
Graph BuildCoregistration(const Registry& types, const CoregisterData& data,
                          const CoregisterState& state, const CoregisterUse& use,
                          const CoregisterOptions& options, double scale, const Loss& loss = {});

/// The state that a graph's values say.
CoregisterState ReadBackCoregistration(const Values& values, CoregisterState state);

/// Predicted - seen [px] of every correspondence; NaN where the camera has no image of it.
std::vector<Eigen::Vector2d> PointResiduals(const CoregisterState& state,
                                            const std::vector<Correspondence>& points);

/// A solved co-registration.
struct Coregistration {
  CoregisterState state;
  CoregisterUse use;                  ///< 0: named as an outlier
  std::vector<std::size_t> outliers;  ///< into points, then boards; in order
  /// Of camera_from_lidar's tangent: translation [m] and rotation [rad], in the LIDAR's frame.
  Matrix6 covariance = Matrix6::Zero();
  /// The 95 % region of the extrinsics: e' covariance^-1 e up to this, with e the tangent.
  double region_95 = 0;
  /// Of the parameters that are free, in the order of the camera's parameters.
  std::vector<double> free_deviations;
  int freedoms = 0;   ///< estimated numbers
  double scale = 1;   ///< the options' standard deviations times this are the residuals'
  double rms_px = 0;  ///< of the distances of the points that count
  Report report;      ///< of the last solve
};

/// Extrinsics from correspondences and boards, without a start (coregister_start.hpp): Cauchy's
/// loss first, then least squares on those that are not far off, until they stay the same.
/// Deterministic.
///
/// Throws Error (kIllPosed) where the data do not say one answer: too few, on a line, two poses
/// that explain them alike, none that explains most of them, a mirrored frame; (kUsage) options or
/// a camera that do not fit.
Coregistration Coregister(const Registry& types, const CoregisterData& data,
                          const CameraIntrinsics& camera, const CoregisterOptions& options = {});

/// The same from a start, without a search.
Coregistration RefineCoregistration(const Registry& types, const CoregisterData& data,
                                    const CoregisterState& start, const CoregisterOptions& options);

}  // namespace graticule
