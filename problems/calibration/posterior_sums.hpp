#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <vector>

#include "graticule/problems/calibration/posterior.hpp"
#include "graticule/problems/calibration/view_information.hpp"

namespace graticule {

/// Where each variable is among the unknowns of a posterior; -1: not estimated.
struct PosteriorPlaces {
  std::vector<int> cameras, extrinsics;
  int warp = -1;
  std::map<int, int> corners;
  int size = 0;
};

/// The unknowns in their order; fills `blocks`.
PosteriorPlaces PlaceUnknowns(const Detections& detections, const CalibrationState& state,
                              const PosteriorOptions& options, std::vector<PosteriorBlock>* blocks);

/// Information and gradient of views, the target's poses eliminated, for pixel noise of 1: add
/// exposures, then look.
class PosteriorSums {
 public:
  PosteriorSums(const Detections& detections, const CalibrationState& state, const CornerUse& use,
                const PosteriorOptions& options, const PosteriorPlaces& places);

  /// False, and nothing added, where the exposure has no pose.
  bool AddExposure(std::size_t exposure);
  /// Divides by the noise.
  void Whiten();
  /// What was known before any view.
  void AddPriors();

  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;  ///< J' (predicted - measured)
  Eigen::VectorXd largest;   ///< [px a unit], of the corners seen

 private:
  void AddPrior(const Noise& noise, std::size_t camera);
  void AddView(std::size_t index, std::set<int>* touched);
  void AddCorner(int at, const ViewInformation& sums, const std::vector<int>& to,
                 const Eigen::Vector2d& residual, std::set<int>* touched);

  const Detections& detections_;
  const CalibrationState& state_;
  const CornerUse& use_;
  const PosteriorOptions& options_;
  const PosteriorPlaces& places_;
  std::vector<std::vector<std::size_t>> of_exposure_;
  Eigen::Matrix<double, 6, 6> pose_;
  Eigen::Matrix<double, 6, 1> pose_gradient_;
  Eigen::MatrixXd by_others_;
};

}  // namespace graticule
