#include "graticule/io/occupancy.hpp"

#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "graticule/io/document.hpp"
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

double NumberOr(const DocumentNode& root, const char* name, double otherwise) {
  const DocumentNode* node = root.Find(name);
  return node ? node->Number() : otherwise;
}

PlanarPose OriginOf(const DocumentNode& root) {
  const DocumentNode& node = root.Member("origin");
  if (!node.IsList() || (node.values.size() != 3 && node.values.size() != 2))
    node.Fail("expected the origin as [x, y, yaw]");
  const std::vector<double> origin = node.Numbers();
  return {origin[0], origin[1], origin.size() == 3 ? origin[2] : 0};
}

// 0 or 1; also a word for it, as YAML has it.
bool IsNegated(const DocumentNode& root) {
  const DocumentNode* node = root.Find("negate");
  if (!node) return false;
  bool flag = false;
  if (YAML::convert<bool>::decode(YAML::Node(node->Scalar()), flag)) return flag;
  return node->Number() != 0;
}

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
  const DocumentNode root = ParseYaml(ReadFile(yaml_path), yaml_path);
  if (!root.IsMap()) root.Fail("expected a mapping: image, resolution, origin, ...");
  OccupancyGrid grid;
  const DocumentNode& resolution = root.Member("resolution");
  grid.resolution = resolution.Number();
  if (!(grid.resolution > 0)) resolution.Fail("expected a resolution above zero, in metres");
  grid.map_from_grid = OriginOf(root);
  const double occupied = NumberOr(root, "occupied_thresh", kOccupiedThreshold);
  const double free = NumberOr(root, "free_thresh", kFreeThreshold);
  if (!(free < occupied && free >= 0 && occupied <= 1)) {
    const DocumentNode* place = root.Find("free_thresh");
    (place ? *place : root).Fail("expected 0 <= free_thresh < occupied_thresh <= 1");
  }
  if (const DocumentNode* mode = root.Find("mode"))
    if (mode->Scalar() != "trinary" && mode->Scalar() != "scale")
      mode->Fail("expected the mode trinary or scale, found " + Printable(mode->Scalar()));
  const bool negate = IsNegated(root);
  const DocumentNode& name = root.Member("image");
  if (name.Scalar().empty()) name.Fail("expected a value of 'image'");
  std::filesystem::path image = name.Scalar();
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
