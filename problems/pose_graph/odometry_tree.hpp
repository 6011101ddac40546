#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// A pose seen from another, and how certain that is: covariance [x y yaw] or [x y z rotation
/// vector] of a small change on the right, in the frame of the pose that is seen.
template <int kSize>
struct UncertainPose {
  double pose[7];
  Eigen::Matrix<double, kSize, kSize> covariance;
};

/// A between factor's measurement as such; its rotation's uncertainty is of the whole angle.  False
/// where it does not say all of a pose (a component was not measured).
template <int kSize>
bool MeasuredPoseOf(const FactorView& factor, UncertainPose<kSize>* a_from_b);

/// inverse, with the covariance in the frame of the other end.
template <int kSize>
UncertainPose<kSize> Inverse(const UncertainPose<kSize>& a_from_b);

/// a_from_b * b_from_c, of independent errors, to first order.
template <int kSize>
UncertainPose<kSize> Product(const UncertainPose<kSize>& a_from_b,
                             const UncertainPose<kSize>& b_from_c);

/// A spanning forest of between factors (breadth first from the smallest keys), and over it any
/// pose from any other of the same tree, in logarithmic time however long the way.
/// kSize 3: the poses of the plane; 6: those in space.
template <int kSize>
class OdometryTree {
 public:
  /// `use`: by factor, whether it may be a branch.  The graph must outlive the tree.
  OdometryTree(const Graph& graph, const std::vector<bool>& use);

  /// The tree that a pose is in, from 0; -1: it is no pose of this kind.
  int TreeOf(VariableId id) const { return tree_[id]; }
  int TreeCount() const { return trees_; }

  /// b seen from a, along the tree.  To first order in the noise: covariances are summed in the
  /// tree's frame, where the sum along a way is the difference of two sums from the root.
  UncertainPose<kSize> Between(VariableId a, VariableId b) const;

 private:
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  VariableId CommonAncestor(VariableId a, VariableId b) const;

  int trees_ = 0;
  std::vector<int> tree_;
  std::vector<std::uint32_t> depth_;
  std::vector<VariableId> parent_, jump_;  // jump: an ancestor far above, for quick ascent
  std::vector<UncertainPose<kSize>> root_from_pose_;  // covariance: in the root's frame
};

extern template class OdometryTree<3>;
extern template class OdometryTree<6>;

}  // namespace graticule
