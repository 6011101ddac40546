#include "graticule/problems/pose_graph/relaxation.hpp"

#include <cmath>

#include "graticule/problems/pose_graph/nearest_rotation.hpp"

namespace graticule {

template <int kDim>
Relaxation<kDim>::Relaxation(const Graph& graph, Values* values) : graph_(graph), values_(values) {
  const char* pose = kPlanar ? "se2/1" : "se3/1";
  for (const VariableType& type : graph.UsedVariableTypes())
    pose_type_.push_back(type.name == pose);
  for (const FactorType& type : graph.UsedFactorTypes()) roles_.push_back(RoleOf(type));
  if (std::find(pose_type_.begin(), pose_type_.end(), true) == pose_type_.end()) return;
  order_ = graph.KeyOrder();
  Collect();
  FindPieces();
}

template <int kDim>
bool Relaxation<kDim>::Run(ChordalReport* report) {
  report->kept_pieces += kept_;
  report->pieces += solved_;
  if (poses_.empty()) return true;
  BlockSystem system(kDim, static_cast<int>(poses_.size()), links_);
  std::vector<Pose> before;
  for (const VariableId id : poses_) before.push_back(PoseAt(id));
  if (!SolveRotations(&system) || !SolveTranslations(&system)) {
    for (std::size_t i = 0; i < poses_.size(); ++i) Write(poses_[i], before[i]);
    report->pieces -= solved_;
    report->kept_pieces += solved_;
    landmarks_.clear();
    return false;
  }
  report->poses += poses_.size();
  return true;
}

template <int kDim>
typename Relaxation<kDim>::Pose Relaxation<kDim>::PoseFrom(const double* given) {
  Pose pose;
  CopyPose(kPlanar, given, pose.stored);
  if constexpr (kPlanar) {
    const double c = std::cos(pose.stored[2]), s = std::sin(pose.stored[2]);
    pose.rotation << c, -s, s, c;
  } else {
    RowMajor<3, 3> rotation;
    QuaternionToMatrix(pose.stored + 3, rotation.data());
    pose.rotation = rotation;
  }
  return pose;
}

template <int kDim>
double Relaxation<kDim>::Kappa(const FactorView& factor, const Information& information) const {
  const double trace = TraceOfInverse(
      Eigen::Matrix<double, kTurn, kTurn>(information.template bottomRightCorner<kTurn, kTurn>()));
  const double whole_angle = IsHalfAngle(factor.type->name) ? 0.25 : 1;
  return std::isfinite(trace) ? whole_angle * kTurn / trace : 0;
}

template <int kDim>
void Relaxation<kDim>::Collect() {
  for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
    const PoseRole role = RoleOf(id);
    if (role == PoseRole::kOther) continue;
    const FactorView factor = graph_.FactorAt(id);
    if (role == PoseRole::kBetween) {
      const Information information = InformationOfFactor(factor);
      Edge edge{id, factor.variables[0], factor.variables[1], PoseFrom(factor.measurement.data())};
      edge.kappa = Kappa(factor, information);
      const Matrix w = information.template topLeftCorner<kDim, kDim>();
      edge.is_whole = edge.kappa > 0 && std::isfinite(TraceOfInverse(w));
      isotropic_ = isotropic_ && w == Matrix(w(0, 0) * Matrix::Identity());
      edges_.push_back(edge);
    } else if (role == PoseRole::kPrior || role == PoseRole::kPriorWithOffset) {
      priors_.push_back({id, factor.variables[0], 0});
    } else {
      others_.push_back(id);
    }
  }
}

// Sorts poses into pieces, decides which are held, and numbers the others in key order.
template <int kDim>
void Relaxation<kDim>::FindPieces() {
  std::vector<PoseTie> ties;
  for (const Edge& edge : edges_) ties.push_back({edge.a, edge.b, edge.is_whole});
  std::vector<PoseAnchor> anchors;
  for (Prior& prior : priors_) {
    const FactorView factor = graph_.FactorAt(prior.factor);
    const Information information = InformationOfFactor(factor);
    prior.kappa = Kappa(factor, information);
    const Matrix w = information.template topLeftCorner<kDim, kDim>();
    anchors.push_back({prior.pose, prior.kappa > 0 && std::isfinite(TraceOfInverse(w))});
  }
  PosePieces pieces = FindPosePieces(graph_, order_, pose_type_, ties, anchors);
  index_ = std::move(pieces.index);
  group_ = std::move(pieces.group);
  poses_ = std::move(pieces.poses);
  solved_ = pieces.solved;
  kept_ = pieces.kept;
  for (Edge& edge : edges_) {
    edge.link = links_.size();
    if (index_[edge.a] != kHeld && index_[edge.b] != kHeld)
      links_.emplace_back(index_[edge.a], index_[edge.b]);
  }
}

// --- rotations
template <int kDim>
bool Relaxation<kDim>::SolveRotations(BlockSystem* system) {
  rotations_.resize(graph_.VariableCount());
  for (const VariableId id : order_)
    if (IsPose(id)) rotations_[id] = PoseAt(id).rotation;
  // The rows of R stand as columns: kappa |x_b - R_ab' x_a|^2 each, x the change from the tree's.
  const int size = kDim * static_cast<int>(poses_.size());
  std::vector<double> rhs(static_cast<std::size_t>(size * kRows));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kRows>> x(rhs.data(), size, kRows);
  const auto add = [&](int node, double kappa, const Matrix& right) {
    system->AddToNode(node, Matrix(kappa * Matrix::Identity()));
    x.template middleRows<kDim>(kDim * node) += kappa * right.template leftCols<kRows>();
  };
  for (const Edge& edge : edges_) {
    const int a = index_[edge.a], b = index_[edge.b];
    if (edge.kappa == 0 || (a == kHeld && b == kHeld)) continue;
    const Matrix& turn = edge.measured.rotation;
    const Matrix missing = (rotations_[edge.a] * turn - rotations_[edge.b]).transpose();
    if (a != kHeld) add(a, edge.kappa, -turn * missing);
    if (b != kHeld) add(b, edge.kappa, missing);
    if (a != kHeld && b != kHeld) system->AddToLink(edge.link, Matrix(-edge.kappa * turn));
  }
  for (const Prior& prior : priors_) {
    const int node = index_[prior.pose];
    if (prior.kappa == 0 || node == kHeld) continue;
    const FactorView factor = graph_.FactorAt(prior.factor);
    Matrix rotation = PoseFrom(factor.measurement.data()).rotation;
    if (RoleOf(prior.factor) == PoseRole::kPriorWithOffset)
      rotation = rotation * PoseFrom(factor.measurement.data() + 7).rotation.transpose();
    add(node, prior.kappa, (rotation - rotations_[prior.pose]).transpose());
  }
  if (!system->Solve(&rhs, kRows)) return false;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    Matrix& rotation = rotations_[poses_[i]];
    Matrix relaxed = rotation;
    relaxed.template topRows<kRows>() +=
        x.template middleRows<kDim>(kDim * static_cast<int>(i)).transpose();
    double* pose = values_->Mutable(poses_[i]);
    if constexpr (kPlanar) {
      pose[2] = WrapAngle(std::atan2(-relaxed(0, 1), relaxed(0, 0)));
      const double norm = std::hypot(relaxed(0, 0), relaxed(0, 1));
      if (!(norm > 0)) return false;
      relaxed /= norm;
      rotation << relaxed(0, 0), relaxed(0, 1), -relaxed(0, 1), relaxed(0, 0);
    } else {
      NearestRotation(relaxed, pose + 3);
      rotation = PoseAt(poses_[i]).rotation;
    }
  }
  return true;
}

template class Relaxation<2>;
template class Relaxation<3>;

}  // namespace graticule
