#include "graticule/io/cloud_files.hpp"

#include <gtest/gtest.h>
#include <lzf.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>

#include "graphs.hpp"
#include "graticule/io/cloud_write.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/sweep.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

PointCloud Grid() {
  PointCloud cloud;
  cloud.width = 3;
  cloud.height = 2;
  cloud.in_sensor = {{1, 2, 3}, {0.1f, -1e-3f, 1e5f}, kNoReturn, {4, -5, 6},
                     {7, 8, 9}, {1e-9f, 0, -0.0f}};
  // 0xff8000 as a float would be a number that is none, were its highest byte not 0.
  cloud.colours = {{255, 128, 0}, {1, 2, 3}, {0, 0, 0}, {255, 255, 255}, {9, 8, 7}, {128, 0, 255}};
  cloud.intensities = {0, 0.25f, 0.5f, 1, 2, 3e5f};
  cloud.labels = {0, 1, 2, 3, 4294967295u, 16777217u};
  return cloud;
}

void ExpectSame(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  ASSERT_EQ(a.Size(), b.Size());
  for (std::size_t i = 0; i < a.Size(); ++i)
    EXPECT_EQ(std::memcmp(a.in_sensor[i].data(), b.in_sensor[i].data(), 12), 0) << i;
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.intensities, b.intensities);
  EXPECT_EQ(a.labels, b.labels);
}

TEST(CloudFiles, ComeBackToTheBitWithAndWithoutColoursAndLabels) {
  const TemporaryDirectory directory;
  for (int kinds = 0; kinds < 8; ++kinds) {
    PointCloud cloud = Grid();
    if (!(kinds & 1)) cloud.colours.clear();
    if (!(kinds & 2)) cloud.intensities.clear();
    if (!(kinds & 4)) cloud.labels.clear();
    for (const char* name : {"a.pcd", "a.ply", "a.pcd.gz"}) {
      SCOPED_TRACE(name);
      WriteCloud(directory / name, cloud);
      ExpectSame(cloud, ReadCloud(directory / name));
    }
  }
}

TEST(CloudFiles, AreRefusedAtEveryLength) {
  for (const std::string& whole : {FormatPcd(Grid()), FormatPly(Grid())})
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const std::string_view cut = std::string_view(whole).substr(0, n);
      EXPECT_THROW(whole[0] == 'p' ? ParsePly(cut, "a.ply") : ParsePcd(cut, "a.pcd"), Error)
          << n << " bytes";
    }
}

const std::string kText =
    "# .PCD v.7\nVERSION .7\nFIELDS label y _ x rgb z normal\nSIZE 2 8 1 4 4 2 4\n"
    "TYPE I F U F F I F\nCOUNT 1 1 2 1 1 1 3\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
    "POINTS 2\nDATA ascii\n"
    "7 0.5 1 2 -1e-3 4.2108e+06 3 0 0 1\n"
    "-1 nan 1 2 1 nan 3 nan nan nan\n";

TEST(Pcd, ReadsFieldsInAnyOrderAndOfAnySize) {
  const PointCloud cloud = ParsePcd(kText, "a.pcd");
  ASSERT_EQ(cloud.Size(), 2u);
  EXPECT_EQ(cloud.in_sensor[0], Eigen::Vector3f(-1e-3f, 0.5f, 3));
  EXPECT_FALSE(cloud.in_sensor[1].allFinite());
  // 4.2108e+06, as PCL's own example has it, is the float of bits 0x4a8080e0.
  EXPECT_EQ(cloud.colours[0], (Rgb{0x80, 0x80, 0xe0}));
  EXPECT_EQ(cloud.labels, (std::vector<std::uint32_t>{7, 0}));
}

// x, y, z as doubles behind two bytes of padding, colours as numbers, a label of one byte.
std::string Interleaved(const PointCloud& cloud, bool is_compressed) {
  std::string columns[5];
  std::string rows;
  for (std::size_t i = 0; i < cloud.Size(); ++i) {
    std::string fields[5];
    fields[0] = "__";
    for (int k = 0; k < 3; ++k) {
      const double value = cloud.in_sensor[i][k];
      std::string bytes(8, '\0');
      std::memcpy(bytes.data(), &value, 8);
      fields[1] += bytes;
    }
    const Rgb& c = cloud.colours[i];
    AppendUnsigned(&fields[2], 0xff000000u | static_cast<unsigned>(c[0] << 16 | c[1] << 8 | c[2]));
    fields[3] = std::string(1, static_cast<char>(cloud.labels[i]));
    for (int k = 0; k < 4; ++k) rows += fields[k];
  }
  std::string text =
      "FIELDS _ x y z rgba label\nSIZE 1 8 8 8 4 1\nTYPE U F F F U U\nCOUNT 2 1 1 1 1 1\n"
      "WIDTH 3\nHEIGHT 2\nPOINTS 6\nDATA ";
  if (!is_compressed) return text + "binary\n" + rows;
  std::string by_field;
  const std::size_t sizes[] = {2, 8, 8, 8, 4, 1}, row = 31;
  for (std::size_t f = 0, at = 0; f < 6; at += sizes[f++])
    for (std::size_t i = 0; i < cloud.Size(); ++i) by_field += rows.substr(row * i + at, sizes[f]);
  std::string packed(by_field.size(), '\0');
  packed.resize(lzf_compress(by_field.data(), static_cast<unsigned>(by_field.size()), packed.data(),
                             static_cast<unsigned>(packed.size())));
  EXPECT_GT(packed.size(), 0u);
  text += "binary_compressed\n";
  AppendUnsigned(&text, static_cast<std::uint32_t>(packed.size()));
  AppendUnsigned(&text, static_cast<std::uint32_t>(by_field.size()));
  return text + packed;
}

TEST(Pcd, ReadsBinaryAndCompressedPoints) {
  PointCloud cloud = Grid();
  cloud.intensities.clear();
  cloud.labels = {1, 2, 3, 4, 5, 255};
  for (const bool is_compressed : {false, true}) {
    const std::string whole = Interleaved(cloud, is_compressed);
    ExpectSame(cloud, ParsePcd(whole, "a.pcd"));
    ExpectSame(cloud, ParsePcd(whole + "what PCL leaves", "a.pcd"));
    for (std::size_t n = 0; n < whole.size(); ++n)
      EXPECT_THROW(ParsePcd(std::string_view(whole).substr(0, n), "a.pcd"), Error) << n;
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Pcd, SaysWhatIsWrongAndWhere) {
  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"WIDTH 2", "WIDTH 1000000000", "a.pcd:10:8: expected 1000000000 x 1 points, found 2"},
      {"POINTS 2\n", "", ""},  // may be left out
      {"HEIGHT 1", "HEIGHT 99999999999", "a.pcd:8:8: expected the height up to 1000000000"},
      {"POINTS 2", "POINTS 3", "a.pcd:10:8: expected 2 x 1 points, found 3"},
      {"_ x rgb", "_ w rgb", "a.pcd:11:1: there is no field 'x'"},
      {"normal", "rgba", "a.pcd:11:1: expected one number of 'rgba', found 3"},
      {"label y", "y y", "a.pcd:11:1: 'y' and 'y' are one field"},
      {"SIZE 2 8", "SIZE 2 7", "a.pcd:4:8: expected a field of 1, 2, 4 or 8 bytes, found 7"},
      {"SIZE 2 8", "SIZE 8", "a.pcd:4:17: expected"},
      {"TYPE I F", "TYPE I X", "a.pcd:5:8: expected a type I, U or F, found 'X'"},
      {"DATA ascii", "DATA zip", "a.pcd:11:6: expected ascii, binary or binary_compressed"},
      {"nan 1 2", "1e10 1 2", "a.pcd:13:1: expected a coordinate within 1e9 m, found 1e+10"},
      {"nan 1 2", "east 1 2", "a.pcd:13:4: expected a number (y), found 'east'"},
      {"-1 nan", "#", "a.pcd:13:1: expected a number (label), found '#'"},
      {"-1 nan 1 2 1 nan 3 nan nan nan\n", "", "a.pcd:13:1: the file is too short for 2 points"},
      {"nan nan nan\n", "nan nan nan\n1", "a.pcd:14:1: expected the end of the file"},
      {"VERSION .7", "VERTICES 2", "a.pcd:2:1: expected a line of a PCD header"},
  };
  for (const auto& broken : cases) {
    SCOPED_TRACE(broken.to);
    const std::string text = Replaced(kText, broken.from, broken.to);
    if (!*broken.message) {
      EXPECT_NO_THROW(ParsePcd(text, "a.pcd"));
      continue;
    }
    const std::string message = MessageOf([&] { ParsePcd(text, "a.pcd"); });
    EXPECT_EQ(message.substr(0, std::strlen(broken.message)), broken.message);
  }
}

TEST(Pcd, RefusesSizesThatTheFileDoesNotHold) {
  const std::string compressed = Interleaved(Grid(), true);
  const std::size_t begin = compressed.find("compressed\n") + 11;
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string bytes, whole = compressed;
    AppendUnsigned(&bytes, value);
    whole.replace(begin + at, 4, bytes);
    return MessageOf([&] { ParsePcd(whole, "a.pcd"); });
  };
  EXPECT_NE(with(0, 0xffffffffu).find("the file is cut short: expected 4294967295 packed bytes"),
            std::string::npos);
  EXPECT_NE(with(0, 1).find("so few packed bytes"), std::string::npos);
  EXPECT_NE(with(4, 0xffffffffu).find("expected 186 bytes when unpacked, found 4294967295"),
            std::string::npos);
  std::string damaged = compressed;
  damaged[begin + 8] = '\x7f';
  EXPECT_NE(MessageOf([&] { ParsePcd(damaged, "a.pcd"); }).find("are damaged"), std::string::npos);
}

std::string Ply(const std::string& format, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement camera 1\nproperty list uchar short views\n"
         "property float f\nelement vertex 2\nproperty double x\nproperty float z\n"
         "property ushort red\nproperty uchar green\nproperty float blue\nproperty int label\n"
         "property short y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         body;
}

TEST(PlyFile, ReadsTextAndBothByteOrdersAmongOtherElements) {
  const std::string text = Ply("ascii",
                               "2 7 8 1.5\n0.5 2 65535 255 0.5 -3 -7\nnan 1 0 0 0 12 1\n"
                               "3 0 1 0\n");
  // The same, byte by byte.
  const auto binary = [](bool is_big) {
    std::string bytes;
    const auto append = [&](auto value) {
      char at[sizeof(value)];
      std::memcpy(at, &value, sizeof(value));
      for (std::size_t i = 0; i < sizeof(value); ++i)
        bytes += at[is_big ? sizeof(value) - 1 - i : i];
    };
    append(std::uint8_t{2}), append(std::int16_t{7}), append(std::int16_t{8}), append(1.5f);
    append(0.5), append(2.0f), append(std::uint16_t{65535}), append(std::uint8_t{255});
    append(0.5f), append(std::int32_t{-3}), append(std::int16_t{-7});
    append(std::nan("")), append(1.0f), append(std::uint16_t{0}), append(std::uint8_t{0});
    append(0.0f), append(std::int32_t{12}), append(std::int16_t{1});
    append(std::uint8_t{3});
    for (const std::int32_t index : {0, 1, 0}) append(index);
    return Ply(is_big ? "binary_big_endian" : "binary_little_endian", bytes);
  };
  for (const std::string& whole : {text, binary(false), binary(true)}) {
    const PointCloud cloud = ParsePly(whole, "a.ply");
    ASSERT_EQ(cloud.Size(), 2u);
    EXPECT_EQ(cloud.in_sensor[0], Eigen::Vector3f(0.5f, -7, 2));
    EXPECT_FALSE(cloud.in_sensor[1].allFinite());
    EXPECT_EQ(cloud.colours[0], (Rgb{255, 255, 128}));
    EXPECT_EQ(cloud.labels, (std::vector<std::uint32_t>{0, 12}));
    if (whole == text) continue;  // cut between words a text is a shorter text
    for (std::size_t n = 0; n < whole.size(); ++n)
      EXPECT_THROW(ParsePly(std::string_view(whole).substr(0, n), "a.ply"), Error) << n;
  }
  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"ascii 1.0", "ascii 2.0", "a.ply:2:14: expected version 1.0, found '2.0'"},
      {"vertex 2", "vertex 4000000000", "a.ply:22:1: the file is too short for 4000000000"},
      {"vertex 2", "vertex 5000000000", "a.ply:7:16: expected at most 2^32 - 1"},
      {"vertex 2", "vertex 0", "a.ply:17:1: there is no point in this cloud"},
      {"comment by hand", "obj_info num_cols 3", "a.ply:17:1: expected num_cols x num_rows"},
      {"double x", "quad x", "a.ply:8:10: expected a type of PLY such as float or uchar"},
      {"property double x", "property list uchar int x", "a.ply:8:25: expected numbers of a"},
      {"uchar green", "uchar alpha", "a.ply:17:1: expected red, green and blue"},
      {"3 0 1 0\n", "", "a.ply:21:1: expected 1 of element 'face', found 0"},
      {"ply\n", "plx\n", "a.ply:1:1: expected 'ply' (the first line)"},
  };
  for (const auto& broken : cases) {
    SCOPED_TRACE(broken.to);
    const std::string message =
        MessageOf([&] { ParsePly(Replaced(text, broken.from, broken.to), "a.ply"); });
    EXPECT_EQ(message.substr(0, std::strlen(broken.message)), broken.message);
  }
}

// Three beams of a tenth of a turn each, in the file's order, with returns missing.
TEST(Spinning, BeamsBecomeRowsAndAzimuthsColumns) {
  PointCloud scan;
  const auto add = [&](int beam, int column) {
    const double azimuth = (column + 0.5) * 2 * M_PI / 100, elevation = -0.1 * beam;
    scan.in_sensor.emplace_back(static_cast<float>(std::cos(azimuth) * std::cos(elevation)),
                                static_cast<float>(std::sin(azimuth) * std::cos(elevation)),
                                static_cast<float>(std::sin(elevation)));
    scan.labels.push_back(static_cast<std::uint32_t>(1 + 100 * beam + column));
  };
  for (int beam = 0; beam < 3; ++beam)
    for (int column = 0; column < 100; ++column)
      if ((column + beam) % 7 != 0) add(beam, column);
  scan.width = scan.Size();
  const auto expect_grid = [&](const PointCloud& grid) {
    EXPECT_EQ(grid.height, 3u);
    ASSERT_EQ(grid.width, 100u);
    for (std::size_t cell = 0; cell < 300; ++cell) {
      // Clockwise from straight behind.
      const std::size_t beam = cell / 100, column = (149 - cell % 100) % 100;
      const bool is_there = (column + beam) % 7 != 0;
      EXPECT_EQ(grid.labels[cell], is_there ? 1 + 100 * beam + column : 0) << cell;
      EXPECT_EQ(grid.in_sensor[cell].allFinite(), is_there) << cell;
    }
  };
  expect_grid(OrganiseSpinning(scan, {3}));
  // In no order: by elevation.
  std::reverse(scan.in_sensor.begin(), scan.in_sensor.end());
  std::reverse(scan.labels.begin(), scan.labels.end());
  expect_grid(OrganiseSpinning(scan, {3}));
}

TEST(Spinning, RefusesAFileThatWasCutShort) {
  std::string bytes;
  for (int i = 0; i < 8; ++i) AppendFloat(&bytes, 1);
  for (std::size_t n = 0; n < bytes.size(); ++n)
    if (n != 16) {
      EXPECT_THROW(ParseKittiScan(std::string_view(bytes).substr(0, n), "a.bin"), Error) << n;
    }
  bytes[3] = '\x7e';
  EXPECT_EQ(MessageOf([&] { ParseKittiScan(bytes, "a.bin"); }),
            "a.bin: at byte 0: point 0: expected a coordinate within 1e9 m, found 8.50706e+37");
}

TEST(SweptScans, ArePlacedByTheServoAndComeBackToTheBit) {
  const std::string text =
      "# nodding\naxis,0,1,0\nservo_from_laser,0.1,0,0.05,0,0,0,1\n"
      "stamp_s,servo_rad,first_bearing_rad,bearing_step_rad,range_m...\n"
      "0.5,0,-0.5,0.5,1,2,nan\n0.6,0.5,-0.5,0.5,0,2,inf\n";
  const Sweep sweep = ParseSweep(text, "a.csv");
  const PointCloud cloud = ToCloud(sweep);
  EXPECT_EQ(cloud.width, 3u);
  EXPECT_EQ(cloud.height, 2u);
  EXPECT_LT(
      (cloud.in_sensor[0] - Eigen::Vector3f(0.1f + std::cos(0.5f), -std::sin(0.5f), 0.05f)).norm(),
      1e-6f);
  // About y by phi: x goes down.
  const float x = 2.1f, z = 0.05f, c = std::cos(0.5f), s = std::sin(0.5f);
  EXPECT_LT((cloud.in_sensor[4] - Eigen::Vector3f(c * x + s * z, 0, c * z - s * x)).norm(), 1e-6f);
  for (const std::size_t missing : {2, 3, 5}) EXPECT_FALSE(cloud.in_sensor[missing].allFinite());
  const std::string once = FormatSweep(sweep);
  EXPECT_EQ(FormatSweep(ParseSweep(once, "b.csv")), once);

  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"2,inf", "2", "a.csv:6:20: expected 3 ranges as in the scans before, found 2"},
      {"0.6,", "0.4,", "a.csv:6:1: expected a stamp not before the last scan's"},
      {"1,2,nan", "-1,2,nan", "a.csv:5:16: expected a range from 0 to 1e6 m"},
      {"axis,0,1", "axis,0,2", "a.csv:2:10: expected an axis of length 1"},
      {"0,0,0,1\n", "0,0,1,1\n", "a.csv:3:35: expected a unit quaternion"},
      {"0.5,1,2,nan", "0.5", "a.csv:5:12: expected at least one range"},
      {"0.5,1,2,nan\n0.6", "nan,1,2,nan\n0.6",
       "a.csv:5:12: expected a finite number (the step of the bearing), found 'nan'"},
  };
  for (const auto& broken : cases) {
    SCOPED_TRACE(broken.to);
    const std::string message =
        MessageOf([&] { ParseSweep(Replaced(text, broken.from, broken.to), "a.csv"); });
    EXPECT_EQ(message.substr(0, std::strlen(broken.message)), broken.message);
  }
  for (const std::size_t n : {text.size() - 1, text.size() - 3, text.find("0.5,0")})
    EXPECT_THROW(ParseSweep(text.substr(0, n), "a.csv"), Error) << n;
}

TEST(CloudFiles, WithoutAReturnOrOfAnUnknownEndingAreRefused) {
  const TemporaryDirectory directory;
  PointCloud cloud = Grid();
  for (Eigen::Vector3f& point : cloud.in_sensor) point = kNoReturn;
  WriteCloud(directory / "none.ply", cloud);
  EXPECT_NE(MessageOf([&] {
              ReadCloud(directory / "none.ply");
            }).find("none.ply: all 6 points are without a return"),
            std::string::npos);
  EXPECT_THROW(ReadCloud(directory / "a.las"), Error);
  EXPECT_THROW(WriteCloud(directory / "a.csv", cloud), Error);
  cloud.colours.pop_back();
  EXPECT_THROW(WriteCloud(directory / "a.ply", cloud), Error);
  EXPECT_FALSE(fs::exists(directory / "a.ply"));
}

TEST(RecordedClouds, AreReadAndWrittenAgain) {
  const fs::path data = fs::path(GRATICULE_DATA_DIR) / "segment";
  GRATICULE_NEEDS_DATA();
  int pcds = 0, scans = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    const std::string path = entry.path().string(), ending = entry.path().extension().string();
    SCOPED_TRACE(path);
    if (ending == ".pcd") {
      const PointCloud cloud = ReadCloud(path);
      EXPECT_EQ(cloud.width, 640u);
      EXPECT_EQ(cloud.height, 480u);
      EXPECT_EQ(cloud.colours.size(), cloud.Size());
      EXPECT_EQ(cloud.labels.size(), path.find("mosd") == std::string::npos ? 0 : cloud.Size());
      // Its README: label 0 is what has no return, and no more than that.
      for (std::size_t i = 0; i < cloud.labels.size(); ++i)
        EXPECT_TRUE(cloud.in_sensor[i].allFinite() || cloud.labels[i] == 0) << i;
      if (pcds++ == 0) ExpectSame(cloud, ParsePly(FormatPly(cloud), "again.ply"));
    } else if (ending == ".bin") {
      const PointCloud flat = ParseKittiScan(ReadFile(path), path);
      const PointCloud grid = OrganiseSpinning(flat);
      EXPECT_EQ(grid.height, 64u);
      EXPECT_NEAR(static_cast<double>(grid.width), 2140, 40);  // 10 Hz: a step is 0.17 degrees
      std::size_t returns = 0;
      for (const Eigen::Vector3f& point : grid.in_sensor) returns += point.allFinite();
      EXPECT_EQ(returns, flat.Size());
      ++scans;
    }
  }
  EXPECT_GE(pcds, 16);
  EXPECT_EQ(scans, 3);
}

}  // namespace
}  // namespace graticule
