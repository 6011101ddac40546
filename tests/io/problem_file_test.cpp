#include "graticule/io/problem_file.hpp"

#include <gtest/gtest.h>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/g2o.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

TEST(ProblemFile, KnowsTheFormatByName) {
  EXPECT_EQ(FormatOfName("a/b.fg"), ProblemFormat::kRecording);
  EXPECT_EQ(FormatOfName("b.g2o.gz"), ProblemFormat::kG2o);
  EXPECT_EQ(FormatOfName("b.graph"), ProblemFormat::kToro);
  EXPECT_EQ(FormatOfName("b.toro"), ProblemFormat::kToro);
  EXPECT_EQ(FormatOfName("b.bal.gz"), ProblemFormat::kBal);
  EXPECT_FALSE(FormatOfName("b.txt").has_value());
  EXPECT_FALSE(FormatOfName(".fg").has_value());
}

TEST(ProblemFile, KnowsTheFormatByContents) {
  EXPECT_EQ(FormatOfContents("graticule-problem 1\n"), ProblemFormat::kRecording);
  EXPECT_EQ(FormatOfContents("# a\n\nEDGE_SE2 0 1"), ProblemFormat::kG2o);
  EXPECT_EQ(FormatOfContents("VERTEX2 0"), ProblemFormat::kToro);
  EXPECT_EQ(FormatOfContents("3 7 19\n"), ProblemFormat::kBal);
  EXPECT_FALSE(FormatOfContents("3 7.5 19\n").has_value());
  EXPECT_FALSE(FormatOfContents("").has_value());
}

TEST(ProblemFile, GoesThroughEveryFormatAndBack) {
  const TemporaryDirectory directory;
  const Recording plane =
      ParseG2o("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\nEDGE_SE2 0 1 1 0 0.5 1 0 0 2 0 3\n", "a",
               TestRegistry());
  for (const char* name : {"a.fg", "a.fg.gz", "a.g2o", "a.g2o.gz", "a.graph", "a.toro.gz"}) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(WriteProblem(directory / name, plane).empty());
    ExpectSameGraph(ReadProblem(directory / name, TestRegistry()).graph, plane.graph);
  }
  WriteOptions binary;
  binary.binary = true;
  WriteProblem(directory / "b.fg", plane, binary);
  EXPECT_NE(ReadFile(directory / "b.fg"), ReadFile(directory / "a.fg"));
  ExpectSameGraph(ReadProblem(directory / "b.fg", TestRegistry()).graph, plane.graph);
  std::filesystem::copy_file(directory / "a.g2o", directory / "a.txt");
  ExpectSameGraph(ReadProblem(directory / "a.txt", TestRegistry()).graph, plane.graph);
}

TEST(ProblemFile, NamesTheFileWhereAFormatCannotHoldTheGraph) {
  const TemporaryDirectory directory;
  Recording recording(TestRegistry());
  recording.graph.Add(Key("v:0"), "vector2/1", {0, 0});
  const std::string path = directory / "a.g2o";
  EXPECT_EQ(MessageOf([&] { WriteProblem(path, recording); }),
            path + ": g2o has no tag for the variables vector2/1 (1); write .fg");
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THROW(WriteProblem(directory / "a.xyz", recording), Error);
}

}  // namespace
}  // namespace graticule
