#include "graticule/io/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "graticule/io/id_table.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kFields[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

StampedPose MakePose(double stamp_s, Span<const double> value) {
  if (value.size() != 7) return StampPlanar(stamp_s, {value[0], value[1], value[2]});
  StampedPose pose;
  pose.stamp_s = stamp_s;
  std::copy(value.begin(), value.end(), pose.world_from_body.begin());
  return pose;
}

}  // namespace

StampedPose StampPlanar(double stamp_s, const PlanarPose& world_from_body) {
  const double half = std::remainder(world_from_body.yaw, 2 * M_PI) / 2;  // so that qw >= 0
  return {stamp_s, {world_from_body.x, world_from_body.y, 0, 0, 0, std::sin(half), std::cos(half)}};
}

std::vector<StampedPose> ParseTum(std::string_view text, const std::string& name) {
  TextReader reader(text, name);
  std::vector<StampedPose> poses;
  while (reader.NextLine()) {
    if (reader.Word()[0] == '#') continue;
    reader.Seek(reader.LineOffset());
    StampedPose pose;
    pose.stamp_s = reader.Double("the stamp");
    for (std::size_t i = 0; i < 3; ++i) pose.world_from_body[i] = reader.Double(kFields[i]);
    ReadQuaternion(&reader, kFields + 3, pose.world_from_body.data() + 3);
    reader.ExpectEnd();
    poses.push_back(pose);
  }
  return poses;
}

void ExpectInOrder(const std::vector<StampedPose>& poses, const std::string& name) {
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].stamp_s >= poses[i - 1].stamp_s) continue;
    std::string why = name + ": expected stamps in order, found ";
    AppendNumber(&why, poses[i].stamp_s);
    why += " s after ";
    AppendNumber(&why, poses[i - 1].stamp_s);
    throw Error(why + " s");
  }
}

std::string FormatTum(const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    AppendNumber(&text, pose.stamp_s);
    for (const double number : pose.world_from_body) {
      text += ' ';
      AppendNumber(&text, number);
    }
    text += '\n';
  }
  return text;
}

std::vector<std::string> PoseFamilies(const Graph& graph) {
  std::set<std::string, std::less<>> families;
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    if (IsPose(graph.TypeOf(id)) && families.find(graph.KeyOf(id).Family()) == families.end())
      families.emplace(graph.KeyOf(id).Family());
  return {families.begin(), families.end()};
}

std::vector<StampedPose> Trajectory(const Graph& graph, const Values& values,
                                    std::string_view family) {
  const std::vector<std::string> families = PoseFamilies(graph);
  std::string list;
  for (const std::string& name : families) list += (list.empty() ? "" : ", ") + name;
  if (families.empty()) throw Error("there is no pose (se2/1, se3/1) in the graph");
  if (family.empty() && families.size() > 1)
    throw Error("poses of several key families: name the one to write (" + list + ")");
  if (family.empty()) family = families[0];
  if (std::find(families.begin(), families.end(), family) == families.end())
    throw Error("the key family " + Quoted(family) + " has no poses, these have: " + list);

  std::vector<StampedPose> poses;
  for (const VariableId id : graph.KeyOrder()) {
    const Key& key = graph.KeyOf(id);
    if (key.Family() == family && IsPose(graph.TypeOf(id)))
      poses.push_back(MakePose(static_cast<double>(key.Number()), values.At(key)));
  }
  return poses;
}

}  // namespace graticule
