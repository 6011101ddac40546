#include "graticule/io/rig.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <map>
#include <vector>

#include "graticule/io/camera_pose.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

}  // namespace

LidarRig ParseKittiRig(std::string_view text, const std::string& name) {
  std::map<std::string, std::vector<double>> matrices;
  TextReader reader(text, name);
  while (reader.NextLine()) {
    std::string key(reader.Word());
    if (key != "P2:" && key != "R0_rect:" && key != "Tr_velo_to_cam:") continue;
    key.pop_back();
    std::vector<double>& matrix = matrices[key];
    matrix.clear();
    while (!reader.AtLineEnd()) matrix.push_back(reader.Double(key.c_str()));
    const std::size_t count = key == "R0_rect" ? 9 : 12;
    if (matrix.size() != count)
      throw Error(name, reader.LineNumber(reader.LineOffset()), 0,
                  key + ": expected " + std::to_string(count) + " numbers, found " +
                      std::to_string(matrix.size()));
  }
  for (const char* key : {"P2", "R0_rect", "Tr_velo_to_cam"})
    if (matrices.count(key) == 0) throw Error(name + ": no line " + key + ": ...");
  const std::vector<double>&projection = matrices["P2"], &velo = matrices["Tr_velo_to_cam"];
  const Eigen::Map<const RowMajor3> rectify(matrices["R0_rect"].data());
  RowMajor3 turn;
  Eigen::Vector3d shift;
  for (Eigen::Index r = 0; r < 3; ++r) {
    for (Eigen::Index c = 0; c < 3; ++c) turn(r, c) = velo[static_cast<std::size_t>(4 * r + c)];
    shift[r] = velo[static_cast<std::size_t>(4 * r + 3)];
  }
  const RowMajor3 rotation = rectify * turn;
  // P2 = K [I | t]: the colour camera stands beside the rectified frame's origin.
  RowMajor3 k;
  Eigen::Vector3d kt;
  for (Eigen::Index r = 0; r < 3; ++r) {
    for (Eigen::Index c = 0; c < 3; ++c) k(r, c) = projection[static_cast<std::size_t>(4 * r + c)];
    kt[r] = projection[static_cast<std::size_t>(4 * r + 3)];
  }
  if (!(k(0, 0) > 0) || !(k(1, 1) > 0)) throw Error(name + ": P2: expected focal lengths above 0");
  if (!IsRotation(rotation.data()))
    throw Error(name + ": R0_rect * Tr_velo_to_cam: expected a rotation");
  const Eigen::Vector3d translation = rectify * shift + k.inverse() * kt;
  LidarRig rig;
  rig.camera = {"image_2", "pinhole", 0, 0, {k(0, 0), k(1, 1), k(0, 2), k(1, 2)}};
  rig.camera_from_lidar = PoseOf(rotation.data(), translation.data());
  return rig;
}

}  // namespace graticule
