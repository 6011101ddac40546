#include "graticule/problems/calibration/posterior_sums.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "graticule/factors/camera_model.hpp"
#include "graticule/solver/noise.hpp"

namespace graticule {
namespace {

std::vector<std::string> FieldNames(const char* fields) {
  std::istringstream words(fields);
  std::vector<std::string> names;
  for (std::string word; words >> word;) names.push_back(word.substr(0, word.find(':')));
  return names;
}

bool Counts(const CornerUse& use, std::size_t view, std::size_t corner) {
  return use.empty() || use[view].empty() || use[view][corner];
}

}  // namespace

PosteriorPlaces PlaceUnknowns(const Detections& detections, const CalibrationState& state,
                              const PosteriorOptions& options,
                              std::vector<PosteriorBlock>* blocks) {
  PosteriorPlaces places;
  const auto add = [&](std::string key, std::vector<std::string> fields) {
    const int at = places.size;
    places.size += static_cast<int>(fields.size());
    blocks->push_back({std::move(key), std::move(fields), at});
    return at;
  };
  for (std::size_t c = 0; c < state.cameras.size(); ++c)
    places.cameras.push_back(add("camera:" + std::to_string(c),
                                 FieldNames(CameraModelOf(state.cameras[c].model).fields)));
  places.extrinsics.push_back(-1);
  for (std::size_t c = 1; c < state.cameras.size(); ++c)
    places.extrinsics.push_back(
        add("camera_from_rig:" + std::to_string(c), {"x", "y", "z", "rx", "ry", "rz"}));
  if (options.board == BoardShape::kWarped) places.warp = add("warp:0", {"xx", "yy", "xy"});
  if (options.board == BoardShape::kFree) {
    std::set<int> ids;
    for (const TargetView& view : detections.views)
      for (const DetectedCorner& corner : view.corners) ids.insert(corner.id);
    for (const int id : ids)
      places.corners[id] = add("corner:" + std::to_string(id), {"x", "y", "z"});
  }
  return places;
}

PosteriorSums::PosteriorSums(const Detections& detections, const CalibrationState& state,
                             const CornerUse& use, const PosteriorOptions& options,
                             const PosteriorPlaces& places)
    : information(Eigen::MatrixXd::Zero(places.size, places.size)),
      gradient(Eigen::VectorXd::Zero(places.size)),
      largest(Eigen::VectorXd::Zero(places.size)),
      detections_(detections),
      state_(state),
      use_(use),
      options_(options),
      places_(places),
      of_exposure_(state.rig_from_target.size()) {
  for (std::size_t i = 0; i < detections.views.size(); ++i)
    of_exposure_[detections.views[i].exposure].push_back(i);
}

void PosteriorSums::Whiten() {
  const double squared = options_.sigma_px * options_.sigma_px;
  information /= squared;
  gradient /= squared;
}

void PosteriorSums::AddPriors() {
  for (std::size_t c = 0; c < options_.camera_priors.size(); ++c)
    AddPrior(options_.camera_priors[c].noise, c);
  for (const auto& [id, at] : places_.corners)
    for (int i = 0; i < 3; ++i)
      information(at + i, at + i) += 1 / (options_.corner_sigma_m * options_.corner_sigma_m);
}

void PosteriorSums::AddPrior(const Noise& noise, std::size_t camera) {
  const int size = CameraModelOf(state_.cameras[camera].model).parameters;
  CheckNoise(noise.View(), size);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> root =
      Eigen::MatrixXd::Identity(size, size);
  Whitener(noise.View(), size).Apply(root.data(), size, size, size);
  information.block(places_.cameras[camera], places_.cameras[camera], size, size) +=
      root.transpose() * root;
}

bool PosteriorSums::AddExposure(std::size_t exposure) {
  if (!state_.rig_from_target[exposure]) return false;
  pose_.setZero();
  pose_gradient_.setZero();
  by_others_.setZero(6, places_.size);
  std::set<int> touched;
  for (const std::size_t view : of_exposure_[exposure]) AddView(view, &touched);
  const std::vector<int> active(touched.begin(), touched.end());
  Eigen::MatrixXd by_active(6, active.size());
  for (std::size_t i = 0; i < active.size(); ++i) by_active.col(i) = by_others_.col(active[i]);
  const Eigen::MatrixXd share = PoseShare(pose_, by_active);
  for (std::size_t j = 0; j < active.size(); ++j)
    for (std::size_t i = 0; i < active.size(); ++i)
      information(active[i], active[j]) -= share(i, j);
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(pose_);
  if (factor.info() == Eigen::Success) {
    const Eigen::VectorXd loss = by_active.transpose() * factor.solve(pose_gradient_);
    for (std::size_t i = 0; i < active.size(); ++i) gradient[active[i]] -= loss[i];
  }
  return true;
}

void PosteriorSums::AddView(std::size_t index, std::set<int>* touched) {
  const TargetView& view = detections_.views[index];
  const CameraIntrinsics& camera = state_.cameras[view.camera];
  ViewInformation sums(CameraModelOf(camera.model),
                       {places_.extrinsics[view.camera] >= 0, places_.warp >= 0});
  sums.Start(camera.parameters.data(), IsometryOf(state_.camera_from_rig[view.camera]),
             IsometryOf(*state_.rig_from_target[view.exposure]));
  // Column of the view to unknown; the pose's, -1.
  std::vector<int> to(sums.Size(), -1);
  for (int i = 0; i < sums.PoseAt(); ++i) to[i] = places_.cameras[view.camera] + i;
  if (places_.extrinsics[view.camera] >= 0)
    for (int i = 0; i < 6; ++i) to[sums.ExtrinsicsAt() + i] = places_.extrinsics[view.camera] + i;
  if (places_.warp >= 0)
    for (int i = 0; i < 3; ++i) to[sums.WarpAt() + i] = places_.warp + i;

  const std::vector<Eigen::Vector2d> residuals = ViewResiduals(state_, view);
  bool any = false;
  std::vector<double> largest(sums.Size());
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    if (!Counts(use_, index, i) || !sums.Add(PlaceOf(state_, view.corners[i]))) continue;
    any = true;
    const auto rows = sums.Rows();
    for (int k = 0; k < sums.Size(); ++k)
      largest[k] = std::max(largest[k], std::max(std::abs(rows(0, k)), std::abs(rows(1, k))));
    for (int k = 0; k < sums.Size(); ++k)
      if (to[k] >= 0) gradient[to[k]] += rows.col(k).dot(residuals[i]);
    pose_gradient_ += rows.middleCols<6>(sums.PoseAt()).transpose() * residuals[i];
    if (!places_.corners.empty())
      AddCorner(places_.corners.at(view.corners[i].id), sums, to, residuals[i], touched);
  }
  if (!any) return;
  const Eigen::MatrixXd all = sums.Sums();
  pose_ += all.block<6, 6>(sums.PoseAt(), sums.PoseAt());
  for (int j = 0; j < sums.Size(); ++j) {
    if (to[j] < 0) continue;
    touched->insert(to[j]);
    this->largest[to[j]] = std::max(this->largest[to[j]], largest[j]);
    by_others_.col(to[j]) += all.block<6, 1>(sums.PoseAt(), j);
    for (int i = 0; i < sums.Size(); ++i)
      if (to[i] >= 0) information(to[i], to[j]) += all(i, j);
  }
}

void PosteriorSums::AddCorner(int at, const ViewInformation& sums, const std::vector<int>& to,
                              const Eigen::Vector2d& residual, std::set<int>* touched) {
  const Eigen::Matrix<double, 2, 3> j = sums.ByTarget();
  information.block<3, 3>(at, at) += j.transpose() * j;
  gradient.segment<3>(at) += j.transpose() * residual;
  const Eigen::Matrix<double, 3, Eigen::Dynamic> cross = j.transpose() * sums.Rows();
  by_others_.middleCols<3>(at) += cross.middleCols<6>(sums.PoseAt()).transpose();
  for (int i = 0; i < 3; ++i) touched->insert(at + i);
  for (int k = 0; k < sums.Size(); ++k)
    if (to[k] >= 0)
      for (int i = 0; i < 3; ++i) {
        information(at + i, to[k]) += cross(i, k);
        information(to[k], at + i) += cross(i, k);
      }
}

}  // namespace graticule
