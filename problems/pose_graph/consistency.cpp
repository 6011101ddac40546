#include "graticule/problems/pose_graph/consistency.hpp"

#include <Eigen/Cholesky>
#include <map>
#include <string>
#include <utility>

#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/clique.hpp"
#include "graticule/problems/pose_graph/odometry_tree.hpp"
#include "graticule/problems/pose_graph/pose_role.hpp"
#include "graticule/problems/pose_graph/transform.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {
namespace {

template <int kSize>
struct Closure {
  std::size_t suspect;  // position
  VariableId a, b;      // a in the earlier tree; within one tree, the earlier pose
  UncertainPose<kSize> a_from_b, b_from_a;
};

// Squared Mahalanobis distance of what two closures say of one pose.
template <int kSize>
double Disagreement(const OdometryTree<kSize>& tree, const Closure<kSize>& first,
                    const Closure<kSize>& second) {
  constexpr bool kPlanar = kSize == 3;
  // The second's b, seen from the first's a, both ways round.
  const auto over_first = Product<kSize>(first.a_from_b, tree.Between(first.b, second.b));
  const auto over_second = Product<kSize>(tree.Between(first.a, second.a), second.a_from_b);
  double apart[7];
  Between(kPlanar, over_second.pose, over_first.pose, apart);
  Eigen::Matrix<double, kSize, 1> error;
  if constexpr (kPlanar) {
    error << apart[0], apart[1], apart[2];
  } else {
    error.template head<3>() << apart[0], apart[1], apart[2];
    QuaternionLog(apart + 3, error.data() + 3);
  }
  const Eigen::Matrix<double, kSize, kSize> covariance =
      over_first.covariance + over_second.covariance;
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> root(covariance);
  return root.matrixL().solve(error).squaredNorm();
}

template <class T>
void Thin(std::size_t count, std::vector<T>* list) {
  for (std::size_t i = 0; i < count; ++i) (*list)[i] = (*list)[i * list->size() / count];
  list->resize(count);
}

template <int kSize>
void Check(const Graph& graph, const std::vector<FactorId>& suspects,
           const ConsistencyOptions& options, ConsistencyResult* result) {
  std::vector<bool> use(graph.FactorCount(), true);
  for (const FactorId id : suspects) use[id] = false;
  const OdometryTree<kSize> tree(graph, use);
  result->trees += static_cast<std::size_t>(tree.TreeCount());
  std::vector<VariableId> rank(graph.VariableCount());
  VariableId next = 0;
  for (const VariableId id : graph.KeyOrder()) rank[id] = next++;

  std::map<std::pair<int, int>, std::vector<Closure<kSize>>> groups;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    const FactorView factor = graph.FactorAt(suspects[i]);
    Closure<kSize> closure;
    if (PoseRoleOf(factor.type->name) != PoseRole::kBetween ||
        graph.ResidualSize(suspects[i]) != kSize ||
        !MeasuredPoseOf<kSize>(factor, &closure.a_from_b))
      continue;
    closure.suspect = i;
    closure.a = factor.variables[0];
    closure.b = factor.variables[1];
    const auto place = [&](VariableId id) { return std::pair(tree.TreeOf(id), rank[id]); };
    closure.b_from_a = Inverse<kSize>(closure.a_from_b);
    if (place(closure.b) < place(closure.a)) {
      std::swap(closure.a, closure.b);
      std::swap(closure.a_from_b, closure.b_from_a);
    }
    const std::pair<int, int> trees(tree.TreeOf(closure.a), tree.TreeOf(closure.b));
    --result->unchecked;
    if (trees.first == trees.second && options.only_between_trees) continue;
    groups[trees].push_back(closure);
    result->is_kept[i] = false;
  }
  const double limit =
      ChiSquareQuantile(options.quantile, kSize) * options.noise_scale * options.noise_scale;
  for (auto& [trees, closures] : groups) {
    if (options.thin_to > 0 && closures.size() > options.thin_to) Thin(options.thin_to, &closures);
    if (closures.size() > kMostConsistent)
      throw Error(std::to_string(closures.size()) +
                      " closures between the same poses are too many to be compared pair by pair "
                      "(at most " +
                      std::to_string(kMostConsistent) + "): take gnc_tls",
                  ErrorKind::kUsage);
    Compatibility agree(closures.size());
    for (std::size_t i = 0; i < closures.size(); ++i)
      for (std::size_t j = i + 1; j < closures.size(); ++j)
        if (Disagreement<kSize>(tree, closures[i], closures[j]) <= limit) agree.Set(i, j);
    const Clique clique = FindLargestClique(agree);
    for (const std::uint32_t member : clique.members)
      result->is_kept[closures[member].suspect] = true;
    ++result->groups;
    result->unproven += !clique.is_largest;
  }
}

}  // namespace

ConsistencyResult FindConsistent(const Graph& graph, const std::vector<FactorId>& suspects,
                                 const ConsistencyOptions& options) {
  ConsistencyResult result;
  result.is_kept.assign(suspects.size(), true);
  result.unchecked = suspects.size();
  Check<3>(graph, suspects, options, &result);
  Check<6>(graph, suspects, options, &result);
  return result;
}

std::vector<int> OdometryTrees(const Graph& graph, const std::vector<FactorId>& suspects) {
  std::vector<bool> use(graph.FactorCount(), true);
  for (const FactorId id : suspects) use[id] = false;
  const OdometryTree<3> plane(graph, use);
  const OdometryTree<6> space(graph, use);
  std::vector<int> tree(graph.VariableCount(), -1);
  for (VariableId id = 0; id < tree.size(); ++id) {
    if (plane.TreeOf(id) >= 0) tree[id] = plane.TreeOf(id);
    if (space.TreeOf(id) >= 0) tree[id] = plane.TreeCount() + space.TreeOf(id);
  }
  return tree;
}

}  // namespace graticule
