#include "graticule/io/chart.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "graticule/io/phase_chart.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/svg.hpp"
#include "markup.hpp"
#include "png.hpp"

namespace graticule {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Axis, PutsRoundNumbersAroundTheBounds) {
  const plot::Axis axis = plot::LinearAxis(0.3, 9.7, 5);
  EXPECT_EQ(axis.low, 0);
  EXPECT_EQ(axis.high, 10);
  ASSERT_GE(axis.ticks.size(), 2u);
  EXPECT_EQ(axis.ticks.front().label, "0");
  EXPECT_EQ(axis.ticks.back().label, "10");
}

TEST(Axis, LabelsNeighboursApart) {
  for (const double offset : {0.0, 1.0, 1e3, 1e8, -1e-9})
    for (const double width : {1e-3, 1.0, 7e5}) {
      const plot::Axis axis = plot::LinearAxis(offset, offset + width, 6);
      EXPECT_LE(axis.low, offset + 1e-9 * width);
      EXPECT_GE(axis.high, offset + width * (1 - 1e-9));
      EXPECT_LE(axis.ticks.size(), 12u);
      for (std::size_t i = 1; i < axis.ticks.size(); ++i)
        EXPECT_NE(axis.ticks[i].label, axis.ticks[i - 1].label) << offset << " " << width;
    }
}

TEST(Axis, HasDecadesWhereItIsLogarithmic) {
  const plot::Axis axis = plot::LogAxis(3e-12, 4e5, 6);
  EXPECT_NEAR(axis.low, 2e-12, 1e-18);
  EXPECT_NEAR(axis.high, 5e5, 1e-3);
  std::size_t labels = 0;
  for (const plot::Tick& tick : axis.ticks) labels += tick.label.empty() ? 0 : 1;
  EXPECT_GE(labels, 4u);
  EXPECT_LE(labels, 8u);
  EXPECT_NEAR(axis.Place(axis.high), 1, 1e-12);
}

TEST(Chart, DrawsCurvesWithNamesAndUnits) {
  CurveChart chart;
  chart.title = "Two <methods>";
  chart.x_label = "time [s]";
  chart.y_label = "cost";
  chart.curves = {{"lm & co", {{0, 1e6}, {1, 100}, {2, kNan}, {3, 1}}}, {"gn", {{0, 1e6}, {1, 1}}}};
  const std::string svg = DrawCurves(chart);
  EXPECT_EQ(test::TagFault(svg), "");
  EXPECT_NE(svg.find("lm &amp; co"), std::string::npos);
  EXPECT_NE(svg.find("time [s]"), std::string::npos);
  EXPECT_NE(svg.find(">10000<"), std::string::npos) << "a range above 100 is logarithmic";
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_GT(test::ReadPng(PngFromSvg(svg, 800)).Colours(), 10u);
  EXPECT_EQ(svg, DrawCurves(chart));
}

TEST(Chart, DrawsWhatHasNoExtent) {
  for (const Curve& curve :
       {Curve{"none", {}}, Curve{"one", {{0, 0}}}, Curve{"flat", {{0, 5}, {1, 5}}},
        Curve{"wild", {{kNan, kInfinity}, {-1, -kInfinity}}},
        Curve{"huge", {{0, 1e300}, {1, -1e300}}}})
    for (const AxisScale scale :
         {AxisScale::kAutomatic, AxisScale::kLinear, AxisScale::kLogarithmic}) {
      CurveChart chart;
      chart.whole_x = true;
      chart.x_scale = chart.y_scale = scale;
      chart.curves = {curve};
      const std::string svg = DrawCurves(chart);
      EXPECT_EQ(test::TagFault(svg), "") << curve.name;
      EXPECT_NO_THROW(PngFromSvg(svg, 300)) << curve.name;
    }
  EXPECT_NO_THROW(PngFromSvg(DrawBars({}), 300));
}

TEST(Chart, DrawsPointsAloneWhereThatIsAskedFor) {
  CurveChart chart;
  chart.curves.resize(1);
  for (int i = 0; i < 100; ++i) chart.curves[0].points.push_back({1. * i, 1. * (i % 7)});
  const std::string line = DrawCurves(chart);
  EXPECT_EQ(test::Count(line, "<circle"), 0u);  // too many for marks on a line
  chart.curves[0].dots = true;
  const std::string dots = DrawCurves(chart);
  EXPECT_EQ(test::Count(dots, "<circle"), 100u);
  EXPECT_EQ(test::Count(dots, "<path") + 1, test::Count(line, "<path"));
}

TEST(Chart, StacksPhasesAndLeavesOutThoseThatTookNoTime) {
  Timing timing;
  timing.load.wall = 0.1;
  timing.solve.wall = 0.5;
  timing.evaluate = 0.2;
  timing.total.wall = 0.7;
  const std::string svg = DrawPhases("Time", {{"lm", timing}}, 600);
  EXPECT_EQ(test::TagFault(svg), "");
  EXPECT_NE(svg.find("rest of solve: 300 ms"), std::string::npos);
  EXPECT_NE(svg.find("other: 100 ms"), std::string::npos);
  EXPECT_NE(svg.find(">700 ms<"), std::string::npos);
  EXPECT_EQ(svg.find("write"), std::string::npos);
}

}  // namespace
}  // namespace graticule
