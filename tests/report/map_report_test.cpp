#include "graticule/io/map_report.hpp"

#include <gtest/gtest.h>

#include "markup.hpp"

namespace graticule {
namespace {

MapRun RunOf(const std::string& method, const std::vector<double>& seconds, std::size_t anew) {
  MapRun run;
  run.method = method;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    MapUpdateRow row;
    row.time = 10.0 * static_cast<double>(i);
    row.seconds = seconds[i];
    row.nodes = 5 * (i + 1);
    row.cover = 4 * (i + 1);
    row.regenerated_nodes = anew;
    run.updates.push_back(row);
  }
  return run;
}

std::size_t CountOf(const std::string& what, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++count;
  return count;
}

// The end of a band belongs to the next one.
TEST(MapReport, SharesUpdatesAndTheirTimeOutToBands) {
  const MapRun run = RunOf("incremental", {0.1e-3, 0.5e-3, 0.9e-3, 0.3, 1, 2.5}, 1);
  EXPECT_EQ(CountInBands(run), (std::vector<std::size_t>{1, 2, 0, 0, 0, 1, 2}));
  const std::vector<double> seconds = SecondsInBands(run);
  ASSERT_EQ(seconds.size(), MapBands().size() + 1);
  EXPECT_DOUBLE_EQ(seconds[0], 0.1e-3);
  EXPECT_DOUBLE_EQ(seconds[1], 1.4e-3);
  EXPECT_DOUBLE_EQ(seconds[2], 0);
  EXPECT_DOUBLE_EQ(seconds[5], 0.3);
  EXPECT_DOUBLE_EQ(seconds[6], 3.5);
}

TEST(MapReport, ShowsTheFiguresOfTheThesis) {
  MapReport report;
  report.title = "a <mission>";
  report.runs = {RunOf("naive", {1e-3, 2e-3, 3e-3}, 0),
                 RunOf("cover-composite", {1e-3, 1e-3, 2e-3}, 3),
                 RunOf("incremental", {1e-4, 2e-4, 3e-4}, 3)};
  std::string page = MapReportHtml(report, "<svg></svg>");
  EXPECT_EQ(test::TagFault(page), "");
  EXPECT_TRUE(test::IsSelfContained(page));
  for (const char* title : {"Time in all, by how long an update took", "Time of each update",
                            "Cumulative time", "Nodes, cover, and nodes drawn anew"})
    EXPECT_NE(page.find(title), std::string::npos) << title;
  EXPECT_EQ(CountOf("stroke-dasharray=\"7 4\"", page), 3u) << "the mean of each method";
  // Each name is in the legend, and on the curve itself.
  EXPECT_EQ(CountOf(">drawn anew<", page), 2u) << "one curve, for both methods";

  report.runs[2].updates[1].regenerated_nodes = 2;
  page = MapReportHtml(report, "<svg></svg>");
  EXPECT_EQ(CountOf(">drawn anew: cover-composite<", page), 2u);
  EXPECT_EQ(CountOf(">drawn anew: incremental<", page), 2u);
}

TEST(MapReport, SaysWhatIsThereOfAMissionWithoutUpdates) {
  MapReport report;
  EXPECT_EQ(test::TagFault(MapReportHtml(report, "<svg></svg>")), "");
  report.runs = {RunOf("naive", {}, 0)};
  EXPECT_EQ(test::TagFault(MapReportHtml(report, "<svg></svg>")), "");
}

}  // namespace
}  // namespace graticule
