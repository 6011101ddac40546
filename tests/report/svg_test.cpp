#include "graticule/io/svg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "graticule/solver/error.hpp"
#include "markup.hpp"
#include "png.hpp"

namespace graticule {
namespace {

TEST(Svg, WritesNumbersShort) {
  EXPECT_EQ(SvgNumber(0), "0");
  EXPECT_EQ(SvgNumber(-0.0004), "0");
  EXPECT_EQ(SvgNumber(1.25), "1.25");
  EXPECT_EQ(SvgNumber(-0.5), "-.5");
  EXPECT_EQ(SvgNumber(0.0507), ".051");
  EXPECT_EQ(SvgNumber(1200), "1200");
  EXPECT_EQ(SvgNumber(std::numeric_limits<double>::quiet_NaN()), "0");
}

TEST(Svg, EscapesMarkupControlCharactersAndBrokenText) {
  EXPECT_EQ(EscapeXml("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(EscapeXml("χ² – ✓"), "χ² – ✓");
  EXPECT_EQ(EscapeXml(std::string_view("a\0b", 3)),
            "a\xef\xbf\xbd"
            "b");
  EXPECT_EQ(EscapeXml("\xff"), "\xef\xbf\xbd");
  EXPECT_EQ(EscapeXml("\xe2\x82"), "\xef\xbf\xbd\xef\xbf\xbd");  // cut short
  EXPECT_EQ(EscapeXml("\xc0\xbc"), "\xef\xbf\xbd\xef\xbf\xbd");  // an overlong '<'
}

TEST(Svg, KeepsPathsShort) {
  PathData path(1);
  path.MoveTo(1, 2);
  path.LineTo(1.5, 2);
  path.LineTo(1.51, 2.01);  // rounds to nothing
  path.LineTo(0, 10);
  path.MoveTo(0, 0);
  path.LineTo(1, 1);
  EXPECT_EQ(path.Data(), "m1 2 .5 0-1.5 8m0-10 1 1");
}

TEST(Svg, DoesNotAddUpRounding) {
  PathData path(1);
  path.MoveTo(0, 0);
  for (int i = 1; i <= 1000; ++i) path.LineTo(i * 0.04, 0);
  double x = 0;
  std::string data = path.Data().substr(4);
  for (char* at = data.data(); *at;) {
    x += std::strtod(at, &at);
    EXPECT_EQ(std::strtod(at, &at), 0);
  }
  EXPECT_NEAR(x, 40, 0.05);
}

TEST(Svg, BecomesAPngOfTheSizeThatWasAskedFor) {
  Svg svg(200, 100, "a \"drawing\"");
  svg.Rect(0, 0, 100, 100, {{"fill", "#ff0000"}}, "left <half>");
  svg.Text(10, 20, "50 < 60", {});
  const std::string document = svg.Finish();
  EXPECT_EQ(test::TagFault(document), "");
  const test::Picture picture = test::ReadPng(PngFromSvg(document, 400));
  EXPECT_EQ(picture.width, 400);
  EXPECT_EQ(picture.height, 200);
  EXPECT_EQ(picture.At(100, 150), 0xff0000u);
  EXPECT_EQ(picture.At(300, 150), 0xffffffu);
}

TEST(Svg, RefusesWhatCannotBecomeAPng) {
  EXPECT_THROW(PngFromSvg("", 100), Error);
  EXPECT_THROW(PngFromSvg("<html></html>", 100), Error);
  EXPECT_THROW(PngFromSvg(Svg(10, 10).Finish(), 0), Error);
  EXPECT_THROW(PngFromSvg(Svg(10, 10).Finish(), 40000), Error);
  EXPECT_THROW(PngFromSvg(Svg(1, 1000).Finish(), 100), Error);
}

}  // namespace
}  // namespace graticule
