#include "graticule/problems/mapping/planar_values.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {

PlanarPose PlanarPoseAt(const Values& values, const Key& key) {
  const Span<const double> value = values.At(key);
  if (value.size() != 3)
    throw Error("expected " + key.ToString() + " to be a pose of the plane (se2/1), found " +
                std::to_string(value.size()) + " numbers");
  return {value[0], value[1], value[2]};
}

}  // namespace graticule
