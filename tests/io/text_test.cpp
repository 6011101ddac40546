#include "graticule/io/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "graphs.hpp"

namespace graticule {
namespace {

TEST(Text, ReadsWordsAndNumbersOfEitherLineEnding) {
  TextReader reader("\xEF\xBB\xBFpose 1 +2.5 -3e-2\r\n\r\n\tnext\t7", "a.txt");
  ASSERT_TRUE(reader.NextLine());
  EXPECT_EQ(reader.Word(), "pose");
  EXPECT_EQ(reader.Integer(nullptr), 1u);
  EXPECT_EQ(reader.Double(nullptr), 2.5);
  EXPECT_EQ(reader.Double(nullptr), -0.03);
  reader.ExpectEnd();
  ASSERT_TRUE(reader.NextLine());
  EXPECT_EQ(reader.Word(), "next");
  EXPECT_TRUE(reader.NextLine() == false || reader.Word() == "");
}

TEST(Text, LeavesALineThatWasNotReadToItsEnd) {
  TextReader reader("a b c\nd e\n", "a.txt");
  ASSERT_TRUE(reader.NextLine());
  EXPECT_EQ(reader.Word(), "a");
  ASSERT_TRUE(reader.NextLine());
  EXPECT_EQ(reader.Word(), "d");
  EXPECT_FALSE(reader.NextLine());
}

TEST(Text, SaysWhereAndWhatInItsErrors) {
  const auto refuse = [](std::string_view text) {
    return MessageOf([&] {
      TextReader reader(text, "slice.fg");
      reader.NextLine();
      reader.NextLine();
      reader.Word();
      reader.Double("the x of the vertex");
      reader.ExpectEnd();
    });
  };
  EXPECT_EQ(refuse("one\npose 0,9"),
            "slice.fg:2:6: expected a number (the x of the vertex), found '0,9'");
  EXPECT_EQ(refuse("one\npose nan\n"),
            "slice.fg:2:6: expected a finite number (the x of the vertex), found 'nan'");
  EXPECT_EQ(refuse("one\npose -inf\n"),
            "slice.fg:2:6: expected a finite number (the x of the vertex), found '-inf'");
  EXPECT_EQ(refuse("one\npose 1e999\n"),
            "slice.fg:2:6: expected a number that a double can hold (the x of the vertex), found "
            "'1e999'");
  EXPECT_EQ(refuse("one\npose\n"),
            "slice.fg:2:5: expected a number (the x of the vertex), found the end of the line");
  EXPECT_EQ(refuse("one\npose"),
            "slice.fg:2:5: expected a number (the x of the vertex), found the end of the file");
  EXPECT_EQ(refuse("one\npose 1 2"), "slice.fg:2:8: expected the end of the line, found '2'");
  EXPECT_EQ(refuse("one\npose +-1"),
            "slice.fg:2:6: expected a number (the x of the vertex), found '+-1'");
  EXPECT_EQ(refuse("one\npose \x1b[31m"),
            "slice.fg:2:6: expected a number (the x of the vertex), found '\\x1b[31m'");
}

TEST(Text, RefusesIntegersThatAreNone) {
  for (const char* text : {"-1", "1.5", "x", "1e3", "99999999999999999999", "1x", ""}) {
    TextReader reader(text, "a");
    EXPECT_THROW(reader.Integer("an id"), Error) << text;
  }
}

TEST(Text, TakesWhatIsTooSmallForADoubleAsZero) {
  for (const char* text :
       {"1e-999", "-1e-400", "+2E-500", "0.001e-330", "1234e-340", "1e-99999999999999999999"}) {
    TextReader reader(text, "a");
    EXPECT_EQ(reader.Double(nullptr), 0) << text;
  }
  // Too large, though the exponent is below zero.
  const std::string large = "1" + std::string(400, '0') + "e-50";
  TextReader reader(large, "a");
  EXPECT_THROW(reader.Double(nullptr), Error);
}

TEST(Text, ReadsItsOwnNumbersBackToTheBit) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t bits = random();
    double number = 0;
    std::memcpy(&number, &bits, sizeof(number));
    if (!std::isfinite(number)) continue;
    std::string text;
    AppendNumber(&text, number);
    TextReader reader(text, "a");
    const double back = reader.Double(nullptr);
    ASSERT_EQ(std::memcmp(&back, &number, sizeof(number)), 0) << text;
  }
}

TEST(Text, CutsLongWordsInErrors) {
  EXPECT_EQ(Quoted(std::string(1000, 'x')), "'" + std::string(60, 'x') + "...'");
}

}  // namespace
}  // namespace graticule
