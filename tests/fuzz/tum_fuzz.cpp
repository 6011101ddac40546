#include "fuzz.hpp"
#include "graticule/io/trajectory.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  const std::vector<StampedPose> poses = ParseTum(text, "fuzz.tum");
  if (ParseTum(FormatTum(poses), "again.tum").size() != poses.size()) std::abort();
}
