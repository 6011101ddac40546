#include "graticule/problems/calibration/posterior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "graticule/problems/calibration/posterior_sums.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

void Check(const Detections& detections, const CalibrationState& state, const CornerUse& use,
           const PosteriorOptions& options) {
  const auto refuse = [](const char* why) {
    throw Error(std::string("posterior: ") + why, ErrorKind::kUsage);
  };
  if (!(options.sigma_px > 0)) refuse("expected a sigma above zero");
  if (options.board == BoardShape::kFree && !(options.corner_sigma_m > 0))
    refuse("expected a sigma of free corners above zero");
  if (options.camera_priors.size() > state.cameras.size()) refuse("more priors than cameras");
  if (state.camera_from_rig.size() != state.cameras.size())
    refuse("expected a place on the rig for every camera");
  if (!use.empty() && use.size() != detections.views.size())
    refuse("expected the use of every view's corners");
  for (std::size_t i = 0; i < detections.views.size(); ++i) {
    const TargetView& view = detections.views[i];
    if (view.camera >= state.cameras.size()) refuse("a view of a camera that the state lacks");
    if (view.exposure >= state.rig_from_target.size())
      refuse("a view of an exposure that the state lacks");
    if (!use.empty() && !use[i].empty() && use[i].size() != view.corners.size())
      refuse("expected the use of every corner of a view");
  }
}

}  // namespace

Eigen::MatrixXd ClampedInverse(const Eigen::MatrixXd& information, const Eigen::VectorXd& scales,
                               double loose, std::vector<bool>* is_loose) {
  const Eigen::Index size = information.rows();
  const Eigen::MatrixXd scaled = scales.asDiagonal() * information * scales.asDiagonal();
  const double least = 1 / (loose * loose);
  if (is_loose) is_loose->assign(size, false);
  // No eigenvalue is below `least` exactly if what is left without it has a Cholesky factor.
  if (const Eigen::LLT<Eigen::MatrixXd> above(scaled -
                                              least * Eigen::MatrixXd::Identity(size, size));
      above.info() == Eigen::Success) {
    const Eigen::MatrixXd inverse = scaled.llt().solve(Eigen::MatrixXd::Identity(size, size));
    return scales.asDiagonal() * ((inverse + inverse.transpose()) / 2) * scales.asDiagonal();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::VectorXd inverse(size), share = Eigen::VectorXd::Zero(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double value = eigen.eigenvalues()[i];
    inverse[i] = 1 / (value < least ? std::max(value, 1.) : value);
    if (value < least) share += inverse[i] * eigen.eigenvectors().col(i).cwiseAbs2();
  }
  if (is_loose)
    for (Eigen::Index i = 0; i < size; ++i)
      (*is_loose)[i] = share[i] > 0 && share[i] >= 0.25 * share.maxCoeff();
  const Eigen::MatrixXd turned = scales.asDiagonal() * eigen.eigenvectors();
  return turned * inverse.asDiagonal() * turned.transpose();
}

const PosteriorBlock& Posterior::Block(const std::string& key) const {
  for (const PosteriorBlock& block : blocks)
    if (block.key == key) return block;
  throw Error("posterior: nothing is estimated of " + key, ErrorKind::kUsage);
}

Eigen::MatrixXd Posterior::Covariance(const std::string& a, const std::string& b) const {
  const PosteriorBlock &row = Block(a), &column = Block(b);
  return covariance.block(row.offset, column.offset, row.Size(), column.Size());
}

Eigen::MatrixXd Posterior::OfCamera(std::size_t camera) const {
  return Covariance("camera:" + std::to_string(camera));
}

Eigen::MatrixXd Posterior::OfExtrinsics(std::size_t camera) const {
  return Covariance("camera_from_rig:" + std::to_string(camera));
}

std::vector<double> Posterior::Deviations(const std::string& key) const {
  const Eigen::VectorXd variances = Covariance(key).diagonal();
  std::vector<double> deviations;
  for (const double variance : variances) deviations.push_back(std::sqrt(std::max(0., variance)));
  return deviations;
}

Posterior ComputePosterior(const Detections& detections, const CalibrationState& state,
                           const CornerUse& use, const PosteriorOptions& options) {
  Check(detections, state, use, options);
  Posterior posterior;
  const PosteriorPlaces places = PlaceUnknowns(detections, state, options, &posterior.blocks);
  PosteriorSums sums(detections, state, use, options, places);
  for (std::size_t e = 0; e < state.rig_from_target.size(); ++e) sums.AddExposure(e);
  sums.Whiten();
  sums.AddPriors();
  posterior.information = std::move(sums.information);

  // One unit of scale moves a corner by an image diagonal.
  double diagonal = 0;
  for (const CameraIntrinsics& camera : state.cameras)
    diagonal = std::max(diagonal, std::hypot(camera.width, camera.height));
  Eigen::VectorXd& scales = posterior.scales;
  scales.resize(places.size);
  for (int i = 0; i < places.size; ++i)
    scales[i] = sums.largest[i] > 0 ? diagonal / sums.largest[i] : 1;
  for (const auto& [id, at] : places.corners)
    scales.segment<3>(at).setConstant(2 * options.corner_sigma_m / options.loose);

  std::vector<bool> is_loose;
  posterior.covariance = ClampedInverse(posterior.information, scales, options.loose, &is_loose);
  for (const PosteriorBlock& block : posterior.blocks)
    for (int i = 0; i < block.Size(); ++i) {
      if (!is_loose[block.offset + i]) continue;
      std::string of = block.key;
      for (std::size_t c = 0; c < state.cameras.size(); ++c)
        if (!state.cameras[c].name.empty() && block.key == "camera:" + std::to_string(c))
          of = state.cameras[c].name;
      posterior.unconstrained.push_back(block.fields[i] + " of " + of);
    }
  return posterior;
}

std::string DescribeUnconstrained(const Posterior& posterior) {
  const std::vector<std::string>& names = posterior.unconstrained;
  if (names.empty()) return "";
  std::string text = names[0];
  for (std::size_t i = 1; i < names.size(); ++i)
    text += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return text + (names.size() == 1 ? " is" : " are") + " not constrained by these views";
}

}  // namespace graticule
