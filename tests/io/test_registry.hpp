#pragma once

// The types that formats name, as tables without mathematics: io reads and writes, it does not
// evaluate.  Inline, so that the test programs of this folder share it.

#include "graticule/solver/registry.hpp"

namespace graticule {
namespace test_registry {

inline void* Create(const graticule_measurement*, int32_t, int32_t*, graticule_error*) {
  static int anything = 0;
  return &anything;
}
inline int32_t Evaluate(const void*, const double* const*, double*, double**, graticule_error*) {
  return 0;
}
inline void Destroy(void*) {}

inline constexpr const char* kTypes[][2] = {
    {"between_se2/1", "a:se2/1 b:se2/1 | x:m y:m yaw:rad"},
    {"landmark_se2/1", "pose:se2/1 landmark:point2/1 | x:m y:m"},
    {"bearing_se2/1", "pose:se2/1 landmark:point2/1 | bearing:rad"},
    {"bearing_range_se2/1", "pose:se2/1 landmark:point2/1 | bearing:rad range:m"},
    {"prior_se2/1", "pose:se2/1 | x:m y:m yaw:rad"},
    {"position_se2/1", "pose:se2/1 | x:m y:m"},
    {"between_se3/1",
     "a:se3/1 b:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m rx:rad ry:rad rz:rad"},
    {"between_se3_quaternion/1",
     "a:se3/1 b:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m ex ey ez"},
    {"landmark_se3/1", "pose:se3/1 landmark:point3/1 | x:m y:m z:m"},
    {"landmark_offset_se3/1",
     "pose:se3/1 landmark:point3/1 | x:m y:m z:m ox:m oy:m oz:m oqx oqy oqz oqw | x:m y:m z:m"},
    {"prior_se3/1", "pose:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m rx:rad ry:rad rz:rad"},
    {"prior_se3_quaternion/1", "pose:se3/1 | x:m y:m z:m qx qy qz qw | x:m y:m z:m ex ey ez"},
    {"prior_offset_se3/1",
     "pose:se3/1 | x:m y:m z:m qx qy qz qw ox:m oy:m oz:m oqx oqy oqz oqw"
     " | x:m y:m z:m rx:rad ry:rad rz:rad"},
    {"prior_offset_se3_quaternion/1",
     "pose:se3/1 | x:m y:m z:m qx qy qz qw ox:m oy:m oz:m oqx oqy oqz oqw"
     " | x:m y:m z:m ex ey ez"},
    {"bal_reprojection/1", "camera:bal_camera/1 point:point3/1 | u:px v:px"},
};

inline constexpr std::size_t kTypeCount = sizeof(kTypes) / sizeof(kTypes[0]);

}  // namespace test_registry

inline Registry TestRegistry() {
  static graticule_factor_type_v1 tables[test_registry::kTypeCount];
  Registry registry;
  for (const graticule_variable_type_v1* table : BuiltinVariableTables())
    registry.Add(MakeVariableType(*table, "built-in"));
  for (std::size_t i = 0; i < test_registry::kTypeCount; ++i) {
    tables[i] = {sizeof(graticule_factor_type_v1),
                 GRATICULE_FACTOR_RELATIVE,
                 test_registry::kTypes[i][0],
                 test_registry::kTypes[i][1],
                 "for tests",
                 test_registry::Create,
                 test_registry::Evaluate,
                 test_registry::Destroy};
    registry.Add(MakeFactorType(tables[i], "built-in"));
  }
  return registry;
}

}  // namespace graticule
