#pragma once

#include <string>
#include <vector>

namespace graticule::apps {

/// What a simulated mission's folder has.
struct MissionContents {
  std::string made_by, datum;
  std::vector<std::string> robots;
  bool has_gnss = false, is_recorded = false, has_signal = false, has_cameras = false;
};

/// The page that says what is what in the folder, with frames and units.
std::string MissionReadme(const MissionContents& contents);

}  // namespace graticule::apps
