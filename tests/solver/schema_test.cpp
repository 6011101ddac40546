#include "graticule/solver/schema.hpp"

#include <gtest/gtest.h>

#include "expect_error.hpp"

namespace graticule {
namespace {

TEST(Schema, IsReadAsItIsWritten) {
  for (const char* text :
       {"a:se2/1 b:se2/1 | x:m y:m yaw:rad", "pose:se3/1 | x:m qx | r", "cell:vector1/1* | loss:db",
        "a:point2/1 | m* | r", "a:point2/1 | m:m* | r:m*",
        "a:point2/1 b:point2/1* | | smooth:m/s^2", "x:vector12/3 | v"}) {
    EXPECT_EQ(ToString(ParseFactorSchema(text)), text);
    EXPECT_EQ(ToString(ParseFactorSchema(ToString(ParseFactorSchema(text)))), text);
  }
  EXPECT_EQ(ToString(ParseFactorSchema("  a:se2/1\tb:se2/1|x:m|r ")), "a:se2/1 b:se2/1 | x:m | r");
}

TEST(Schema, KnowsItsBlocksMeasurementAndResidual) {
  const FactorSchema schema = ParseFactorSchema("end:point2/1 cell:vector1/1* | a:db b*");
  ASSERT_EQ(schema.blocks.size(), 2u);
  EXPECT_EQ(schema.blocks[0].role, "end");
  EXPECT_EQ(schema.BlockType(0), "point2/1");
  EXPECT_EQ(schema.BlockType(1), "vector1/1");
  EXPECT_EQ(schema.BlockType(7), "vector1/1");
  EXPECT_FALSE(schema.AcceptsBlocks(1));
  EXPECT_TRUE(schema.AcceptsBlocks(2));
  EXPECT_TRUE(schema.AcceptsBlocks(9));
  EXPECT_FALSE(schema.AcceptsMeasurement(1));
  EXPECT_TRUE(schema.AcceptsMeasurement(2));
  EXPECT_TRUE(schema.AcceptsMeasurement(30));
  EXPECT_EQ(schema.measurement[0].unit, "db");
  EXPECT_TRUE(schema.repeats_last_residual) << "the residual is that of the measurement";
}

TEST(Schema, WithoutAStarTakesItsCountsOnly) {
  const FactorSchema schema = ParseFactorSchema("a:se2/1 | x y");
  for (std::size_t n = 0; n < 5; ++n) {
    EXPECT_EQ(schema.AcceptsBlocks(n), n == 1);
    EXPECT_EQ(schema.AcceptsMeasurement(n), n == 2);
  }
}

TEST(Schema, RefusesWhatIsNone) {
  for (const char* text :
       {"", "|", "| x", "a:se2/1", "a:se2/1 |", "a:se2/1 | x |", "a:se2 | x", "a:se2/0 | x",
        "a:se2/01 | x", "a | x", "a:se2/1* b:se2/1 | x", "a:se2/1 | x* y", "a:se2/1 | x:m:s",
        "a:se2/1 | :m", "a:se2/1 | x | y | z", "a:se2/1 | *", "* | x", "a:se2/1 | x-y"})
    EXPECT_THROW(ParseFactorSchema(text), Error) << text;
}

TEST(Fields, AreReadAsTheyAreWritten) {
  EXPECT_EQ(ToString(ParseFields("x:m y:m yaw:rad qw")), "x:m y:m yaw:rad qw");
  for (const char* text : {"", " ", "x*", "x:m y*", ":", "x:"})
    if (std::string(text) != "x:") {
      EXPECT_THROW(ParseFields(text), Error) << text;
    }
}

TEST(TypeName, IsAWordAndAVersion) {
  for (const char* name : {"se2/1", "vector17/1", "A_b9/999999"}) EXPECT_TRUE(IsTypeName(name));
  for (const char* name : {"", "se2", "se2/", "/1", "se2/0", "se2/1/1", "se2/1000000", "se 2/1",
                           "se2/-1", "se2/1a", "s\xc3\xa9/1"})
    EXPECT_FALSE(IsTypeName(name)) << name;
}

}  // namespace
}  // namespace graticule
