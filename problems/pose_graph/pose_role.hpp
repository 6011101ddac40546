#pragma once

#include <cstdint>
#include <string_view>

namespace graticule {

/// What a factor type says to whoever places poses and landmarks.
enum class PoseRole : std::uint8_t {
  kOther,
  kBetween,             ///< a pose from a pose
  kPrior,               ///< a pose in the world
  kPriorWithOffset,     ///< a sensor on a pose in the world
  kPosition,            ///< a pose's position in the world (in space: with a lever arm)
  kLandmark,            ///< a point from a pose
  kLandmarkWithOffset,  ///< a point from a sensor on a pose
  kBearingRange,        ///< a point's direction and distance from a planar pose
  kPriorPoint,          ///< a point in the world
};

/// By the factor type's name; kOther where it says nothing of the kind.
inline PoseRole PoseRoleOf(std::string_view type) {
  constexpr struct {
    std::string_view type;
    PoseRole role;
  } kRoles[] = {{"between_se2/1", PoseRole::kBetween},
                {"between_se3/1", PoseRole::kBetween},
                {"between_se3_quaternion/1", PoseRole::kBetween},
                {"prior_se2/1", PoseRole::kPrior},
                {"prior_se3/1", PoseRole::kPrior},
                {"prior_se3_quaternion/1", PoseRole::kPrior},
                {"prior_offset_se3/1", PoseRole::kPriorWithOffset},
                {"prior_offset_se3_quaternion/1", PoseRole::kPriorWithOffset},
                {"position_se2/1", PoseRole::kPosition},
                {"position_se3/1", PoseRole::kPosition},
                {"landmark_se2/1", PoseRole::kLandmark},
                {"landmark_se3/1", PoseRole::kLandmark},
                {"landmark_offset_se3/1", PoseRole::kLandmarkWithOffset},
                {"bearing_range_se2/1", PoseRole::kBearingRange},
                {"prior_point2/1", PoseRole::kPriorPoint},
                {"prior_point3/1", PoseRole::kPriorPoint}};
  for (const auto& row : kRoles)
    if (row.type == type) return row.role;
  return PoseRole::kOther;
}

/// Its rotation residual is the vector part of a quaternion: half the angle where that is small.
inline bool IsHalfAngle(std::string_view type) {
  return type.find("_quaternion/") != std::string_view::npos;
}

}  // namespace graticule
