#include "graticule/io/comparison_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

ComparisonRun SomeRun() {
  ComparisonRun run;
  run.file = "a b%\xff.g2o";
  run.configuration = "dogleg";
  run.report.termination = Termination::kNoConvergence;
  run.report.message = "one\nline\tor two";
  run.report.degrees_of_freedom = -3;
  run.report.factors = 12;
  run.report.final_cost = 0.1 + 0.2;
  run.report.final_objective = -HUGE_VAL;
  run.report.iterations = {{0, true, 1e-310, 0, HUGE_VAL, std::nan(""), 1e4, 7, true, 0.25}};
  run.report.shares = {{"between_se2/1", "", 3, 9, 1.5, -0.0}};
  run.report.worst = {{4, "between_se2/1", "loop", {Key("pose:3"), Key("robot1:4")}, 2.5, 3, 0.5}};
  run.report.warnings = {"", "%", "100 %"};
  run.report.options = {{"threads", "2"}, {"method", "dogleg"}};
  run.report.timing.solve = {1.25, 2.5};
  run.repeats = 3;
  run.median.total = {0.5, 0.75};
  run.max_total_s = 1;
  run.peak_memory_bytes = 1ull << 40;
  run.repaired = RepairedInformation{1, 2, -1e-9, 0.5, "a.g2o:12"};
  run.accuracy.emplace();
  run.accuracy->truth = "truth.tum";
  run.accuracy->together.ate.translation_m.rmse = 0.125;
  run.accuracy->families.resize(2);
  run.accuracy->families[1].family = "robot2";
  return run;
}

ComparisonRun Parse(const std::string& text) {
  TextReader reader(text, "state");
  reader.NextLine();
  return ParseRun(&reader);
}

TEST(ComparisonRun, ReadsBackToTheBit) {
  const ComparisonRun run = SomeRun();
  const std::string text = RunText(run);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const ComparisonRun again = Parse(text);
  EXPECT_EQ(RunText(again), text);
  EXPECT_EQ(again.file, run.file);
  EXPECT_EQ(again.error, "");
  EXPECT_EQ(again.report.termination, run.report.termination);
  EXPECT_EQ(again.report.message, run.report.message);
  EXPECT_EQ(again.report.degrees_of_freedom, -3);
  EXPECT_EQ(again.report.final_cost, run.report.final_cost);
  EXPECT_EQ(again.report.final_objective, -HUGE_VAL);
  ASSERT_EQ(again.report.iterations.size(), 1u);
  EXPECT_EQ(again.report.iterations[0].objective, 1e-310);
  EXPECT_TRUE(std::isnan(again.report.iterations[0].step_norm));
  EXPECT_TRUE(std::signbit(again.report.shares.at(0).final_cost));
  EXPECT_EQ(again.report.worst.at(0).keys, run.report.worst[0].keys);
  EXPECT_EQ(again.report.warnings, run.report.warnings);
  EXPECT_EQ(again.report.options, run.report.options);
  EXPECT_EQ(again.report.timing.solve.cpu, 2.5);
  EXPECT_EQ(again.median.total.wall, 0.5);
  EXPECT_EQ(again.max_total_s, 1);
  EXPECT_EQ(again.peak_memory_bytes, 1ull << 40);
  ASSERT_TRUE(again.repaired);
  EXPECT_EQ(again.repaired->first, "a.g2o:12");
  ASSERT_TRUE(again.accuracy);
  EXPECT_EQ(again.accuracy->together.ate.translation_m.rmse, 0.125);
  EXPECT_TRUE(std::isnan(again.accuracy->together.ate.translation_m.mean));
  EXPECT_EQ(again.accuracy->families.at(1).family, "robot2");
  EXPECT_EQ(RunText(Parse(RunText(ComparisonRun()))), RunText(ComparisonRun()));
}

// Cut between words; a word that is cut may still be one.
TEST(ComparisonRun, RefusesWhatWasCutShortOrDamaged) {
  const std::string text = RunText(SomeRun());
  for (std::size_t end = text.rfind(' '); end != std::string::npos; end = text.rfind(' ', end - 1))
    EXPECT_THROW(Parse(text.substr(0, end)), Error) << end;
  EXPECT_THROW(Parse(text + " 1"), Error);
  EXPECT_THROW(Parse("%g" + text), Error);
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const char c : {'9', '%', ' '}) {
      std::string damaged = text;
      damaged[i] = c;
      try {
        Parse(damaged);
      } catch (const Error&) {  // and nothing else
      }
    }
}

}  // namespace
}  // namespace graticule
