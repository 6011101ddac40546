#include <cmath>

#include "graticule/problems/pose_graph/relaxation.hpp"

namespace graticule {

// The residual of a rotation as the factor states it: what couples with the translation's.
template <int kDim>
typename Relaxation<kDim>::Turn Relaxation<kDim>::TurnBetween(const FactorView& factor,
                                                              const double* measured,
                                                              const double* reached) {
  Turn turn;
  if constexpr (kPlanar) {
    turn[0] = WrapAngle(reached[2] - measured[2]);
  } else {
    double error[4];
    QuaternionInverseProduct(measured + 3, reached + 3, error);
    if (IsHalfAngle(factor.type->name))
      VectorPart::Evaluate(error, turn.data(), nullptr);
    else
      RotationVector::Evaluate(error, turn.data(), nullptr);
  }
  return turn;
}

// The normal equations.  Where every information is a multiple of one (`is_scalar`), the axes do
// not mix: one number a node, and a right-hand side an axis.
template <int kDim>
struct Relaxation<kDim>::Translations {
  BlockSystem* system;
  bool is_scalar;
  std::vector<double> rhs;
  std::size_t node_stride, axis_stride;

  Translations(BlockSystem* of, bool scalar, std::size_t nodes)
      : system(of),
        is_scalar(scalar),
        rhs(kDim * nodes),
        node_stride(scalar ? 1 : kDim),
        axis_stride(scalar ? nodes : 1) {
    system->Clear();
  }

  // The residual r, of information W, changes by `by` times the move of b less that of a.
  // `coupled`: what W adds to W r from components that no translation changes.
  void Add(int a, int b, std::optional<std::size_t> link, const Matrix& by, const Matrix& w,
           const Vector& residual, const Vector& coupled = Vector::Zero()) {
    const Vector pull = by.transpose() * (w * residual + coupled);
    const Matrix square = is_scalar ? w : Matrix(by.transpose() * w * by);
    if (b != kHeld) Move(b, square, -pull);
    if (a != kHeld) Move(a, square, pull);
    if (a == kHeld || b == kHeld) return;
    if (is_scalar)
      system->AddToLink(*link, Scalar(-square(0, 0)));
    else
      system->AddToLink(*link, Matrix(-square));
  }

  void Move(int node, const Matrix& square, const Vector& push) {
    if (is_scalar)
      system->AddToNode(node, Scalar(square(0, 0)));
    else
      system->AddToNode(node, square);
    for (std::size_t i = 0; i < kDim; ++i) At(static_cast<std::size_t>(node), i) += push[i];
  }

  double& At(std::size_t node, std::size_t axis) {
    return rhs[node * node_stride + axis * axis_stride];
  }

  bool Solve() { return system->Solve(&rhs, is_scalar ? kDim : 1); }
};

template <int kDim>
void Relaxation<kDim>::AddBetween(const Edge& edge, Translations* to) const {
  const int a = index_[edge.a], b = index_[edge.b];
  if (a == kHeld && b == kHeld) return;
  const FactorView factor = graph_.FactorAt(edge.factor);
  const Pose& measured = edge.measured;
  const Vector b_in_a = rotations_[edge.a].transpose() * (PointAt(edge.b) - PointAt(edge.a));
  const Matrix by = (rotations_[edge.a] * measured.rotation).transpose();
  const Vector residual = measured.rotation.transpose() * (b_in_a - measured.Translation());
  const Information w = InformationOfFactor(factor);
  const auto coupling = w.template topRightCorner<kDim, kTurn>();
  Vector coupled = Vector::Zero();
  if (!coupling.isZero(0)) {
    double reached[7];
    Between(kPlanar, PoseAt(edge.a).stored, PoseAt(edge.b).stored, reached);
    coupled = coupling * TurnBetween(factor, measured.stored, reached);
  }
  to->Add(a, b, edge.link, by, w.template topLeftCorner<kDim, kDim>(), residual, coupled);
}

template <int kDim>
void Relaxation<kDim>::AddPrior(const Prior& prior, Translations* to) const {
  if (index_[prior.pose] == kHeld) return;
  const FactorView factor = graph_.FactorAt(prior.factor);
  const Pose measured = PoseFrom(factor.measurement.data()), pose = PoseAt(prior.pose);
  double reached[7];
  if (RoleOf(prior.factor) == PoseRole::kPriorWithOffset)
    Compose(kPlanar, pose.stored, PoseFrom(factor.measurement.data() + 7).stored, reached);
  else
    std::copy_n(pose.stored, PoseSize(kPlanar), reached);
  const Matrix by = measured.rotation.transpose();
  const Information w = InformationOfFactor(factor);
  to->Add(kHeld, index_[prior.pose], {}, by, w.template topLeftCorner<kDim, kDim>(),
          by * (Eigen::Map<const Vector>(reached) - measured.Translation()),
          w.template topRightCorner<kDim, kTurn>() * TurnBetween(factor, measured.stored, reached));
}

// False where the factor does not say all of the point.
template <int kDim>
bool Relaxation<kDim>::Read(FactorId id, Sighting* sight) const {
  const FactorView factor = graph_.FactorAt(id);
  const double* measured = factor.measurement.data();
  constexpr double kNone[7] = {0, 0, 0, 0, 0, 0, 1};
  sight->body_from_sensor = PoseFrom(kNone);
  sight->pose = factor.variables[0];
  sight->landmark = factor.variables[1];
  sight->w = InformationOf<kDim>(factor.noise);
  sight->measured = Eigen::Map<const Vector>(measured);
  if (RoleOf(id) == PoseRole::kLandmarkWithOffset) {
    sight->body_from_sensor = PoseFrom(measured + kDim);
  } else if (RoleOf(id) == PoseRole::kBearingRange) {
    const double c = std::cos(measured[0]), s = std::sin(measured[0]), range = measured[1];
    if (!(range > 0)) return false;
    Matrix polar = Matrix::Zero();  // d (bearing, range) / d (x, y)
    polar.template topLeftCorner<2, 2>() << -s / range, c / range, c, s;
    sight->w = Matrix(polar.transpose() * sight->w * polar);
    sight->measured.template head<2>() << range * c, range * s;
  }
  return std::isfinite(TraceOfInverse(sight->w));
}

// Landmarks join in from where they were seen by one group of poses that agree on a frame.
template <int kDim>
std::vector<typename Relaxation<kDim>::Sighting> Relaxation<kDim>::JoinLandmarks() {
  std::vector<Sighting> sights;
  Sighting sight;
  for (const FactorId id : others_) {
    const PoseRole role = RoleOf(id);
    if (role == PoseRole::kPosition || role == PoseRole::kPriorPoint) continue;
    if (!Read(id, &sight)) continue;
    std::uint32_t& group = group_[sight.landmark];
    if (group == kNoGroup) {
      group = graph_.IsFixed(sight.landmark) ? kWorld : group_[sight.pose];
      if (!graph_.IsFixed(sight.landmark)) {
        index_[sight.landmark] = static_cast<int>(poses_.size() + landmarks_.size());
        landmarks_.push_back(sight.landmark);
      }
    }
    if (group == group_[sight.pose]) sights.push_back(sight);
  }
  return sights;
}

template <int kDim>
void Relaxation<kDim>::AddSighting(const Sighting& sight, std::optional<std::size_t> link,
                                   Translations* to) const {
  const Matrix& rotation = rotations_[sight.pose];
  const Pose& sensor = sight.body_from_sensor;
  const Vector in_body = rotation.transpose() * (PointAt(sight.landmark) - PointAt(sight.pose));
  to->Add(index_[sight.pose], index_[sight.landmark], link,
          (rotation * sensor.rotation).transpose(), sight.w,
          sensor.rotation.transpose() * (in_body - sensor.Translation()) - sight.measured);
}

// A place in the world, of a pose or a landmark.
template <int kDim>
void Relaxation<kDim>::AddPlace(FactorId id, Translations* to) const {
  const FactorView factor = graph_.FactorAt(id);
  const VariableId variable = factor.variables[0];
  if (group_[variable] != kWorld || index_[variable] == kHeld) return;
  const double* measured = factor.measurement.data();
  Vector residual = PointAt(variable) - Eigen::Map<const Vector>(measured);
  if (RoleOf(id) == PoseRole::kPosition && !kPlanar)
    residual += rotations_[variable] * Eigen::Map<const Vector>(measured + kDim);
  to->Add(kHeld, index_[variable], {}, Matrix::Identity(), InformationOf<kDim>(factor.noise),
          residual);
}

template <int kDim>
bool Relaxation<kDim>::SolveTranslations(BlockSystem* rotations) {
  const std::vector<Sighting> sights = JoinLandmarks();
  std::vector<std::pair<int, int>> links = links_;
  for (const Sighting& sight : sights)
    if (index_[sight.pose] != kHeld && index_[sight.landmark] != kHeld)
      links.emplace_back(index_[sight.pose], index_[sight.landmark]);
  const std::size_t nodes = poses_.size() + landmarks_.size();
  const bool is_scalar = isotropic_ && priors_.empty() && others_.empty();
  std::optional<BlockSystem> own;
  if (is_scalar)
    own.emplace(1, static_cast<int>(nodes), links, rotations);
  else if (!landmarks_.empty())
    own.emplace(kDim, static_cast<int>(nodes), links);
  Translations sum(own ? &*own : rotations, is_scalar, nodes);

  for (const Edge& edge : edges_) AddBetween(edge, &sum);
  for (const Prior& prior : priors_) AddPrior(prior, &sum);
  std::size_t link = links_.size();
  for (const Sighting& sight : sights) {
    AddSighting(sight, link, &sum);
    link += index_[sight.pose] != kHeld && index_[sight.landmark] != kHeld;
  }
  for (const FactorId id : others_)
    if (RoleOf(id) == PoseRole::kPosition || RoleOf(id) == PoseRole::kPriorPoint)
      AddPlace(id, &sum);
  if (!sum.Solve()) return false;
  const auto move = [&](std::size_t node) {
    Vector by;
    for (std::size_t i = 0; i < kDim; ++i) by[i] = sum.At(node, i);
    return by;
  };
  for (std::size_t i = 0; i < poses_.size(); ++i)
    Eigen::Map<Vector>(values_->Mutable(poses_[i])) += move(i);
  for (std::size_t i = 0; i < landmarks_.size(); ++i)
    placed_landmarks_.emplace_back(landmarks_[i], PointAt(landmarks_[i]) + move(poses_.size() + i));
  return true;
}

template bool Relaxation<2>::SolveTranslations(BlockSystem*);
template bool Relaxation<3>::SolveTranslations(BlockSystem*);

}  // namespace graticule
