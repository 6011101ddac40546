#include "graticule/io/comparison.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "graticule/io/comparison_columns.hpp"
#include "graticule/io/readable.hpp"
#include "markup.hpp"
#include "sample.hpp"

namespace graticule {
namespace {

ComparisonRun SampleRun(const std::string& file, const std::string& configuration, double cost,
                        double seconds) {
  ComparisonRun run;
  run.file = file;
  run.configuration = configuration;
  run.report = test::SampleReport();
  run.report.final_cost = cost;
  run.best_known = 2;
  run.gap = cost / 2 - 1;
  run.repeats = 3;
  run.median = run.report.timing;
  run.median.total = {seconds, seconds};
  run.min_total_s = 0.9 * seconds;
  run.max_total_s = 1.1 * seconds;
  run.peak_memory_bytes = 100 << 20;
  return run;
}

Accuracy SampleAccuracy() {
  Accuracy accuracy;
  accuracy.truth = "wahrheit <1>.tum";
  accuracy.rpe_distance_m = 10;
  FamilyAccuracy& all = accuracy.together;
  all.poses = all.matched = 20;
  all.alignment = "se2 (Umeyama, no scale)";
  all.ate = {{20, 1.5, 1.25, 3}, {20, 2.5, 2, 4}};
  all.rpe_step = {{18, 0.25, 0.2, 0.5}, {18, 0.75, 0.5, 1}};
  for (const char* robot : {"a", "b"}) {
    accuracy.families.push_back(all);
    accuracy.families.back().family = robot;
    accuracy.families.back().matched = 10;
  }
  return accuracy;
}

Comparison Sample() {
  Comparison comparison;
  comparison.runs = {
      SampleRun("städte.g2o", "levenberg_marquardt", 2, 0.5),
      SampleRun("städte.g2o", "gauss <newton>", 2.5, 0.2), SampleRun("b.g2o", "長い", 2, 0.5),
      SampleRun("städte.g2o", "gave up", 9, 0.001), SampleRun("städte.g2o", "broken", 0, 0)};
  comparison.runs[3].report.termination = Termination::kTimeLimit;
  comparison.runs[4].error = "option 'method':\nno such <method>";
  comparison.provenance = {{"graticule", "0.1.0"}};
  return comparison;
}

const ComparisonColumn& Column(const ComparisonBlock& block, const std::string& name) {
  for (const ComparisonColumn& column : block.columns)
    if (column.name == name) return column;
  throw std::out_of_range(name);
}

TEST(Comparison, FindsTheBestOfEachFile) {
  const Comparison comparison = Sample();
  const std::vector<ComparisonBlock> blocks = ComparisonBlocks(comparison);
  ASSERT_EQ(blocks.size(), 2u);
  ASSERT_EQ(blocks[0].runs.size(), 4u);
  EXPECT_TRUE(Column(blocks[0], "final cost").cells[0].best);
  EXPECT_FALSE(Column(blocks[0], "final cost").cells[3].best) << "an error has no cost";
  EXPECT_TRUE(Column(blocks[0], "total").cells[1].best);
  EXPECT_FALSE(Column(blocks[0], "total").cells[2].best) << "giving up is not being fast";
  EXPECT_TRUE(Column(blocks[0], "end").cells[3].bad);
  EXPECT_FALSE(Column(blocks[1], "total").cells[0].best) << "one alone wins nothing";
  EXPECT_THROW(Column(blocks[0], "ATE"), std::out_of_range) << "nobody has one";
}

TEST(Comparison, WritesJsonThatParses) {
  const auto json = nlohmann::json::parse(ComparisonJson(Sample()));
  ASSERT_EQ(json["runs"].size(), 5u);
  EXPECT_EQ(json["runs"][0]["seconds"]["total"], 0.5);
  EXPECT_EQ(json["runs"][0]["report"]["seconds"]["total"], 0.05) << "the run's own time";
  EXPECT_EQ(json["runs"][1]["gap"], 0.25);
  EXPECT_TRUE(json["runs"][0]["ate_m"].is_null());
  EXPECT_TRUE(json["runs"][0]["error"].is_null());
  EXPECT_EQ(json["runs"][4]["error"], Sample().runs[4].error);
  EXPECT_EQ(json["provenance"]["graticule"], "0.1.0");
}

TEST(Comparison, DrawsOneSelfContainedPage) {
  const std::string page = ComparisonHtml(Sample());
  EXPECT_EQ(test::TagFault(page), "");
  EXPECT_TRUE(test::IsSelfContained(page));
  EXPECT_NE(page.find("gauss &lt;newton&gt;"), std::string::npos);
  EXPECT_NE(page.find("no such &lt;method&gt;"), std::string::npos);
  EXPECT_EQ(test::TagFault(ComparisonHtml({})), "");
}

TEST(Comparison, AlignsTheTerminalTable) {
  Comparison comparison = Sample();
  comparison.runs[0].accuracy = SampleAccuracy();
  comparison.runs[0].configuration = std::string(200, 'x');
  const std::string table = ComparisonTable(comparison, false);
  EXPECT_EQ(table.find('\x1b'), std::string::npos);
  std::istringstream lines(table);
  std::size_t end_column = 0;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(DisplayWidth(line), 120u) << line;
    for (const char* end : {"end", "converged", "time limit", "failed"}) {
      const std::size_t at = line.rfind(end);
      if (at == std::string::npos || line.find(':') != std::string::npos) continue;
      if (std::string(end) == "end") end_column = DisplayWidth(line.substr(0, at));
      EXPECT_EQ(DisplayWidth(line.substr(0, at)), end_column) << line;
      break;
    }
  }
  EXPECT_GT(end_column, 0u);
  EXPECT_NE(table.find("broken: option 'method': no such <method>"), std::string::npos);
  EXPECT_NE(ComparisonTable(comparison, true).find("\x1b[1;32m"), std::string::npos);
}

TEST(Comparison, SaysHowFarRunsAreFromTheTruth) {
  Comparison comparison = Sample();
  for (std::size_t i : {0, 1}) comparison.runs[i].accuracy = SampleAccuracy();
  comparison.runs[1].accuracy->together.ate.translation_m.rmse = 1;
  const ComparisonBlock block = ComparisonBlocks(comparison)[0];
  EXPECT_EQ(Column(block, "ATE").cells[0].text, "1.5 m");
  EXPECT_TRUE(Column(block, "ATE").cells[1].best);
  EXPECT_EQ(Column(block, "ATE").cells[2].text, "–");
  EXPECT_EQ(Column(block, "RPE").cells[0].text, "0.25 m");
  const auto runs = nlohmann::json::parse(ComparisonJson(comparison))["runs"];
  EXPECT_EQ(runs[0]["ate_m"], 1.5);
  EXPECT_EQ(runs[0]["ate_deg"], 2.5);
  EXPECT_EQ(runs[0]["rpe_m"], 0.25);
  EXPECT_EQ(runs[0]["rpe_deg"], 0.75);
  EXPECT_EQ(runs[0]["accuracy"]["families"]["b"]["matched"], 10);
  EXPECT_TRUE(runs[0]["accuracy"]["together"]["rpe_distance"]["translation_m"]["rmse"].is_null());
  EXPECT_TRUE(runs[3]["accuracy"].is_null());
  const std::string page = ComparisonHtml(comparison);
  EXPECT_EQ(test::TagFault(page), "");
  EXPECT_NE(page.find("wahrheit &lt;1&gt;.tum, 20 of 20 poses"), std::string::npos);
  const std::string table = ComparisonTable(comparison, false);
  EXPECT_NE(table.find("ATE of each [m]"), std::string::npos) << table;
}

TEST(Comparison, DrawsARunWithALossAboveItsOwnLowestObjective) {
  Comparison comparison;
  comparison.runs = {SampleRun("a.g2o", "plain", 0, 0.5), SampleRun("a.g2o", "robust", 9, 0.5)};
  comparison.runs[0].report.final_cost = comparison.runs[0].report.final_objective;
  const std::string both = ComparisonHtml(comparison);
  EXPECT_NE(both.find("robust *"), std::string::npos);
  EXPECT_EQ(both.find("plain *"), std::string::npos);
  comparison.runs.erase(comparison.runs.begin());
  EXPECT_NE(ComparisonHtml(comparison).find("robust *"), std::string::npos) << "with a loss only";
}

}  // namespace
}  // namespace graticule
