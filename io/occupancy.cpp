#include "graticule/io/occupancy.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "graticule/io/file.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::uint8_t kBlack = 0, kWhite = 254, kGrey = 205;
constexpr double kFreeThreshold = 0.196, kOccupiedThreshold = 0.65;

GreyImage Shades(const OccupancyGrid& grid) {
  GreyImage image{grid.width, grid.height, {}};
  image.shades.reserve(grid.cells.size());
  for (std::size_t y = grid.height; y-- > 0;)
    for (std::size_t x = 0; x < grid.width; ++x) {
      const Occupancy cell = grid.At(x, y);
      image.shades.push_back(cell == Occupancy::kStructure ? kBlack
                             : cell == Occupancy::kFree    ? kWhite
                                                           : kGrey);
    }
  return image;
}

// What a map_server file says, with its places.
class MapFile {
 public:
  explicit MapFile(const std::string& path) : path_(path) {
    try {
      root_ = YAML::Load(ReadFile(path));
    } catch (const YAML::Exception& error) {
      Refuse(error.mark, "not YAML: " + Printable(error.msg));
    }
    if (!root_.IsMap()) Refuse(root_.Mark(), "expected a mapping: image, resolution, origin, ...");
  }

  std::string Text(const char* name) const {
    const YAML::Node node = root_[name];
    if (!node) Refuse(root_.Mark(), std::string("expected '") + name + "'");
    if (!node.IsScalar() || node.Scalar().empty())
      Refuse(node.Mark(), std::string("expected a value of '") + name + "'");
    return node.Scalar();
  }
  double Number(const YAML::Node& node, const std::string& what) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
      Refuse(node.Mark(), "expected a finite number (" + what + ")");
    return value;
  }
  double Number(const char* name, std::optional<double> otherwise = std::nullopt) const {
    const YAML::Node node = root_[name];
    if (!node && otherwise) return *otherwise;
    if (!node) Refuse(root_.Mark(), std::string("expected '") + name + "'");
    return Number(node, name);
  }
  PlanarPose Origin() const {
    const YAML::Node node = root_["origin"];
    if (!node) Refuse(root_.Mark(), "expected 'origin'");
    if (!node.IsSequence() || (node.size() != 3 && node.size() != 2))
      Refuse(node.Mark(), "expected the origin as [x, y, yaw]");
    return {Number(node[0], "x of the origin"), Number(node[1], "y of the origin"),
            node.size() == 3 ? Number(node[2], "yaw of the origin") : 0};
  }
  bool Flag(const char* name) const {
    const YAML::Node node = root_[name];
    if (!node) return false;
    bool value = false;
    if (YAML::convert<bool>::decode(node, value)) return value;
    return Number(node, name) != 0;
  }
  std::string Mode() const { return root_["mode"] ? Text("mode") : "trinary"; }
  [[noreturn]] void RefuseValue(const char* name, const std::string& why) const {
    const YAML::Node node = root_[name];
    Refuse(node ? node.Mark() : root_.Mark(), why);  // what is not there has no place
  }

 private:
  [[noreturn]] void Refuse(const YAML::Mark& mark, const std::string& why) const {
    throw Error(path_ + ":" + std::to_string(std::max(mark.line, 0) + 1) + ":" +
                std::to_string(std::max(mark.column, 0) + 1) + ": " + why);
  }

  const std::string& path_;
  YAML::Node root_;
};

}  // namespace

OccupancyFiles FormatOccupancy(const OccupancyGrid& grid, const std::string& image) {
  OccupancyFiles files;
  const auto add = [&](const char* before, double value) {
    files.yaml += before;
    AppendNumber(&files.yaml, value);
  };
  YAML::Emitter name;  // quotes where it has to
  name << image;
  files.yaml = std::string("image: ") + name.c_str() + "\nmode: trinary";
  add("\nresolution: ", grid.resolution);
  add("\norigin: [", grid.map_from_grid.x);
  add(", ", grid.map_from_grid.y);
  add(", ", grid.map_from_grid.yaw);
  add("]\nnegate: 0\noccupied_thresh: ", kOccupiedThreshold);
  add("\nfree_thresh: ", kFreeThreshold);
  files.yaml += "\n";
  files.pgm = FormatPgm(Shades(grid));
  return files;
}

void WriteOccupancy(const OccupancyGrid& grid, const std::string& path_without_ending) {
  const std::string image = std::filesystem::path(path_without_ending + ".pgm").filename().string();
  const OccupancyFiles files = FormatOccupancy(grid, image);
  WriteFile(path_without_ending + ".pgm", files.pgm);
  WriteFile(path_without_ending + ".yaml", files.yaml);
}

OccupancyGrid ReadOccupancy(const std::string& yaml_path) {
  const MapFile file(yaml_path);
  OccupancyGrid grid;
  grid.resolution = file.Number("resolution");
  if (!(grid.resolution > 0))
    file.RefuseValue("resolution", "expected a resolution above zero, in metres");
  grid.map_from_grid = file.Origin();
  const double occupied = file.Number("occupied_thresh", kOccupiedThreshold);
  const double free = file.Number("free_thresh", kFreeThreshold);
  if (!(free < occupied && free >= 0 && occupied <= 1))
    file.RefuseValue("free_thresh", "expected 0 <= free_thresh < occupied_thresh <= 1");
  const std::string mode = file.Mode();
  if (mode != "trinary" && mode != "scale")
    file.RefuseValue("mode", "expected the mode trinary or scale, found " + Printable(mode));
  const bool negate = file.Flag("negate");
  std::filesystem::path image = file.Text("image");
  if (image.is_relative()) image = std::filesystem::path(yaml_path).parent_path() / image;
  const GreyImage shades = ParseGreyImage(ReadFile(image.string()), image.string());
  grid.width = shades.width;
  grid.height = shades.height;
  grid.cells.reserve(shades.shades.size());
  for (std::size_t y = grid.height; y-- > 0;)
    for (std::size_t x = 0; x < grid.width; ++x) {
      const int shade = shades.shades[y * grid.width + x];
      const double occupancy = (negate ? shade : 255 - shade) / 255.0;
      grid.cells.push_back(occupancy > occupied ? Occupancy::kStructure
                           : occupancy < free   ? Occupancy::kFree
                                                : Occupancy::kUnknown);
    }
  return grid;
}

std::string FormatOccupancyPng(const OccupancyGrid& grid) { return FormatPng(Shades(grid)); }

}  // namespace graticule
