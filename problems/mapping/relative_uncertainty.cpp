#include "graticule/problems/mapping/relative_uncertainty.hpp"

#include <algorithm>
#include <functional>

#include "graticule/problems/mapping/pose_noise.hpp"

namespace graticule {

RelativeUncertainty::RelativeUncertainty(std::size_t poses, const std::vector<UncertainEdge>& edges)
    : edges_(edges), first_(poses + 1), arcs_(2 * edges.size()) {
  for (const UncertainEdge& edge : edges_) ++first_[edge.a + 1], ++first_[edge.b + 1];
  for (std::size_t i = 1; i <= poses; ++i) first_[i] += first_[i - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    arcs_[next[edges_[i].a]++] = {edges_[i].b, i, true};
    arcs_[next[edges_[i].b]++] = {edges_[i].a, i, false};
  }
  covariance_.resize(poses);
}

void RelativeUncertainty::From(std::uint32_t source, const std::vector<PlanarPose>& poses) {
  is_reached_.assign(covariance_.size(), 0);
  is_done_.assign(covariance_.size(), 0);
  heap_.clear();
  covariance_[source].setZero();
  is_reached_[source] = 1;
  heap_.emplace_back(0, source);
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
    const std::uint32_t at = heap_.back().second;
    heap_.pop_back();
    if (is_done_[at]) continue;
    is_done_[at] = 1;
    for (std::uint32_t k = first_[at]; k < first_[at + 1]; ++k) {
      const Arc& arc = arcs_[k];
      if (is_done_[arc.to]) continue;
      const PlanarPose to_from_at = Inverse(poses[arc.to]) * poses[at];
      const Eigen::Matrix3d carry = Adjoint(to_from_at);
      const Eigen::Matrix3d& own = edges_[arc.edge].covariance;
      // That of the edge is in its b's frame.
      Eigen::Matrix3d sum = carry * covariance_[at] * carry.transpose();
      if (arc.forward)
        sum += own;
      else
        sum.noalias() += carry * own * carry.transpose();
      const double size = sum(0, 0) + sum(1, 1);
      if (is_reached_[arc.to] && covariance_[arc.to](0, 0) + covariance_[arc.to](1, 1) <= size)
        continue;
      covariance_[arc.to] = sum;
      is_reached_[arc.to] = 1;
      heap_.emplace_back(size, arc.to);
      std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
    }
  }
}

}  // namespace graticule
