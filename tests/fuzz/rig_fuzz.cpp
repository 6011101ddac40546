#include "fuzz.hpp"
#include "graticule/io/rig.hpp"

// KITTI's calibration begins with a letter and a digit, a rig of our own does not.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  const bool is_kitti = text.size() > 1 && text[1] >= '0' && text[1] <= '9';
  const LidarRig rig = is_kitti ? ParseKittiRig(text, "calib.txt") : ParseRig(text, "fuzz.yaml");
  if (is_kitti) return;  // without the image's size, which ours has to have
  const std::string once = FormatRig(rig);
  if (FormatRig(ParseRig(once, "again.yaml")) != once) std::abort();
}
