#include "graticule/io/gnss.hpp"

#include <gtest/gtest.h>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

std::string Refusal(const std::string& text) {
  try {
    ParseGnss(text, "a.csv");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Gnss, IsReadAndWrittenToTheBit) {
  const std::string text =
      "time,robot,latitude,longitude,height,sigma\n"
      "12.25,robot1,42.293000000000006,-83.711,259.1,1.5\n"
      "13,robot2,42.2931,-83.7111,260,0.02\n";
  const std::vector<GnssFix> fixes = ParseGnss(text, "a.csv");
  ASSERT_EQ(fixes.size(), 2u);
  EXPECT_EQ(fixes[0].time, 12.25);
  EXPECT_EQ(fixes[0].robot, "robot1");
  EXPECT_EQ(fixes[0].antenna.latitude, 42.293000000000006);
  EXPECT_EQ(fixes[1].antenna.longitude, -83.7111);
  EXPECT_EQ(fixes[1].antenna.height, 260);
  EXPECT_EQ(fixes[1].sigma_m, 0.02);
  EXPECT_EQ(fixes[1].line, 3u);
  EXPECT_EQ(FormatGnss(fixes), text);
}

TEST(Gnss, TakesBlanksAndComments) {
  const auto fixes = ParseGnss("# by hand\n\n 1 a 2 3 4 5\n2, b , 2,3, 4,5\n", "a.csv");
  ASSERT_EQ(fixes.size(), 2u);
  EXPECT_EQ(fixes[1].robot, "b");
  EXPECT_EQ(fixes[1].line, 4u);
}

TEST(Gnss, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(Refusal("").find("no fix"), std::string::npos);
  EXPECT_NE(Refusal("1,a,91,0,0,1\n").find("a.csv:1:5: expected -90 to 90"), std::string::npos);
  EXPECT_NE(Refusal("1,a,2,3,4,1\n1,a,2,999,0,1\n").find("a.csv:2:7:"), std::string::npos);
  EXPECT_NE(Refusal("1,a,2,3,4,0\n").find("above 0"), std::string::npos);
  EXPECT_NE(Refusal("1,a,2,3,4\n").find("the standard deviation"), std::string::npos);
  EXPECT_NE(Refusal("1,a,2,3,4,1,7\n").find("end of the line"), std::string::npos);
  EXPECT_NE(Refusal("1,a,2,nan,4,1\n").find("a.csv:1:7:"), std::string::npos);
}

}  // namespace
}  // namespace graticule
