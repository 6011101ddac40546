#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "graticule/problems/calibration/calibrate.hpp"
#include "graticule/problems/calibration/state.hpp"

namespace graticule {

struct PosteriorOptions {
  double sigma_px = 0.1;  ///< of either coordinate of a corner
  BoardShape board = BoardShape::kFlat;
  double corner_sigma_m = 0;  ///< of a corner's place on the target; kFree only, above zero
  std::vector<CameraPrior> camera_priors;  ///< as CalibrationOptions
  /// A direction is not constrained if its standard deviation would move the corners seen by more
  /// than this, were its parameters alone to change; in image diagonals.
  double loose = 0.1;
};

/// Some of the numbers that a calibration estimates beside the target's poses.
struct PosteriorBlock {
  std::string key;  ///< as the graph says: "camera:0", "camera_from_rig:1", "warp:0", "corner:17"
  std::vector<std::string> fields;
  int offset = 0;
  int Size() const { return static_cast<int>(fields.size()); }
};

/// What the views say of cameras, rig and board, the target's poses marginalised (thesis, equations
/// 5.3 to 5.5).  A Gaussian around the state, in the graph's tangents.
struct Posterior {
  std::vector<PosteriorBlock> blocks;  ///< cameras, rig, warp, corners
  Eigen::MatrixXd information;
  /// Its inverse.  Where directions are not constrained, they have standard deviations of one image
  /// diagonal at most, in the sense of PosteriorOptions::loose.
  Eigen::MatrixXd covariance;
  /// What each number would have to change by, alone, to move a corner seen by an image diagonal.
  Eigen::VectorXd scales;
  /// "k4 of cam0": what takes part in directions that these views do not constrain, in order.
  std::vector<std::string> unconstrained;

  bool Constrained() const { return unconstrained.empty(); }
  /// Throws Error (kUsage): no such block.
  const PosteriorBlock& Block(const std::string& key) const;
  Eigen::MatrixXd Covariance(const std::string& key) const { return Covariance(key, key); }
  Eigen::MatrixXd Covariance(const std::string& a, const std::string& b) const;
  Eigen::MatrixXd OfCamera(std::size_t camera) const;      ///< its parameters'
  Eigen::MatrixXd OfExtrinsics(std::size_t camera) const;  ///< of camera_from_rig, [m, rad]
  /// Standard deviations, in order of the block's fields.
  std::vector<double> Deviations(const std::string& key) const;
};

/// By Schur complement from analytic Jacobians; O(corners (parameters + 6)^2).  Equal to
/// ComputeMarginals of the calibration's graph.  Views without a pose, corners that do not count
/// (`use`, which may be empty) and those without an image are left out.  Throws Error (kUsage):
/// a state that does not fit the detections, no sigma.
Posterior ComputePosterior(const Detections& detections, const CalibrationState& state,
                           const CornerUse& use, const PosteriorOptions& options);

/// "k4 of cam0 and cx of cam0 are not constrained by these views", or "".
std::string DescribeUnconstrained(const Posterior& posterior);

/// Covariance of an information matrix in which every variable has a scale: directions with a
/// standard deviation above `loose` scales are clamped to one scale at most.  `is_loose`, unless
/// null, gets one number a variable, true where it takes part in such a direction.
Eigen::MatrixXd ClampedInverse(const Eigen::MatrixXd& information, const Eigen::VectorXd& scales,
                               double loose, std::vector<bool>* is_loose);

}  // namespace graticule
