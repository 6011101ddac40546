#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "graticule/io/accuracy.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// True trajectories by key family; a pose's stamp is its key's number.
using GroundTruth = std::map<std::string, std::vector<StampedPose>, std::less<>>;

/// How an estimate is laid onto the truth before its poses are compared.
enum class TrajectoryAlignment : std::uint8_t {
  kRigid,       ///< rotation and translation that minimise the squared distances (Umeyama)
  kSimilarity,  ///< with a scale
  kFirst,       ///< so that the first poses agree
  kNone,        ///< as it is
};

struct TrajectoryErrorOptions {
  TrajectoryAlignment align = TrajectoryAlignment::kRigid;
  double rpe_distance_m = 10;  ///< above 0
};

/// The poses of a family whose truth is known, in the order of their keys; x y z qx qy qz qw.
struct TrajectoryPair {
  std::string family;
  std::size_t poses = 0;  ///< of the family, with and without a truth
  std::vector<std::array<double, 7>> truth, estimate;
};

/// Poses of a graph and their truth, family by family.  A pose's truth is that of its family with
/// its key's number as the stamp; where no stamp is the number of a key, and there are as many
/// poses in both, it is the one at the same position.  Where graph and truth have one family each,
/// its name does not matter.  Throws Error: nothing matches, or two true poses have one stamp.
std::vector<TrajectoryPair> PairWithTruth(const Graph& graph, const Values& values,
                                          const GroundTruth& truth);

/// Errors of trajectories against the truth, of all together and of each family, as evo's `evo_ape`
/// and `evo_rpe` define them (M. Grupp, https://github.com/MichaelGrupp/evo; J. Sturm et al., "A
/// benchmark for the evaluation of RGB-D SLAM systems", IROS 2012).  With P the aligned estimate
/// and Q the truth:
///
/// - ATE: the distance |p - q| in metres, and the angle of Q^-1 P in degrees, at each pose.
/// - RPE: length and angle of (Qi^-1 Qj)^-1 (Pi^-1 Pj), from each matched pose to the next; and
/// from
///   mark to mark, where a mark is the first pose at which at least `rpe_distance_m` of the true
///   path have been driven since the mark before, or for the first mark since the first pose (evo's
///   consecutive pairs with `--delta_unit m --pairs_from_reference`).  No pair joins two families.
///
/// Trajectories that lie in the plane (z = 0, turned about z) are aligned in it.  Alignment is
/// after S. Umeyama, "Least-squares estimation of transformation parameters between two point
/// patterns" (PAMI 1991); where positions leave the rotation open (one place; in space, a line),
/// the first pose decides, and `alignment` says so.
Accuracy TrajectoryErrors(const std::vector<TrajectoryPair>& pairs,
                          const TrajectoryErrorOptions& options = {});

}  // namespace graticule
