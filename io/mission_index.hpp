#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/geography.hpp"
#include "graticule/io/laser_log.hpp"
#include "graticule/solver/key.hpp"

namespace graticule {

/// What a recorded mission consists of: the file `mission.index` of its folder.  The graphs of the
/// sequence are problems of their own (`.fg`), whose values are the solution of that time; the
/// scans are ROBOTLASER1 lines after the vertices of a g2o file a robot.
///
///     graticule-mission 1
///     title    intel.clf.gz
///     made-by  graticule 0.1.0 map
///     datum    42.293 -83.711 0
///     lasers   1
///     -1.5707963267948966 0.017453292519943295 80.73 0 0 0
///     robots   1
///     robot1 robot1 scans/robot1.g2o.gz start 0 0 0
///     nodes    2
///     robot1:0 0 0
///     robot1:1 0 0
///     graphs   1
///     graphs/00001.fg 10 2
///     end
struct MissionIndex {
  struct Robot {
    std::string name;
    std::string family;  ///< of the keys of its nodes; the vertices' ids are their numbers
    std::string scans;   ///< file, from the folder
    std::optional<PlanarPose> start;  ///< where it was known to begin
    std::size_t line = 0;             ///< of the index; 0: none
  };
  struct Node {
    Key key;
    std::uint32_t robot = 0;  ///< into robots
    std::uint32_t laser = 0;  ///< into lasers
    std::size_t line = 0;
  };
  struct Graph {
    std::string file;       ///< from the folder
    double time = 0;        ///< s, of the logs
    std::size_t nodes = 0;  ///< the first so many of `nodes` are in it
    std::size_t line = 0;
  };

  std::string title, made_by;         ///< one line each
  std::optional<Geodetic> datum;      ///< of the graphs' world: x east, y north of here
  std::vector<LaserGeometry> lasers;  ///< first angle, step, range, mounting: exactly
  std::vector<Robot> robots;
  std::vector<Node> nodes;  ///< in the order in which they came: each has one scan
  std::vector<Graph> graphs;
};

/// Throws Error "name:line:column: ...": cut short anywhere, counts, numbers that name nothing,
/// nodes named twice, graphs that lose nodes or go back in time, a file outside the folder.
MissionIndex ParseMissionIndex(std::string_view text, const std::string& name);

/// The same index, the same bytes.
std::string FormatMissionIndex(const MissionIndex& index);

}  // namespace graticule
