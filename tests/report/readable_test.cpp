#include "graticule/io/readable.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace graticule {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Readable, WritesNumbersAsPeopleDo) {
  EXPECT_EQ(ReadableNumber(0), "0");
  EXPECT_EQ(ReadableNumber(1.23456), "1.235");
  EXPECT_EQ(ReadableNumber(-1.5e-7), "-1.5e-7");
  EXPECT_EQ(ReadableNumber(52100.4), "52100");
  EXPECT_EQ(ReadableNumber(2.5e16), "2.5e16");
  EXPECT_EQ(ReadableNumber(1e100), "1e100");
  EXPECT_EQ(ReadableNumber(kNan), "–");
  EXPECT_EQ(ReadableCount(1234567), "1,234,567");
  EXPECT_EQ(ReadableCount(999), "999");
}

TEST(Readable, ChoosesTheUnit) {
  EXPECT_EQ(ReadableSeconds(12.5e-6), "12.5 µs");
  EXPECT_EQ(ReadableSeconds(0.00125), "1.25 ms");
  EXPECT_EQ(ReadableSeconds(0.9999), "1.00 s");
  EXPECT_EQ(ReadableSeconds(725), "12 min 5 s");
  EXPECT_EQ(ReadableSeconds(kNan), "–");
  EXPECT_EQ(ReadableBytes(0), "–");
  EXPECT_EQ(ReadableBytes(1310720), "1.25 MiB");
  EXPECT_EQ(ReadableBytes(3ull << 30), "3.00 GiB");
  EXPECT_EQ(ReadableGap(0.0012), "+0.12 %");
  EXPECT_EQ(ReadableGap(-3.4e-9), "-3.4e-9");
}

TEST(Readable, CountsColumnsNotBytes) {
  EXPECT_EQ(DisplayWidth("abc"), 3u);
  EXPECT_EQ(DisplayWidth("µs –"), 4u);
  EXPECT_EQ(DisplayWidth("長い"), 4u);
  EXPECT_EQ(DisplayWidth("e\xcc\x81"), 1u);  // a combining accent
  EXPECT_EQ(DisplayWidth("\xff\xff"), 2u);
}

}  // namespace
}  // namespace graticule
