#include "graticule/io/cloud_files.hpp"

#include <algorithm>
#include <filesystem>

#include "graticule/io/file.hpp"
#include "graticule/io/sweep.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

std::string EndingOf(const std::string& path) {
  return std::filesystem::path(WithoutGz(path)).extension().string();
}

}  // namespace

PointCloud ReadCloud(const std::string& path) {
  const std::string ending = EndingOf(path);
  if (ending != ".pcd" && ending != ".ply" && ending != ".bin" && ending != ".csv")
    throw Error(path + ": expected a cloud that ends in .pcd, .ply, .bin (KITTI) or .csv (a sweep)",
                ErrorKind::kUsage);
  const std::string bytes = ReadFile(path);
  PointCloud cloud;
  if (ending == ".pcd") {
    cloud = ParsePcd(bytes, path);
  } else if (ending == ".ply") {
    cloud = ParsePly(bytes, path);
  } else if (ending == ".bin") {
    cloud = ParseKittiScan(bytes, path);
  } else {
    cloud = ToCloud(ParseSweep(bytes, path));
  }
  if (std::none_of(cloud.in_sensor.begin(), cloud.in_sensor.end(),
                   [](const Eigen::Vector3f& point) { return point.allFinite(); }))
    throw Error(path + ": all " + std::to_string(cloud.Size()) +
                " points are without a return (not finite)");
  return ending == ".bin" ? OrganiseSpinning(cloud) : cloud;
}

void WriteCloud(const std::string& path, const PointCloud& cloud) {
  const std::string ending = EndingOf(path);
  if (ending != ".pcd" && ending != ".ply")
    throw Error(path + ": clouds are written as .pcd or .ply", ErrorKind::kUsage);
  const auto fits = [&](std::size_t size) { return size == 0 || size == cloud.Size(); };
  if (cloud.width * cloud.height != cloud.Size() || !fits(cloud.colours.size()) ||
      !fits(cloud.intensities.size()) || !fits(cloud.labels.size()))
    throw Error(path + ": a cloud has one position, colour and label a point", ErrorKind::kUsage);
  WriteFile(path, ending == ".pcd" ? FormatPcd(cloud) : FormatPly(cloud));
}

}  // namespace graticule
