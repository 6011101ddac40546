#include "graticule/problems/pose_graph/odometry_tree.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {
namespace {

std::vector<double> RandomPose(bool planar, double angle, RandomNumbers* random) {
  std::vector<double> pose;
  for (int i = 0; i < (planar ? 2 : 3); ++i) pose.push_back(random->Uniform(-3, 3));
  if (planar) {
    pose.push_back(random->Uniform(-angle, angle));
    return pose;
  }
  const double rotation[3] = {random->Uniform(-angle, angle), random->Uniform(-angle, angle),
                              random->Uniform(-angle, angle)};
  pose.resize(7);
  QuaternionExp(rotation, pose.data() + 3);
  return pose;
}

// A tree of 40 poses whose branches begin anywhere and point either way.
Graph Branching(bool planar, std::vector<bool>* use) {
  RandomNumbers random(7);
  Graph graph(Builtins());
  const std::vector<double> origin =
      planar ? std::vector<double>{0, 0, 0} : std::vector<double>{0, 0, 0, 0, 0, 0, 1};
  std::vector<double> sigmas;
  for (int i = 0; i < (planar ? 3 : 6); ++i) sigmas.push_back(0.01 + 0.01 * i);
  for (std::uint64_t i = 0; i < 40; ++i) {
    graph.Add(Key("pose", i), planar ? "se2/1" : "se3/1", origin);
    if (i == 0) continue;
    const std::uint64_t from = i % 5 ? i - 1 : random.Below(i);
    Factor factor;
    factor.type = planar ? "between_se2/1" : "between_se3/1";
    factor.keys = {Key("pose", from), Key("pose", i)};
    if (i % 3 == 0) std::swap(factor.keys[0], factor.keys[1]);
    factor.measurement = RandomPose(planar, 1, &random);
    factor.noise = Noise::Sigmas(sigmas);
    graph.Add(factor);
  }
  use->assign(graph.FactorCount(), true);
  return graph;
}

// The way in the tree, factor by factor.
template <int kSize>
bool Walk(const Graph& graph, VariableId at, VariableId to, FactorId came_by,
          UncertainPose<kSize>* so_far) {
  if (at == to) return true;
  const UncertainPose<kSize> here = *so_far;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const auto ends = graph.FactorAt(id).variables;
    if (id == came_by || (ends[0] != at && ends[1] != at)) continue;
    UncertainPose<kSize> step;
    EXPECT_TRUE(MeasuredPoseOf<kSize>(graph.FactorAt(id), &step));
    if (ends[1] == at) step = Inverse<kSize>(step);
    *so_far = Product<kSize>(here, step);
    if (Walk<kSize>(graph, ends[0] == at ? ends[1] : ends[0], to, id, so_far)) return true;
  }
  return false;
}

template <int kSize>
void ExpectTheWaysOfTheTree() {
  std::vector<bool> use;
  const Graph graph = Branching(kSize == 3, &use);
  const OdometryTree<kSize> tree(graph, use);
  EXPECT_EQ(tree.TreeCount(), 1);
  for (VariableId a = 0; a < graph.VariableCount(); ++a)
    for (VariableId b = 0; b < graph.VariableCount(); ++b) {
      if (a == b) continue;
      UncertainPose<kSize> walked;
      std::fill(walked.pose, walked.pose + 7, 0.0);
      if (kSize == 6) walked.pose[6] = 1;
      walked.covariance.setZero();
      ASSERT_TRUE(Walk<kSize>(graph, a, b, 1000, &walked));
      const UncertainPose<kSize> found = tree.Between(a, b);
      double apart[7];
      Between(kSize == 3, walked.pose, found.pose, apart);
      for (int i = 0; i < kSize; ++i) EXPECT_NEAR(apart[i], 0, 1e-9);
      EXPECT_NEAR((found.covariance - walked.covariance).norm(), 0, 1e-9 * walked.covariance.norm())
          << a << " " << b;
    }
}

TEST(OdometryTree, SumsUncertaintyAlongTheWayInThePlane) { ExpectTheWaysOfTheTree<3>(); }
TEST(OdometryTree, SumsUncertaintyAlongTheWayInSpace) { ExpectTheWaysOfTheTree<6>(); }

// What "covariance of a small change on the right, in the frame of the pose seen" means.
TEST(OdometryTree, HasTheCovarianceOfDrawnMeasurements) {
  const double a_from_b[3] = {4, 1, 0.8}, b_from_c[3] = {2, -1, -1.9};
  UncertainPose<3> first, second;
  std::copy_n(a_from_b, 3, first.pose);
  std::copy_n(b_from_c, 3, second.pose);
  first.covariance = Eigen::Vector3d(1e-4, 4e-4, 9e-6).asDiagonal();
  second.covariance = Eigen::Vector3d(9e-4, 1e-4, 4e-6).asDiagonal();
  const UncertainPose<3> both = Product<3>(first, Inverse<3>(Inverse<3>(second)));
  RandomNumbers random(5);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto disturbed = [&](const UncertainPose<3>& pose, double* to) {
      double change[3];
      for (int i = 0; i < 3; ++i) change[i] = std::sqrt(pose.covariance(i, i)) * random.Normal();
      Compose(true, pose.pose, change, to);
    };
    double x[3], y[3], z[3];
    disturbed(first, x);
    disturbed(second, y);
    Compose(true, x, y, z);
    Eigen::Vector3d error;
    Between(true, both.pose, z, error.data());
    sum += error * error.transpose() / kDraws;
  }
  // A variance of n draws is off by sqrt(2 / n) of itself: 1 %.
  EXPECT_LT((sum - both.covariance).norm(), 0.04 * both.covariance.norm());
}

TEST(OdometryTree, LeavesOutWhatIsNotToBeUsedOrSaysTooLittle) {
  std::vector<bool> use;
  Graph graph = Branching(true, &use);
  use[10] = false;
  EXPECT_EQ(OdometryTree<3>(graph, use).TreeCount(), 2);
  EXPECT_EQ(OdometryTree<6>(graph, use).TreeCount(), 0);
  UncertainPose<3> pose;
  Factor blind = graph.FactorRecord(0);
  blind.noise = Noise::Information({1, 0, 0, 1, 0, 0});
  const FactorId id = graph.Add(blind);
  EXPECT_FALSE(MeasuredPoseOf<3>(graph.FactorAt(id), &pose));
}

}  // namespace
}  // namespace graticule
