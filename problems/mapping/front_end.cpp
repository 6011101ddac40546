#include "graticule/problems/mapping/front_end.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "graticule/problems/mapping/point_refine.hpp"
#include "graticule/problems/mapping/scan_match.hpp"

namespace graticule {

Track FollowScans(const LaserLog& log, const FrontEndOptions& options) {
  Track track;
  auto& nodes = track.nodes;
  LikelihoodGrid grid(0.05, 0.07);
  CorrelativeMatcher matcher;
  PointIndex index;
  std::vector<SurfacePoint> reference;
  const auto add = [&](std::size_t scan, const PlanarPose& pose, std::vector<SurfacePoint> points) {
    TrackNode node;
    node.scan = scan;
    node.pose = pose;
    node.points = std::move(points);
    nodes.push_back(std::move(node));
    // reference in the frame of the last node
    reference.clear();
    const std::size_t first = nodes.size() - std::min<std::size_t>(nodes.size(), static_cast<std::size_t>(options.local_nodes));
    for (std::size_t k = nodes.size(); k-- > first;)
      AppendTransformed(nodes[k].points, Inverse(pose) * nodes[k].pose, &reference);
    grid.Build(reference, 0, 0, options.surface.max_range + 1);
    index.Build(reference);
  };
  PlanarPose odom, pose;
  std::size_t still = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const LaserScan& scan = log.scans[i];
    if (nodes.empty()) {
      odom = scan.odom_from_robot;
      add(i, {}, SurfacePoints(log, scan, options.surface));
      track.scan_poses.push_back(pose);
      continue;
    }
    const PlanarPose moved = Inverse(odom) * scan.odom_from_robot;
    odom = scan.odom_from_robot;
    const double d = std::hypot(moved.x, moved.y), turn = std::abs(moved.yaw);
    still = d < 1e-3 && turn < 1e-3 ? still + 1 : 0;
    if (still > 3) {
      pose = pose * moved;
      track.scan_poses.push_back(pose);
      continue;
    }
    std::vector<SurfacePoint> points = SurfacePoints(log, scan, options.surface);
    const double sigma = 0.02 + options.odometry_sigma_m * d + options.odometry_sigma_turn_m * turn;
    const double sigma_yaw =
        0.03 + options.odometry_sigma_rad * turn + options.odometry_sigma_m_rad * d;
    const PlanarPose last = nodes.back().pose;
    SearchWindow window;
    window.guess = Inverse(last) * pose * moved;
    window.reach = std::min(std::max(0.2, 3 * sigma), 1.5);
    window.reach_yaw = std::min(std::max(0.2, 4 * sigma_yaw), 0.8);
    window.sigma = sigma;
    window.sigma_yaw = sigma_yaw;
    Match match;
    match.reference_from_scan = window.guess;
    matcher.Search(grid, points, window, 0, &match);
    Eigen::Matrix3d prior = Eigen::Matrix3d::Zero();
    prior.diagonal() << 1 / (sigma * sigma), 1 / (sigma * sigma), 1 / (sigma_yaw * sigma_yaw);
    const Refinement refined = RefineOnPoints(index, points, match.reference_from_scan, window.guess,
                                              prior, 0.03);
    const PlanarPose& in_last = refined.reference_from_scan;
    pose = last * in_last;
    track.scan_poses.push_back(pose);
    if (std::hypot(in_last.x, in_last.y) >= options.node_distance ||
          std::abs(in_last.yaw) >= options.node_turn) {
      add(i, pose, std::move(points));
      nodes.back().information = refined.information;
      nodes.back().matched = refined.matched;
    }
  }
  return track;
}

}  // namespace graticule
