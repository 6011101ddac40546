#include "graticule/io/graph_plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <limits>
#include <random>

#include "graticule/io/svg.hpp"
#include "graticule/solver/error.hpp"
#include "markup.hpp"
#include "png.hpp"

namespace graticule {
namespace {

using EdgeKind = GraphPlot::EdgeKind;

GraphPlot Ring(std::uint32_t poses) {
  GraphPlot graph;
  graph.title = "ring <script>";
  graph.groups = {"robot & co"};
  for (std::uint32_t i = 0; i < poses; ++i) {
    const double angle = 6.28 * i / poses;
    graph.after.push_back({10 * std::cos(angle), 10 * std::sin(angle), 0});
    graph.before.push_back({12 * std::cos(angle), 10 * std::sin(angle) + 1, 0});
    if (i > 0) graph.edges.push_back({i - 1, i, EdgeKind::kOdometry, 1, 3});
  }
  graph.edges.push_back({0, poses - 1, EdgeKind::kLoop, 300, 3});
  return graph;
}

TEST(GraphPlot, DrawsTenPosesBeforeAndAfter) {
  const std::string svg = DrawGraph(Ring(10));
  EXPECT_EQ(test::TagFault(svg), "");
  EXPECT_EQ(test::Count(svg, "<script"), 0u);
  EXPECT_NE(svg.find("Before"), std::string::npos);
  EXPECT_NE(svg.find("1 loop closures"), std::string::npos);
  EXPECT_NE(svg.find("robot &amp; co"), std::string::npos);
  EXPECT_NE(svg.find(" m</text>"), std::string::npos) << "the scale bar";
  const test::Picture picture = test::ReadPng(PngFromSvg(svg, 1200));
  EXPECT_EQ(picture.width, 1200);
  EXPECT_GT(picture.Colours(), 20u);
  EXPECT_EQ(svg, DrawGraph(Ring(10)));
}

TEST(GraphPlot, DrawsOnePanelWithoutABefore) {
  GraphPlot graph = Ring(10);
  graph.before.clear();
  const std::string svg = DrawGraph(graph);
  EXPECT_EQ(svg.find("Before"), std::string::npos);
  EXPECT_NE(svg.find("After"), std::string::npos);
}

TEST(GraphPlot, DrawsTheWorstClosuresLast) {
  GraphPlot graph = Ring(10);
  graph.before.clear();
  graph.edges.push_back({2, 7, EdgeKind::kLoop, 0.1, 3});
  const std::string svg = DrawGraph(graph);
  const std::size_t good = svg.find("\"pr0\""), trajectory = svg.find("<path class=\"ps0\"");
  const std::size_t bad = svg.rfind("<path class=\"pr");
  ASSERT_NE(good, std::string::npos);
  EXPECT_LT(good, trajectory);
  EXPECT_LT(trajectory, bad);
}

TEST(GraphPlot, DrawsOddGraphs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GraphPlot graph;
  EXPECT_NO_THROW(PngFromSvg(DrawGraph(graph), 300)) << "empty";
  graph.after = {{5, 5, 0}};
  EXPECT_NO_THROW(PngFromSvg(DrawGraph(graph), 300)) << "one point";
  graph.after = {{0, 0, 7}, {nan, 1, 0}, {1e9, 1, 0}, {2, 2, 0}};
  graph.before = {{nan, nan, 0}, {1e300, 0, 0}, {0, 0, 0}, {-1e300, 5, 0}};
  graph.edges = {{0, 1, EdgeKind::kOdometry, 0, 0}, {0, 2, EdgeKind::kLoop, nan, 3},
                 {0, 3, EdgeKind::kLoop, -1, 0},    {2, 3, EdgeKind::kLoop, 1e300, 3},
                 {0, 3, EdgeKind::kLandmark, 0, 2}, {2, 0, EdgeKind::kLoop, 0, 3}};
  graph.landmarks = {3, 1};
  const std::string svg = DrawGraph(graph);
  EXPECT_EQ(test::TagFault(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NO_THROW(PngFromSvg(svg, 300));
}

TEST(GraphPlot, RefusesNodesThatAreNotThere) {
  GraphPlot graph = Ring(10);
  graph.edges.push_back({3, 10, EdgeKind::kLoop, 1, 3});
  EXPECT_THROW(DrawGraph(graph), Error);
  graph = Ring(10);
  graph.landmarks = {10};
  EXPECT_THROW(DrawGraph(graph), Error);
  graph = Ring(10);
  graph.before.pop_back();
  EXPECT_THROW(DrawGraph(graph), Error);
}

TEST(GraphPlot, StaysSmallAndQuickWithAHundredThousandEdges) {
  GraphPlot graph = Ring(20000);
  std::mt19937 random(1);  // the same on every platform, unlike the distributions
  const auto pose = [&] { return static_cast<std::uint32_t>(random() % 20000); };
  for (int i = 0; i < 100000; ++i)
    graph.edges.push_back({pose(), pose(), EdgeKind::kLoop, 1e-3 * pose(), 3});
  const std::clock_t begin = std::clock();
  const std::string svg = DrawGraph(graph);
  const double cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  EXPECT_LT(svg.size(), 6u << 20);
  // Measured: 0.05 s.  The margin is for sanitizers.
  EXPECT_LT(cpu_s, 2);

  for (int i = 0; i < 200000; ++i) graph.edges.push_back({pose(), pose(), EdgeKind::kLoop, 1, 3});
  const std::string thinned = DrawGraph(graph);
  EXPECT_LT(thinned.size(), 8u << 20);
  EXPECT_NE(thinned.find("(120,000 drawn)"), std::string::npos);
}

}  // namespace
}  // namespace graticule
