#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// One line of a trajectory.
struct StampedPose {
  double stamp_s = 0;
  std::array<double, 7> world_from_body{0, 0, 0, 0, 0, 0, 1};  ///< x y z qx qy qz qw
};

/// A pose of the plane: z = 0, turned about z.
StampedPose StampPlanar(double stamp_s, const PlanarPose& world_from_body);

/// Reads a trajectory as the TUM benchmark has it: `stamp x y z qx qy qz qw`, `#` begins a comment.
/// Quaternions are brought to unit length.  Throws Error "name:line:column: ...".
std::vector<StampedPose> ParseTum(std::string_view text, const std::string& name);
/// Throws Error `NAME: ...` where a stamp is before the one that it follows.
void ExpectInOrder(const std::vector<StampedPose>& poses, const std::string& name);
std::string FormatTum(const std::vector<StampedPose>& poses);

/// The key families that have poses (se2/1 or se3/1), in order.
std::vector<std::string> PoseFamilies(const Graph& graph);

/// The poses of one family in key order, with values of the graph's keys; the stamp of a pose is
/// its key's number.  An empty family means the only one that has poses.  Poses of the plane have z
/// = 0 and turn about z.  Throws Error: no poses, or several families and none was named.
std::vector<StampedPose> Trajectory(const Graph& graph, const Values& values,
                                    std::string_view family = {});

}  // namespace graticule
