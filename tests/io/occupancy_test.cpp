#include "graticule/io/occupancy.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/grey_image.hpp"

namespace graticule {
namespace {

OccupancyGrid Corner() {
  OccupancyGrid grid;
  grid.resolution = 0.05;
  grid.map_from_grid = {-1.25, 3.5, 0.1};
  grid.width = 3;
  grid.height = 2;
  using O = Occupancy;
  grid.cells = {O::kStructure, O::kFree, O::kUnknown,  // the lower row
                O::kFree,      O::kFree, O::kStructure};
  return grid;
}

TEST(Occupancy, ReadsBackWhatItWrote) {
  const TemporaryDirectory directory;
  WriteOccupancy(Corner(), directory / "map");
  const OccupancyGrid read = ReadOccupancy(directory / "map.yaml");
  EXPECT_EQ(read.resolution, 0.05);
  EXPECT_EQ(read.map_from_grid.x, -1.25);
  EXPECT_EQ(read.map_from_grid.y, 3.5);
  EXPECT_EQ(read.map_from_grid.yaw, 0.1);
  EXPECT_EQ(read.width, 3u);
  EXPECT_EQ(read.height, 2u);
  EXPECT_EQ(read.cells, Corner().cells);
}

TEST(Occupancy, WritesWhatMapServerReads) {
  const OccupancyFiles files = FormatOccupancy(Corner(), "map.pgm");
  EXPECT_EQ(files.yaml,
            "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1.25, 3.5, 0.1]\nnegate: "
            "0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
  // The top row first.
  EXPECT_EQ(files.pgm, std::string("P5\n3 2\n255\n\xfe\xfe\x00\x00\xfe\xcd", 17));
}

TEST(Occupancy, ReadsPngAndNegatedMapsOfOthers) {
  const TemporaryDirectory directory;
  WriteFile(directory / "map.png", FormatOccupancyPng(Corner()));
  WriteFile(directory / "map.yaml",
            "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\n"
            "free_thresh: 0.196\nnegate: 0\n");
  EXPECT_EQ(ReadOccupancy(directory / "map.yaml").cells, Corner().cells);
  WriteFile(directory / "inverse.pgm", "P2\n# white is occupied\n2 1\n255\n255 0\n");
  WriteFile(directory / "inverse.yaml",
            "image: inverse.pgm\nresolution: 1\norigin: [0, 0]\nnegate: true\n");
  const OccupancyGrid inverse = ReadOccupancy(directory / "inverse.yaml");
  EXPECT_EQ(inverse.At(0, 0), Occupancy::kStructure);
  EXPECT_EQ(inverse.At(1, 0), Occupancy::kFree);
}

TEST(Occupancy, SaysWhatIsWrongWithAMapFile) {
  const TemporaryDirectory directory;
  WriteOccupancy(Corner(), directory / "map");
  const std::string good = ReadFile(directory / "map.yaml");
  const auto refused = [&](const std::string& text) {
    WriteFile(directory / "bad.yaml", text);
    return MessageOf([&] { ReadOccupancy(directory / "bad.yaml"); });
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    return text.replace(text.find(from), from.size(), to);
  };
  const auto says = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(refused(with("resolution: 0.05", "resolution: 0")), "bad.yaml:3:13: expected a resolution");
  says(refused(with("resolution: 0.05", "resolution: .nan")), "bad.yaml:3:13: expected a number");
  says(refused(with("resolution: 0.05\n", "")), "bad.yaml:1:1: expected a member 'resolution'");
  says(refused(with("[-1.25, 3.5, 0.1]", "[1]")), "expected the origin as [x, y, yaw]");
  says(refused(with("trinary", "raw")), "expected the mode trinary or scale, found raw");
  says(refused(with("free_thresh: 0.196", "free_thresh: 0.9")), "free_thresh < occupied_thresh");
  says(refused(with("0.65\nfree_thresh: 0.196", "1.65")), "free_thresh < occupied_thresh");
  says(refused(with("map.pgm", "none.pgm")), "none.pgm");
  says(refused(good + "resolution: 7\n"), "'resolution' is there already");
  says(refused("image: ["), "not YAML");
  says(refused("7"), "expected a mapping");
}

TEST(GreyImage, RefusesAPictureThatWasCutShort) {
  const GreyImage image{3, 2, {0, 10, 20, 30, 40, 250}};
  for (const std::string& whole : {FormatPgm(image), FormatPng(image)}) {
    EXPECT_EQ(ParseGreyImage(whole, "a").shades, image.shades);
    // The last twelve bytes of a PNG are its end mark, without which all pixels are there.
    const std::size_t needed = whole[0] == 'P' ? whole.size() : whole.size() - 12;
    for (std::size_t size = 0; size < needed; ++size)
      EXPECT_THROW(ParseGreyImage(whole.substr(0, size), "a"), Error) << size;
  }
}

TEST(GreyImage, RefusesPromisesThatAFileDoesNotKeep) {
  for (const char* header : {"P5\n100000 100000\n255\n", "P5\n0 5\n255\n", "P5\n2 2\n0\n",
                             "P5\n2 2\n70000\n", "P2\n30000 30000\n255\n1 2", "P5 x", "P6\n1 1\n"})
    EXPECT_THROW(ParseGreyImage(header, "a.pgm"), Error) << header;
}

// A header of 16000 x 16000 pixels, and nothing behind it.
TEST(GreyImage, RefusesAPngOfFewBytesBeforeItMakesRoomForItsPixels) {
  std::string png = FormatPng({3, 2, {0, 10, 20, 30, 40, 250}});
  const std::string size("\0\0\x3e\x80\0\0\x3e\x80", 8);
  png.replace(16, 8, size);
  const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(png.data()) + 12, 17);
  for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(sum >> (24 - 8 * i));
  EXPECT_NE(MessageOf([&] { ParseGreyImage(png, "a.png"); }).find("promises 256000000 pixels"),
            std::string::npos);
}

TEST(GreyImage, ReadsSixteenBits) {
  const std::string text("P5\n2 1\n65535\n\xff\xff\x80\x00", 17);
  EXPECT_EQ(ParseGreyImage(text, "a.pgm").shades, (std::vector<std::uint8_t>{255, 128}));
}

}  // namespace
}  // namespace graticule
