#pragma once

#include <cstddef>
#include <vector>

#include "graticule/io/planar_pose.hpp"
#include "graticule/io/relations.hpp"

namespace graticule {

/// A robot's pose at a time.
struct TimedPose {
  double time = 0;  ///< s
  PlanarPose world_from_robot;
};

/// Mean and standard deviation over relations.
struct ErrorMoments {
  double mean = 0, deviation = 0;
};

struct RelationError {
  std::size_t relations = 0;         ///< that were compared
  std::size_t unmatched = 0;         ///< no pose near one of their times
  ErrorMoments translation_m;        ///< |trans|
  ErrorMoments rotation_rad;         ///< |rot|
  ErrorMoments squared_translation;  ///< |trans|^2 [m^2]
  ErrorMoments squared_rotation;     ///< rot^2 [rad^2]
};

/// How far a trajectory is from relations that are known (Kuemmerle et al. 2009, eq. 3 to 5, with
/// each relation weighed alike): of each, the length and the angle of (true a_from_b)^-1 (ours).
/// A relation's pose is that at its time, between the two poses about it if none is within a
/// millisecond; `farthest_s` from both, there is none.
RelationError CompareWithRelations(std::vector<TimedPose> poses,
                                   const std::vector<PoseRelation>& relations,
                                   double farthest_s = 0.5);

}  // namespace graticule
