#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule::test {

enum class Reading { kPlane, kQuaternion, kAngle };

inline int ResidualSize(Reading reading) { return reading == Reading::kPlane ? 3 : 6; }

inline double Cost(const Graph& graph, const Values& values) {
  double cost = 0;
  for (const double chi2 : FactorChi2(graph, values)) cost += 0.5 * chi2;
  return cost;
}

/// Anywhere, turned anyhow.
inline std::vector<double> AnyPose(Reading reading, double size_m, RandomNumbers* random) {
  std::vector<double> pose;
  for (int i = 0; i < (reading == Reading::kPlane ? 2 : 3); ++i)
    pose.push_back(random->Uniform(-size_m, size_m));
  if (reading == Reading::kPlane) {
    pose.push_back(random->Uniform(-3.14, 3.14));
    return pose;
  }
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q[i] = random->Normal();
  q.normalize();
  pose.insert(pose.end(), q.data(), q.data() + 4);
  return pose;
}

/// The upper triangle of a positive definite matrix.  `coupling`: of what is translation with what
/// is not, 0 none, 1 as it comes.  `spread`: of the square roots of its eigenvalues.
inline std::vector<double> AnyInformation(int size, int translation, double coupling, double spread,
                                          RandomNumbers* random) {
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) root(i, j) = random->Normal();
  for (int i = 0; i < size; ++i) root.row(i) *= std::pow(spread, random->Unit());
  Eigen::MatrixXd w = root * root.transpose() + 0.3 * Eigen::MatrixXd::Identity(size, size);
  w.topRightCorner(translation, size - translation) *= coupling;
  std::vector<double> upper;
  for (int i = 0; i < size; ++i)
    for (int j = i; j < size; ++j) upper.push_back(w(i, j));
  return upper;
}

inline const char* PoseType(Reading reading) {
  return reading == Reading::kPlane ? "se2/1" : "se3/1";
}
inline const char* BetweenType(Reading reading) {
  if (reading == Reading::kPlane) return "between_se2/1";
  return reading == Reading::kAngle ? "between_se3/1" : "between_se3_quaternion/1";
}

}  // namespace graticule::test
