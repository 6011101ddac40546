#include "graticule/problems/pose_graph/odometry_tree.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "graticule/problems/pose_graph/information.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/transform.hpp"

namespace graticule {
namespace {

template <int kSize>
using Matrix = Eigen::Matrix<double, kSize, kSize>;

constexpr bool IsPlanar(int size) { return size == 3; }

// The adjoint: a small change at b, as one at a.  Tangent order translation, rotation.
template <int kSize>
Matrix<kSize> AdjointOf(const double* a_from_b) {
  Matrix<kSize> adjoint = Matrix<kSize>::Zero();
  if constexpr (IsPlanar(kSize)) {
    const double c = std::cos(a_from_b[2]), s = std::sin(a_from_b[2]);
    adjoint << c, -s, a_from_b[1], s, c, -a_from_b[0], 0, 0, 1;
  } else {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation;
    QuaternionToMatrix(a_from_b + 3, rotation.data());
    Eigen::Matrix3d cross;
    cross << 0, -a_from_b[2], a_from_b[1], a_from_b[2], 0, -a_from_b[0], -a_from_b[1], a_from_b[0],
        0;
    adjoint.template topLeftCorner<3, 3>() = rotation;
    adjoint.template bottomRightCorner<3, 3>() = rotation;
    adjoint.template topRightCorner<3, 3>().noalias() = cross * rotation;
  }
  return adjoint;
}

// The covariance at b, of a change at a.
template <int kSize>
Matrix<kSize> Moved(const double* a_from_b, const Matrix<kSize>& covariance_at_b) {
  const Matrix<kSize> adjoint = AdjointOf<kSize>(a_from_b);
  return adjoint * covariance_at_b * adjoint.transpose();
}

}  // namespace

template <int kSize>
bool MeasuredPoseOf(const FactorView& factor, UncertainPose<kSize>* a_from_b) {
  Matrix<kSize> information = InformationOf<kSize>(factor.noise);
  if (!IsPlanar(kSize) && IsHalfAngle(factor.type->name)) {
    information.template rightCols<kSize / 2>() /= 2;
    information.template bottomRows<kSize / 2>() /= 2;
  }
  const Eigen::LLT<Matrix<kSize>> root(information);
  if (root.info() != Eigen::Success) return false;
  a_from_b->covariance = root.solve(Matrix<kSize>::Identity());
  if (!a_from_b->covariance.allFinite()) return false;
  CopyPose(IsPlanar(kSize), factor.measurement.data(), a_from_b->pose);
  return true;
}

template <int kSize>
UncertainPose<kSize> Inverse(const UncertainPose<kSize>& a_from_b) {
  UncertainPose<kSize> b_from_a;
  Invert(IsPlanar(kSize), a_from_b.pose, b_from_a.pose);
  b_from_a.covariance = Moved<kSize>(a_from_b.pose, a_from_b.covariance);
  return b_from_a;
}

template <int kSize>
UncertainPose<kSize> Product(const UncertainPose<kSize>& a_from_b,
                             const UncertainPose<kSize>& b_from_c) {
  UncertainPose<kSize> a_from_c;
  double c_from_b[7];
  Compose(IsPlanar(kSize), a_from_b.pose, b_from_c.pose, a_from_c.pose);
  Invert(IsPlanar(kSize), b_from_c.pose, c_from_b);
  a_from_c.covariance = Moved<kSize>(c_from_b, a_from_b.covariance) + b_from_c.covariance;
  return a_from_c;
}

template <int kSize>
OdometryTree<kSize>::OdometryTree(const Graph& graph, const std::vector<bool>& use)
    : tree_(graph.VariableCount(), -1),
      depth_(graph.VariableCount()),
      parent_(graph.VariableCount()),
      jump_(graph.VariableCount()),
      root_from_pose_(graph.VariableCount()) {
  struct Branch {
    VariableId other;
    FactorId factor;
    bool is_a;  // this end is the factor's a
  };
  std::vector<std::vector<Branch>> branches(graph.VariableCount());
  UncertainPose<kSize> measured;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    if (!use[id] || PoseRoleOf(factor.type->name) != PoseRole::kBetween ||
        graph.ResidualSize(id) != kSize || !MeasuredPoseOf<kSize>(factor, &measured))
      continue;
    branches[factor.variables[0]].push_back({factor.variables[1], id, true});
    branches[factor.variables[1]].push_back({factor.variables[0], id, false});
  }
  const char* const type = IsPlanar(kSize) ? "se2/1" : "se3/1";
  std::vector<VariableId> queue;
  for (const VariableId root : graph.KeyOrder()) {
    if (tree_[root] >= 0 || graph.TypeOf(root).name != type) continue;
    tree_[root] = trees_;
    parent_[root] = jump_[root] = root;
    double* identity = root_from_pose_[root].pose;
    std::fill(identity, identity + 7, 0.0);
    if (!IsPlanar(kSize)) identity[6] = 1;
    root_from_pose_[root].covariance.setZero();
    queue.assign(1, root);
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const VariableId from = queue[head];
      for (const Branch& branch : branches[from]) {
        const VariableId to = branch.other;
        if (tree_[to] >= 0) continue;
        MeasuredPoseOf<kSize>(graph.FactorAt(branch.factor), &measured);
        if (!branch.is_a) measured = Inverse<kSize>(measured);
        UncertainPose<kSize>& placed = root_from_pose_[to];
        Compose(IsPlanar(kSize), root_from_pose_[from].pose, measured.pose, placed.pose);
        placed.covariance =
            root_from_pose_[from].covariance + Moved<kSize>(placed.pose, measured.covariance);
        tree_[to] = trees_;
        parent_[to] = from;
        depth_[to] = depth_[from] + 1;
        // Myers: An applicative random-access stack, 1983.  Two jumps of one length make a longer.
        const VariableId far = jump_[from];
        jump_[to] =
            depth_[from] - depth_[far] == depth_[far] - depth_[jump_[far]] ? jump_[far] : from;
        queue.push_back(to);
      }
    }
    ++trees_;
  }
}

template <int kSize>
VariableId OdometryTree<kSize>::CommonAncestor(VariableId a, VariableId b) const {
  if (depth_[a] < depth_[b]) std::swap(a, b);
  while (depth_[a] > depth_[b]) a = depth_[jump_[a]] >= depth_[b] ? jump_[a] : parent_[a];
  while (a != b) {
    if (jump_[a] != jump_[b]) {
      a = jump_[a];
      b = jump_[b];
    } else {
      a = parent_[a];
      b = parent_[b];
    }
  }
  return a;
}

template <int kSize>
UncertainPose<kSize> OdometryTree<kSize>::Between(VariableId a, VariableId b) const {
  const VariableId above = CommonAncestor(a, b);
  const Matrix sum = root_from_pose_[a].covariance + root_from_pose_[b].covariance -
                     2 * root_from_pose_[above].covariance;
  UncertainPose<kSize> a_from_b;
  graticule::Between(IsPlanar(kSize), root_from_pose_[a].pose, root_from_pose_[b].pose,
                     a_from_b.pose);
  double b_from_root[7];
  Invert(IsPlanar(kSize), root_from_pose_[b].pose, b_from_root);
  a_from_b.covariance = Moved<kSize>(b_from_root, sum);
  return a_from_b;
}

template bool MeasuredPoseOf<3>(const FactorView&, UncertainPose<3>*);
template bool MeasuredPoseOf<6>(const FactorView&, UncertainPose<6>*);
template UncertainPose<3> Inverse<3>(const UncertainPose<3>&);
template UncertainPose<6> Inverse<6>(const UncertainPose<6>&);
template UncertainPose<3> Product<3>(const UncertainPose<3>&, const UncertainPose<3>&);
template UncertainPose<6> Product<6>(const UncertainPose<6>&, const UncertainPose<6>&);
template class OdometryTree<3>;
template class OdometryTree<6>;

}  // namespace graticule
