#pragma once

// Internal to co-registration: what each correspondence and board says at a state, and which of
// them are outliers.

#include <Eigen/Core>
#include <vector>

#include "graticule/problems/segmentation/coregister.hpp"

namespace graticule {

/// A point or a board, at a state.
struct CoregisterStatement {
  bool is_board = false;
  Eigen::VectorXd residual;    ///< predicted - measured, whitened: unit covariance at scale one
  Eigen::MatrixXd by_numbers;  ///< of the whitened residual: the extrinsics' tangent, then the free
                               ///< parameters of the camera
  double squared = 0;          ///< of the residual; infinite where the camera has no image
};

/// Covariance [px^2] of where a point is seen, the LIDAR's error included, at scale one.
Eigen::Matrix2d PixelCovariance(const CoregisterState& state, const Correspondence& point,
                                const CoregisterOptions& options);

/// Points first, then boards.
std::vector<CoregisterStatement> StatementsOf(const CoregisterData& data,
                                              const CoregisterState& state,
                                              const CoregisterOptions& options);

/// What is left of a variance where only data count that are exceeded by more than `share` of
/// right ones: E[x | x <= gate] / E[x] of chi-square's x, which is F_(k+2)(gate) / F_k(gate).
double KeptVariance(const std::vector<CoregisterStatement>& statements, const CoregisterUse& use,
                    double share);

/// Who of `use` and of the others is an outlier by the prediction of the rest.
struct OutlierDecision {
  CoregisterUse use;
  /// Right ones are as far off as what was named last: in this share.  Of none: as the next would
  /// have to be.
  double share = 0;
};

/// Each datum is held against what the others of `use` predict: the residual of a point left out
/// has covariance s^2 (I + H), that of a fitted one s^2 (I - H), with the leverage H and the s of
/// those others (externally studentised; Cook and Weisberg 1982).  Its length is Fisher's, or
/// chi-square's where the noise is given.
///
/// So many are named that of the named ones `options.outlier_share` may be right (Benjamini and
/// Hochberg 1995: the k farthest, where right ones are as far off as the k-th in a share of at most
/// k / n of it).  `numbers`: how many are estimated; `kept`: what is left of the variance of right
/// ones in `use`.
OutlierDecision DecideOutliers(const std::vector<CoregisterStatement>& statements,
                               const CoregisterUse& use, int numbers, double kept,
                               const CoregisterOptions& options);

}  // namespace graticule
