#include "graticule/io/g2o_laser.hpp"

#include <gtest/gtest.h>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

const std::string kVertex = "VERTEX_SE2 7 1 2 0.5\n";
const std::string kSweep =
    "ROBOTLASER1 0 -1.5 3 0.75 50 0.1 0 4 1.25 2 50 0.5 1 9 1.2 2 0.5 1 2 0.5 0 0 0 0 0 12.5 host "
    "13\n";

G2oLaser Parse(const std::string& text) { return ParseG2oLaser(text, "a.g2o"); }

TEST(G2oLaser, IsReadBesideItsVertices) {
  const G2oLaser laser =
      Parse(kVertex + kSweep + "EDGE_SE2 7 8 1 0 0 1 0 0 1 0 1\nVERTEX_SE2 8 3 4 0\n" + kSweep);
  ASSERT_EQ(laser.log.scans.size(), 2u);
  EXPECT_EQ(laser.vertices, (std::vector<std::uint64_t>{7, 8}));
  EXPECT_EQ(laser.world_from_robot[1].y, 4);
  ASSERT_EQ(laser.log.geometries.size(), 1u);
  const LaserGeometry& geometry = laser.log.geometries[0];
  EXPECT_EQ(geometry.first_angle, -1.5);
  EXPECT_EQ(geometry.step, 0.75);
  EXPECT_EQ(geometry.max_range, 50);
  // The laser is 0.2 m along x of the world from a robot that looks along yaw 0.5.
  EXPECT_NEAR(geometry.robot_from_laser.x, 0.2 * std::cos(0.5), 1e-12);
  EXPECT_NEAR(geometry.robot_from_laser.y, -0.2 * std::sin(0.5), 1e-12);
  const LaserScan& scan = laser.log.scans[1];
  EXPECT_EQ(scan.line, 5u);
  EXPECT_EQ(laser.log.scans[0].line, 2u);
  EXPECT_EQ(scan.time, 12.5);
  EXPECT_EQ(scan.odom_from_robot.x, 1);
  const Span<const float> ranges = laser.log.RangesOf(scan);
  EXPECT_EQ(std::vector<float>(ranges.begin(), ranges.end()),
            (std::vector<float>{1.25f, 2, 50, 0.5f}));
}

TEST(G2oLaser, RefusesWhatIsBroken) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      Parse(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(kSweep).find("a.g2o:1:1: expected a VERTEX_SE2"), std::string::npos);
  EXPECT_NE(message(kVertex + kSweep + kSweep).find("a.g2o:3:1: expected one"), std::string::npos);
  EXPECT_NE(message(kVertex).find("no ROBOTLASER1"), std::string::npos);
  EXPECT_NE(message("").find("no ROBOTLASER1"), std::string::npos);
  std::string text = kVertex + kSweep;
  text.replace(text.find("1.25"), 4, "nan");
  EXPECT_NE(message(text).find("a.g2o:2:"), std::string::npos);
  text = kVertex + kSweep;
  text.replace(text.find(" 4 1.25"), 2, " 5");
  EXPECT_NE(message(text).find("a.g2o:2:"), std::string::npos);
  text = kVertex + kSweep;
  text.replace(text.find("0.75"), 4, "-0.1");
  EXPECT_NE(message(text).find("step above 0"), std::string::npos);
  // Cut anywhere inside the sweep: its last word may be a number cut short.
  text = kVertex + kSweep;
  for (std::size_t n = 0; n + 3 < text.size(); ++n)
    EXPECT_NE(message(text.substr(0, n)), "") << n << " bytes";
}

}  // namespace
}  // namespace graticule
