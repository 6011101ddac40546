#include "graticule/io/mission_index.hpp"

#include <algorithm>
#include <unordered_set>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : text_(text), reader_(text, name) {}

  MissionIndex Read() {
    if (!reader_.NextLine()) reader_.FailAt(0, "the file is empty");
    if (reader_.Word() != "graticule-mission")
      reader_.FailExpected("a recorded mission's index, graticule-mission", nullptr);
    if (reader_.Integer("the version") != 1) reader_.FailExpected("version 1", "the version");
    reader_.ExpectEnd();
    const std::size_t lasers = ReadHeader();
    for (std::size_t i = 0; i < lasers; ++i) ReadLaser();
    for (std::size_t i = Count("robots", "a robot", 1); i > 0; --i) ReadRobot();
    for (std::size_t i = Count("nodes", "a node", 1); i > 0; --i) ReadNode();
    for (std::size_t i = Count("graphs", "a graph", 1); i > 0; --i) ReadGraph();
    Next("end");
    if (reader_.Word() != "end") reader_.FailExpected("the line 'end'", nullptr);
    reader_.ExpectEnd();
    if (reader_.NextLine()) {
      reader_.Word();
      reader_.FailExpected("nothing after the line 'end'", nullptr);
    }
    return std::move(index_);
  }

 private:
  void Next(const char* what) {
    if (!reader_.NextLine())
      reader_.FailAt(text_.size(), std::string("the file is cut short: expected ") + what);
    line_ += static_cast<std::size_t>(
        std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted_),
                   text_.begin() + static_cast<std::ptrdiff_t>(reader_.LineOffset()), '\n'));
    counted_ = reader_.LineOffset();
  }

  // Up to the number of lasers.
  std::size_t ReadHeader() {
    for (;;) {
      Next("lasers");
      const std::string_view word = reader_.Word();
      if (word == "title") {
        index_.title = reader_.Rest();
      } else if (word == "made-by") {
        index_.made_by = reader_.Rest();
      } else if (word == "datum") {
        Geodetic datum;
        datum.latitude = reader_.Double("the latitude");
        datum.longitude = reader_.Double("the longitude");
        datum.height = reader_.Double("the height");
        reader_.ExpectEnd();
        index_.datum = datum;
      } else if (word == "lasers") {
        return Number("lasers", 1);
      } else {
        reader_.FailExpected("title, made-by, datum or lasers", nullptr);
      }
    }
  }

  std::size_t Number(const char* what, std::uint64_t least) {
    const std::uint64_t count = reader_.Integer(what);
    // Every item is a line of its own.
    if (count < least || count > text_.size())
      reader_.FailExpected("as many as there are lines", what);
    reader_.ExpectEnd();
    return static_cast<std::size_t>(count);
  }

  std::size_t Count(const char* word, const char* what, std::uint64_t least) {
    Next(word);
    if (reader_.Word() != word) reader_.FailExpected(word, "or fewer lines before");
    return Number(what, least);
  }

  PlanarPose ReadPose() {
    PlanarPose pose;
    pose.x = reader_.Double("x");
    pose.y = reader_.Double("y");
    pose.yaw = reader_.Double("yaw");
    return pose;
  }

  void ReadLaser() {
    Next("a laser");
    LaserGeometry laser;
    laser.first_angle = reader_.Double("the first angle");
    laser.step = reader_.Double("the angle between beams");
    laser.max_range = reader_.Double("the maximum range");
    if (laser.max_range < 0) reader_.FailExpected("0 m (not known) or more", "the maximum range");
    laser.robot_from_laser = ReadPose();
    reader_.ExpectEnd();
    index_.lasers.push_back(laser);
  }

  // A mission may come from anywhere: it names no file but its own.
  std::string ReadFileName(const char* what) {
    const std::string file(reader_.Word(what));
    if (file.front() == '/' || ("/" + file + "/").find("/../") != std::string::npos)
      reader_.FailExpected("a file within the folder", what);
    return file;
  }

  void ReadRobot() {
    Next("a robot");
    MissionIndex::Robot robot;
    robot.line = line_;
    robot.name = reader_.Word("the robot's name");  // of files, too
    Key key("pose", 0);
    if (!Key::Parse(robot.name + ":0", &key))
      reader_.FailExpected("a robot's name", "letters, digits, _ . -");
    if (!names_.insert(robot.name).second) reader_.FailExpected("each robot once", nullptr);
    robot.family = reader_.Word("the family of its keys");
    if (!Key::Parse(robot.family + ":0", &key))
      reader_.FailExpected("a family of keys", "letters, digits, _ . -");
    robot.scans = ReadFileName("the file of its scans");
    if (!reader_.AtLineEnd()) {
      if (reader_.Word() != "start") reader_.FailExpected("start", nullptr);
      robot.start = ReadPose();
    }
    reader_.ExpectEnd();
    index_.robots.push_back(std::move(robot));
  }

  std::uint32_t Index(const char* what, std::size_t count) {
    const std::uint64_t number = reader_.Integer(what);
    if (number >= count)
      reader_.FailExpected(("a number below " + std::to_string(count)).c_str(), what);
    return static_cast<std::uint32_t>(number);
  }

  void ReadNode() {
    Next("a node");
    Key key("pose", 0);
    if (!Key::Parse(reader_.Word("the node's key"), &key))
      reader_.FailExpected("a key, as robot1:12", nullptr);
    if (!keys_.insert(key).second) reader_.FailExpected("each node once", nullptr);
    MissionIndex::Node node{key, 0, 0, line_};
    node.robot = Index("the number of its robot", index_.robots.size());
    if (index_.robots[node.robot].family != key.Family())
      reader_.FailExpected("the robot of this key's family", "the number of its robot");
    node.laser = Index("the number of its laser", index_.lasers.size());
    reader_.ExpectEnd();
    index_.nodes.push_back(node);
  }

  void ReadGraph() {
    Next("a graph");
    MissionIndex::Graph graph;
    graph.line = line_;
    graph.file = ReadFileName("the graph's file");
    graph.time = reader_.Double("the time");
    const bool is_first = index_.graphs.empty();
    if (!is_first && !(graph.time > index_.graphs.back().time))
      reader_.FailExpected("a time after that of the graph before", "the time");
    graph.nodes = static_cast<std::size_t>(reader_.Integer("the number of its nodes"));
    const std::size_t least = is_first ? 1 : index_.graphs.back().nodes;
    if (graph.nodes < least || graph.nodes > index_.nodes.size())
      reader_.FailExpected((std::to_string(least) + " to " + std::to_string(index_.nodes.size()) +
                            ", as many as the graph before has and the mission at most")
                               .c_str(),
                           "the number of its nodes");
    reader_.ExpectEnd();
    index_.graphs.push_back(std::move(graph));
  }

  std::string_view text_;
  TextReader reader_;
  MissionIndex index_;
  std::unordered_set<Key, KeyHash> keys_;
  std::unordered_set<std::string> names_;
  std::size_t line_ = 1, counted_ = 0;
};

std::string OneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

}  // namespace

MissionIndex ParseMissionIndex(std::string_view text, const std::string& name) {
  return Reader(text, name).Read();
}

std::string FormatMissionIndex(const MissionIndex& index) {
  std::string text = "graticule-mission 1\n";
  const auto numbers = [&text](std::initializer_list<double> all) {
    for (const double number : all) {
      text += ' ';
      AppendNumber(&text, number);
    }
  };
  const auto pose = [&numbers](const PlanarPose& p) { numbers({p.x, p.y, p.yaw}); };
  if (!index.title.empty()) text += "title    " + OneLine(index.title) + "\n";
  if (!index.made_by.empty()) text += "made-by  " + OneLine(index.made_by) + "\n";
  if (index.datum) {
    text += "datum   ";
    numbers({index.datum->latitude, index.datum->longitude, index.datum->height});
    text += '\n';
  }
  text += "lasers   " + std::to_string(index.lasers.size()) + "\n";
  for (const LaserGeometry& laser : index.lasers) {
    AppendNumber(&text, laser.first_angle);
    numbers({laser.step, laser.max_range});
    pose(laser.robot_from_laser);
    text += '\n';
  }
  text += "robots   " + std::to_string(index.robots.size()) + "\n";
  for (const MissionIndex::Robot& robot : index.robots) {
    text += robot.name + " " + robot.family + " " + robot.scans;
    if (robot.start) {
      text += " start";
      pose(*robot.start);
    }
    text += '\n';
  }
  text += "nodes    " + std::to_string(index.nodes.size()) + "\n";
  for (const MissionIndex::Node& node : index.nodes)
    text += node.key.ToString() + " " + std::to_string(node.robot) + " " +
            std::to_string(node.laser) + "\n";
  text += "graphs   " + std::to_string(index.graphs.size()) + "\n";
  for (const MissionIndex::Graph& graph : index.graphs) {
    text += graph.file;
    numbers({graph.time});
    text += " " + std::to_string(graph.nodes) + "\n";
  }
  return text + "end\n";
}

}  // namespace graticule
