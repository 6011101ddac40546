#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "graticule/io/graph_plot.hpp"
#include "graticule/io/report_html.hpp"
#include "graticule/io/report_json.hpp"
#include "markup.hpp"
#include "sample.hpp"

namespace graticule {
namespace {

using Json = nlohmann::json;

ReportContext SampleContext() {
  return {"<script>.g2o", "g2o", "lm.yaml", "spanning tree", {"solved.fg"}, 1 << 20, {{"a", "b"}}};
}

TEST(ReportJson, HasEveryMember) {
  const Report report = test::SampleReport();
  const Json json = Json::parse(ReportJson(report, SampleContext()));
  for (const char* name : {"schema",
                           "file",
                           "format",
                           "configuration",
                           "initialisation",
                           "outputs",
                           "extras",
                           "termination",
                           "message",
                           "initial_cost",
                           "final_cost",
                           "initial_objective",
                           "final_objective",
                           "variables",
                           "fixed_variables",
                           "parameters",
                           "factors",
                           "residuals",
                           "degrees_of_freedom",
                           "chi2",
                           "reduced_chi2",
                           "iterations",
                           "seconds",
                           "cpu_seconds",
                           "threads",
                           "peak_memory_bytes",
                           "linear_solver",
                           "anchors",
                           "warnings",
                           "cost_by_type",
                           "worst_factors",
                           "history",
                           "options",
                           "provenance"})
    EXPECT_TRUE(json.contains(name)) << name;
  for (const char* name : {"load", "initialise", "build", "preprocess", "evaluate", "linear_solve",
                           "solve", "write", "total"})
    EXPECT_TRUE(json["seconds"].contains(name)) << name;
  EXPECT_EQ(json["iterations"], 8);
  EXPECT_EQ(json["history"].size(), 9u);
  EXPECT_EQ(json["termination"], "converged");
  EXPECT_EQ(json["worst_factors"][0]["keys"], Json({"pose:3", "pose:11"}));
  EXPECT_EQ(json["options"]["max_iterations"], "100");
  EXPECT_EQ(json["cpu_seconds"]["solve"], 0.04);
}

TEST(ReportJson, KeepsEveryDigit) {
  const Report report = test::SampleReport();
  const Json json = Json::parse(ReportJson(report));
  EXPECT_EQ(json["final_cost"].get<double>(), report.final_cost);
  EXPECT_EQ(json["history"][5]["objective"].get<double>(), report.iterations[5].objective);
}

TEST(ReportJson, WritesNullForWhatIsNotANumber) {
  Report report = test::SampleReport();
  report.final_cost = std::numeric_limits<double>::quiet_NaN();
  report.worst[0].chi2 = std::numeric_limits<double>::infinity();
  const Json json = Json::parse(ReportJson(report));
  EXPECT_TRUE(json["final_cost"].is_null());
  EXPECT_TRUE(json["chi2"].is_null());
  EXPECT_TRUE(json["worst_factors"][0]["chi2"].is_null());
  EXPECT_TRUE(json["peak_memory_bytes"].is_null()) << "not known";
}

TEST(ReportJson, TakesTextThatIsNotUtf8) {
  Report report = test::SampleReport();
  report.message = "\xff\xfe";
  EXPECT_NO_THROW(Json::parse(ReportJson(report)));
}

TEST(ReportHtml, IsOneSelfContainedPage) {
  GraphPlot graph;
  graph.after = {{0, 0, 0}, {1, 0, 0}};
  graph.edges = {{0, 1, GraphPlot::EdgeKind::kLoop, 1, 3}};
  const std::string page = ReportHtml(test::SampleReport(), SampleContext(), DrawGraph(graph));
  EXPECT_EQ(test::TagFault(page), "");
  EXPECT_TRUE(test::IsSelfContained(page));
  for (const char* text : {"converged", "pose:3  pose:11", "Convergence", "Time by phase",
                           "loops &quot;4&quot; &lt; 5", "a &amp; b", "max_iterations",
                           "&lt;script&gt;.g2o", "pose:0", "1.00 MiB"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
}

TEST(ReportHtml, TakesAReportThatSaysNothing) {
  Report report;
  report.final_cost = std::numeric_limits<double>::quiet_NaN();
  const std::string page = ReportHtml(report);
  EXPECT_EQ(test::TagFault(page), "");
  EXPECT_EQ(page.find(">nan"), std::string::npos);
  EXPECT_NE(page.find("verdict bad"), std::string::npos);
}

}  // namespace
}  // namespace graticule
