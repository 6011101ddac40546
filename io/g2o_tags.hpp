#pragma once

// Internal to io/g2o_*.cpp: what each tag of a g2o file holds, for reading and writing alike.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace graticule {

enum class VertexKind : std::uint8_t { kPose2, kPoint2, kPose3, kPoint3, kNone };

struct VertexTag {
  std::string_view tag;
  const char* type;
  const char* family;
  int size;
  int quaternion;  ///< where the quaternion begins, or -1
};

/// In the order of VertexKind.
inline constexpr VertexTag kVertexTags[] = {
    {"VERTEX_SE2", "se2/1", "pose", 3, -1},
    {"VERTEX_XY", "point2/1", "landmark", 2, -1},
    {"VERTEX_SE3:QUAT", "se3/1", "pose", 7, 3},
    {"VERTEX_TRACKXYZ", "point3/1", "landmark", 3, -1},
};

/// One kind of edge, as one type of factor.  The same tag stands in several rows where the factor
/// type depends on the reading of rotations or on the sensor's offset.
struct EdgeTag {
  std::string_view tag;
  VertexKind a, b;
  bool has_parameter;  ///< names a PARAMS_SE3OFFSET after the ids
  int size;            ///< measured numbers
  int quaternion;      ///< where in the measurement the quaternion begins, or -1
  int residual;        ///< rows of the information matrix
  const char* source;  ///< null: odometry or loop, by the ids
  /// Factor types: [full angle?][offset that is not the identity?]; null: there is none.
  const char* types[2][2];
};

inline constexpr EdgeTag kEdgeTags[] = {
    {"EDGE_SE2",
     VertexKind::kPose2,
     VertexKind::kPose2,
     false,
     3,
     -1,
     3,
     nullptr,
     {{"between_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_SE3:QUAT",
     VertexKind::kPose3,
     VertexKind::kPose3,
     false,
     7,
     3,
     6,
     nullptr,
     {{"between_se3_quaternion/1", nullptr}, {"between_se3/1", nullptr}}},
    {"EDGE_SE2_XY",
     VertexKind::kPose2,
     VertexKind::kPoint2,
     false,
     2,
     -1,
     2,
     "landmark",
     {{"landmark_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_BEARING_SE2_XY",
     VertexKind::kPose2,
     VertexKind::kPoint2,
     false,
     1,
     -1,
     1,
     "landmark",
     {{"bearing_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_SE3_TRACKXYZ",
     VertexKind::kPose3,
     VertexKind::kPoint3,
     true,
     3,
     -1,
     3,
     "landmark",
     {{"landmark_se3/1", "landmark_offset_se3/1"}, {nullptr, nullptr}}},
    {"EDGE_PRIOR_SE2",
     VertexKind::kPose2,
     VertexKind::kNone,
     false,
     3,
     -1,
     3,
     "prior",
     {{"prior_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_SE2_PRIOR",
     VertexKind::kPose2,
     VertexKind::kNone,
     false,
     3,
     -1,
     3,
     "prior",
     {{"prior_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_PRIOR_SE2_XY",
     VertexKind::kPose2,
     VertexKind::kNone,
     false,
     2,
     -1,
     2,
     "prior",
     {{"position_se2/1", nullptr}, {nullptr, nullptr}}},
    {"EDGE_SE3_PRIOR",
     VertexKind::kPose3,
     VertexKind::kNone,
     true,
     7,
     3,
     6,
     "prior",
     {{"prior_se3_quaternion/1", "prior_offset_se3_quaternion/1"},
      {"prior_se3/1", "prior_offset_se3/1"}}},
};

inline constexpr std::size_t kEdgeTagCount = sizeof(kEdgeTags) / sizeof(kEdgeTags[0]);
inline constexpr std::size_t kVertexTagCount = sizeof(kVertexTags) / sizeof(kVertexTags[0]);
inline constexpr int kOffsetSize = 7;       ///< x y z qx qy qz qw
inline constexpr int kMaxMeasurement = 14;  ///< a pose and an offset
inline constexpr int kMaxInformation = 21;  ///< upper triangle of 6 x 6

/// Multiplies the rotation rows and columns of an information matrix of 6 x 6 by `factor`, which is
/// a power of two: no digit is lost.
inline void ScaleRotation(double factor, double* information) {
  for (int row = 0, i = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column, ++i)
      information[i] *= (row >= 3 ? factor : 1) * (column >= 3 ? factor : 1);
}

}  // namespace graticule
