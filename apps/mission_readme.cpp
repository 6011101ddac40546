#include "mission_readme.hpp"

#include <fmt/core.h>

namespace graticule::apps {
namespace {

using Row = std::pair<std::string, std::string>;

std::string Table(const std::vector<Row>& rows) {
  std::string text = "| file | what it is |\n|---|---|\n";
  for (const auto& [file, what] : rows) text += fmt::format("| `{}` | {} |\n", file, what);
  return text;
}

}  // namespace

std::string MissionReadme(const MissionContents& contents) {
  const std::string& last = contents.robots.back();
  const std::string to_last = contents.robots.size() > 1 ? " .. " + last : "";
  std::vector<Row> seen = {
      {"robot1" + (contents.robots.size() > 1 ? " .. " + last + ".log" : ".log"),
       "what a robot's laser and wheels said: CARMEN text, ROBOTLASER1; ranges in m, poses of dead "
       "reckoning x y yaw in m and rad, times in s. Starts are not told"},
      {"graph.fg",
       "the pose graph that an ideal front end would have made, not solved; for `graticule "
       "solve`"}};
  std::vector<Row> truth = {
      {"truth/map.yaml", "the town, cell by cell (map_server)"},
      {"truth/poses.robot1.tum", "where each robot was at each scan: TUM, town_from_robot"},
      {"truth/truth.json", "seed and numbers of what was simulated"}};
  if (contents.has_gnss)
    seen.push_back({"gnss.csv",
                    "satellite fixes: time [s], robot, degrees, m; the antenna is on "
                    "the robot's centre"});
  if (contents.is_recorded)
    seen.push_back({"mission.index, graphs/, scans/", "the same as a recorded mission"});
  if (contents.has_signal) {
    seen.push_back({"signal.csv",
                    "what the robots' radios heard of each other: time [s], receiver, "
                    "transmitter, dBm; where they were is not told. heard = 0: "
                    "weaker than that"});
    truth.push_back({"truth/signal.csv", "the same with the true positions [m]"});
    truth.push_back(
        {"truth/links.csv", "links that nobody measured: what they would be on average [dBm]"});
  }
  if (contents.has_cameras) {
    seen.push_back({"cameras/target.yaml", "the calibration target: tags, sizes in m"});
    seen.push_back({"cameras/robot1/00.png",
                    "pictures of it by a robot's camera, which nobody "
                    "knows anything of"});
    seen.push_back({"scene/scan.pcd",
                    "a street as robot1's swept LIDAR saw it: x ahead, y left, z "
                    "up [m], 1 m above the ground; `label`: 1 ground, 2 to 19 "
                    "walls, from 20 on things"});
    seen.push_back({"scene/image.png", "the street as robot1's camera saw it"});
    seen.push_back({"scene/points.csv",
                    "points of the scan [m] that a person found in the image [px]; two are wrong"});
    truth.push_back({"truth/robot1.yaml", "a robot's camera"});
    truth.push_back({"truth/rig.yaml", "robot1's camera, and where it is on the LIDAR"});
  }
  return fmt::format(
      "# A simulated mission\n\n{}.\n\n{} in a town of streets, houses and yards, among people and "
      "cars. The town's frame has x east, y north, in metres; its origin is the lower left "
      "corner{}. "
      "Pixel (0, 0) is the centre of the upper left one.\n\n## What the robots recorded\n\n{}\n"
      "## The truth\n\n{}\n",
      contents.made_by,
      contents.robots.size() > 1
          ? fmt::format("{} robots (robot1{})", contents.robots.size(), to_last)
          : "A robot",
      contents.has_gnss ? " and is at " + contents.datum + " (degrees, m) on the Earth" : "",
      Table(seen), Table(truth));
}

}  // namespace graticule::apps
