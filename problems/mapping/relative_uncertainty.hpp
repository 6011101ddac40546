#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graticule/io/planar_pose.hpp"

namespace graticule {

/// How well pose b is known from pose a.
struct UncertainEdge {
  std::uint32_t a = 0, b = 0;
  Eigen::Matrix3d covariance;  ///< of a_from_b, of [x y yaw] in b's frame
};

/// How well poses of a graph are known from one of them: a bound of the marginal covariance, along
/// the best path of edges to each (Dijkstra projection: Bosse et al., "Simultaneous localization
/// and map building in large-scale cyclic environments using the Atlas framework", IJRR 2004;
/// Olson, "Robust and efficient robotic mapping", 2008).  Unlike the marginals of one solve it
/// costs the same whichever pose is asked from, and never says too little: other paths only add
/// knowledge.
class RelativeUncertainty {
 public:
  RelativeUncertainty(std::size_t poses, const std::vector<UncertainEdge>& edges);

  /// From a source, with the poses where they are.
  void From(std::uint32_t source, const std::vector<PlanarPose>& poses);

  bool IsReached(std::uint32_t pose) const { return is_reached_[pose] != 0; }
  /// Of source_from_pose, of [x y yaw] in the pose's frame.
  const Eigen::Matrix3d& Of(std::uint32_t pose) const { return covariance_[pose]; }

 private:
  struct Arc {
    std::uint32_t to, edge;
    bool forward;
  };
  std::vector<UncertainEdge> edges_;
  std::vector<std::uint32_t> first_;  // of each pose, in arcs_
  std::vector<Arc> arcs_;
  std::vector<Eigen::Matrix3d> covariance_;
  std::vector<std::uint8_t> is_reached_, is_done_;
  std::vector<std::pair<double, std::uint32_t>> heap_;
};

}  // namespace graticule
