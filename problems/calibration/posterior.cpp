#include "graticule/problems/calibration/posterior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "graticule/problems/calibration/view_information.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/noise.hpp"

namespace graticule {
namespace {

std::vector<std::string> FieldNames(const char* fields) {
  std::istringstream words(fields);
  std::vector<std::string> names;
  for (std::string word; words >> word;) names.push_back(word.substr(0, word.find(':')));
  return names;
}

// Where each variable is among the unknowns; -1: not estimated.
struct Places {
  std::vector<int> cameras, extrinsics;
  int warp = -1;
  std::map<int, int> corners;
  int size = 0;
};

bool Counts(const CornerUse& use, std::size_t view, std::size_t corner) {
  return use.empty() || use[view].empty() || use[view][corner];
}

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

Places PlaceAll(const Detections& detections, const CalibrationState& state,
                const PosteriorOptions& options, std::vector<PosteriorBlock>* blocks) {
  Places places;
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

// The sums of all views, exposure by exposure.
class Sums {
 public:
  Sums(const Detections& detections, const CalibrationState& state, const CornerUse& use,
       const PosteriorOptions& options, const Places& places)
      : detections_(detections), state_(state), use_(use), options_(options), places_(places) {
    information_ = Eigen::MatrixXd::Zero(places.size, places.size);
    largest_ = Eigen::VectorXd::Zero(places.size);
    std::vector<std::vector<std::size_t>> of_exposure(state.rig_from_target.size());
    for (std::size_t i = 0; i < detections.views.size(); ++i)
      of_exposure[detections.views[i].exposure].push_back(i);
    for (std::size_t e = 0; e < of_exposure.size(); ++e)
      if (state.rig_from_target[e]) AddExposure(of_exposure[e]);
    information_ /= options.sigma_px * options.sigma_px;
    for (std::size_t c = 0; c < options.camera_priors.size(); ++c)
      AddPrior(options.camera_priors[c].noise, c);
    for (const auto& [id, at] : places.corners)
      for (int i = 0; i < 3; ++i)
        information_(at + i, at + i) += 1 / (options.corner_sigma_m * options.corner_sigma_m);
  }

  Eigen::MatrixXd information_;
  Eigen::VectorXd largest_;  ///< [px a unit], of the corners seen

 private:
  void AddPrior(const Noise& noise, std::size_t camera) {
    const int size = CameraModelOf(state_.cameras[camera].model).parameters;
    CheckNoise(noise.View(), size);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> root =
        Eigen::MatrixXd::Identity(size, size);
    Whitener(noise.View(), size).Apply(root.data(), size, size, size);
    information_.block(places_.cameras[camera], places_.cameras[camera], size, size) +=
        root.transpose() * root;
  }

  void AddExposure(const std::vector<std::size_t>& views) {
    pose_.setZero();
    by_others_.setZero(6, places_.size);
    std::set<int> touched;
    for (const std::size_t view : views) AddView(view, &touched);
    const std::vector<int> active(touched.begin(), touched.end());
    Eigen::MatrixXd by_active(6, active.size());
    for (std::size_t i = 0; i < active.size(); ++i) by_active.col(i) = by_others_.col(active[i]);
    const Eigen::MatrixXd share = PoseShare(pose_, by_active);
    for (std::size_t j = 0; j < active.size(); ++j)
      for (std::size_t i = 0; i < active.size(); ++i)
        information_(active[i], active[j]) -= share(i, j);
  }

  void AddView(std::size_t index, std::set<int>* touched) {
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

    bool any = false;
    std::vector<double> largest(sums.Size());
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      if (!Counts(use_, index, i) || !sums.Add(PlaceOf(state_, view.corners[i]))) continue;
      any = true;
      const auto rows = sums.Rows();
      for (int k = 0; k < sums.Size(); ++k)
        largest[k] = std::max(largest[k], std::max(std::abs(rows(0, k)), std::abs(rows(1, k))));
      if (!places_.corners.empty())
        AddCorner(places_.corners.at(view.corners[i].id), sums, to, touched);
    }
    if (!any) return;
    const Eigen::MatrixXd all = sums.Sums();
    pose_ += all.block<6, 6>(sums.PoseAt(), sums.PoseAt());
    for (int j = 0; j < sums.Size(); ++j) {
      if (to[j] < 0) continue;
      touched->insert(to[j]);
      largest_[to[j]] = std::max(largest_[to[j]], largest[j]);
      by_others_.col(to[j]) += all.block<6, 1>(sums.PoseAt(), j);
      for (int i = 0; i < sums.Size(); ++i)
        if (to[i] >= 0) information_(to[i], to[j]) += all(i, j);
    }
  }

  void AddCorner(int at, const ViewInformation& sums, const std::vector<int>& to,
                 std::set<int>* touched) {
    const Eigen::Matrix<double, 2, 3> j = sums.ByTarget();
    information_.block<3, 3>(at, at) += j.transpose() * j;
    const Eigen::Matrix<double, 3, Eigen::Dynamic> cross = j.transpose() * sums.Rows();
    by_others_.middleCols<3>(at) += cross.middleCols<6>(sums.PoseAt()).transpose();
    for (int i = 0; i < 3; ++i) touched->insert(at + i);
    for (int k = 0; k < sums.Size(); ++k)
      if (to[k] >= 0)
        for (int i = 0; i < 3; ++i) {
          information_(at + i, to[k]) += cross(i, k);
          information_(to[k], at + i) += cross(i, k);
        }
  }

  const Detections& detections_;
  const CalibrationState& state_;
  const CornerUse& use_;
  const PosteriorOptions& options_;
  const Places& places_;
  Eigen::Matrix<double, 6, 6> pose_;
  Eigen::MatrixXd by_others_;
};

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
  const Places places = PlaceAll(detections, state, options, &posterior.blocks);
  Sums sums(detections, state, use, options, places);
  posterior.information = std::move(sums.information_);

  // One unit of scale moves a corner by an image diagonal.
  double diagonal = 0;
  for (const CameraIntrinsics& camera : state.cameras)
    diagonal = std::max(diagonal, std::hypot(camera.width, camera.height));
  Eigen::VectorXd& scales = posterior.scales;
  scales.resize(places.size);
  for (int i = 0; i < places.size; ++i)
    scales[i] = sums.largest_[i] > 0 ? diagonal / sums.largest_[i] : 1;
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
