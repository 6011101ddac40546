#include "graticule/problems/calibration/marker_codes.hpp"

#include <algorithm>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
}

namespace graticule {
namespace {

struct AprilTagFamily {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr AprilTagFamily kAprilTags[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
};

MarkerFamily FromAprilTag(const AprilTagFamily& source) {
  apriltag_family_t* const own = source.create();
  MarkerFamily family;
  family.name = source.name;
  family.cells = own->width_at_border - 2;
  family.markers = static_cast<int>(own->ncodes);
  family.correctable = std::min(2, (static_cast<int>(own->h) - 1) / 2);
  for (std::uint32_t i = 0; i < own->ncodes; ++i) {
    std::vector<std::uint8_t> code(static_cast<std::size_t>(family.cells * family.cells));
    for (std::uint32_t bit = 0; bit < own->nbits; ++bit) {
      const auto x = own->bit_x[bit] - 1, y = own->bit_y[bit] - 1;
      code[y * static_cast<std::uint32_t>(family.cells) + x] =
          (own->codes[i] >> (own->nbits - 1 - bit)) & 1;
    }
    family.codes.push_back(std::move(code));
  }
  source.destroy(own);
  return family;
}

struct ArucoName {
  std::string name;
  int cells, markers;
};

std::vector<ArucoName> ArucoNames() {
  std::vector<ArucoName> names;
  for (const int cells : {4, 5, 6, 7})
    for (const int markers : {50, 100, 250}) {
      const std::string side = std::to_string(cells);
      names.push_back(
          {"DICT_" + side + "X" + side + "_" + std::to_string(markers), cells, markers});
    }
  return names;
}

MarkerFamily FromAruco(const ArucoName& name) {
  MarkerFamily family;
  family.name = name.name;
  family.cells = name.cells;
  family.markers = name.markers;
  // DICT_4X4_250 has codes that differ in three cells only, the others' in more.
  family.correctable = name.cells == 4 ? 1 : 2;
  const int bits = name.cells * name.cells;
  for (int i = 0; i < name.markers; ++i) {
    const std::uint64_t packed = ArucoCodes(name.cells)[static_cast<std::size_t>(i)];
    std::vector<std::uint8_t> code;
    for (int bit = 0; bit < bits; ++bit) code.push_back((packed >> (bits - 1 - bit)) & 1);
    family.codes.push_back(std::move(code));
  }
  return family;
}

}  // namespace

std::vector<std::string> MarkerFamilyNames() {
  std::vector<std::string> names;
  for (const AprilTagFamily& family : kAprilTags) names.emplace_back(family.name);
  for (const ArucoName& name : ArucoNames()) names.push_back(name.name);
  return names;
}

MarkerFamily MarkerFamilyOf(std::string_view name) {
  for (const AprilTagFamily& family : kAprilTags)
    if (name == family.name) return FromAprilTag(family);
  for (const ArucoName& aruco : ArucoNames())
    if (name == aruco.name) return FromAruco(aruco);
  std::string message = "there is no family of markers " + Quoted(name) + "; expected one of";
  for (const std::string& known : MarkerFamilyNames()) message += " " + known;
  throw Error(message, ErrorKind::kUsage);
}

}  // namespace graticule
