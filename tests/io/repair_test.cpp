// Information matrices that are not positive definite: refused all at once, or repaired.

#include <gtest/gtest.h>

#include <cmath>

#include "graphs.hpp"
#include "graticule/io/problem_file.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

Recording Read(const std::string& text, const std::string& name, bool repair) {
  ReadOptions options;
  options.repair_information = repair;
  return ParseProblem(text, name, TestRegistry(), options);
}

// Eigenvalues: good; 1 -1 3; good; 2 and -2 twice; singular.
const char* const kG2o =
    "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 2 0 0\n"
    "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
    "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n"
    "EDGE_SE2 1 2 1 0 0 0 0 0 1 0 1\n"
    "EDGE_SE2 1 2 1 0 0 -2 0 0 -2 0 2\n"
    "EDGE_SE2 2 0 1 0 0 1 1 1 1 1 1\n";
const char* const kToro =
    "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nVERTEX2 2 2 0 0\n"
    "EDGE2 0 1 1 0 0 1 0 1 1 0 0\n"
    "EDGE2 0 1 1 0 0 1 2 1 1 0 0\n"
    "EDGE2 1 2 1 0 0 0 0 1 1 0 0\n"
    "EDGE2 1 2 1 0 0 -2 0 -2 2 0 0\n"
    "EDGE2 2 0 1 0 0 1 1 1 1 1 1\n";
const char* const kText =
    "graticule-problem 1\nvariables 3\npose:0 se2/1 0 0 0\npose:1 se2/1 1 0 0\n"
    "pose:2 se2/1 2 0 0\nfactors 5\n"
    "between_se2/1 pose:0 pose:1 | 1 0 0 | information 1 0 0 1 0 1\n"
    "between_se2/1 pose:0 pose:1 | 1 0 0 | information 1 2 0 1 0 1\n"
    "between_se2/1 pose:1 pose:2 | 1 0 0 | information 0 0 0 1 0 1\n"
    "between_se2/1 pose:1 pose:2 | 1 0 0 | information -2 0 0 -2 0 2\n"
    "between_se2/1 pose:2 pose:0 | 1 0 0 | information 1 1 1 1 1 1\n"
    "end 8\n";

struct File {
  const char* name;
  std::string text;
  const char* line;
};
const File kFiles[] = {
    {"a.g2o", kG2o, "a.g2o:5"}, {"a.graph", kToro, "a.graph:5"}, {"a.fg", kText, "a.fg:8"}};

TEST(BadInformation, IsRefusedAtItsFirstPlaceWithTheCountOfAllAndTheSmallestEigenvalue) {
  for (const File& file : kFiles) {
    const std::string message = MessageOf([&] { Read(file.text, file.name, false); });
    EXPECT_EQ(message.substr(0, message.find("the information")),
              std::string(file.line) + ":1: between_se2/1 (pose:0 pose:1): ");
    EXPECT_NE(message.find("(3 of 5 in this file are not, smallest eigenvalue -2); "
                           "--repair-information"),
              std::string::npos)
        << message;
  }
}

TEST(BadInformation, IsRepairedWhereThatIsAllowedAndRecorded) {
  for (const File& file : kFiles) {
    SCOPED_TRACE(file.name);
    const Recording recording = Read(file.text, file.name, true);
    ASSERT_TRUE(recording.repaired);
    EXPECT_EQ(recording.repaired->count, 3u);
    EXPECT_EQ(recording.repaired->of, 5u);
    EXPECT_NEAR(recording.repaired->smallest_eigenvalue, -2, 1e-15);
    EXPECT_NEAR(recording.repaired->largest_change, std::sqrt(2.0 / 3), 1e-8);  // of the -2s
    EXPECT_EQ(recording.repaired->first, file.line);
    EXPECT_NE(ToString(*recording.repaired).find("3 of 5 information matrices"), std::string::npos);
    const Graph& graph = recording.graph;
    ASSERT_EQ(graph.FactorCount(), 5u);
    EXPECT_NEAR(graph.FactorAt(1).noise.values[1], 1.5, 1e-8);
    EXPECT_EQ(graph.FactorAt(0).noise.values[0], 1) << "good ones stay";
    EXPECT_EQ(graph.FactorAt(2).noise.values[0], 0) << "a row of zeros was not measured";
    EXPECT_NEAR(graph.FactorAt(3).noise.values[0], 2e-9, 1e-20);

    // What is written needs no repair, and comes back to the bit.
    for (const bool binary : {false, true}) {
      const Recording again = Read(FormatRecording(recording, binary), "b.fg", false);
      EXPECT_FALSE(again.repaired);
      ExpectSameGraph(again.graph, graph);
    }
  }
}

// A binary file whose third factor shares the second's noise; the number 7 becomes 1, so that the
// matrix (1 2, 2 1) is indefinite.
std::string BinaryWithBadNoise(double instead) {
  Recording recording(TestRegistry());
  Graph& graph = recording.graph;
  for (std::uint64_t i = 0; i < 3; ++i) graph.Add(Key("pose", i), "se2/1", {0, 0, 0});
  const auto add = [&](std::uint64_t a, std::uint64_t b, std::vector<double> information) {
    graph.Add({"between_se2/1",
               {Key("pose", a), Key("pose", b)},
               {1, 0, 0},
               Noise::Information(std::move(information)),
               {},
               ""});
  };
  add(0, 1, {1, 0, 0, 1, 0, 1});
  add(0, 1, {7, 2, 0, 1, 0, 1});
  add(1, 2, {7, 2, 0, 1, 0, 1});
  add(2, 0, {1, 0, 0, 1, 0, 1});
  std::string bytes = FormatRecording(recording, true);
  const double seven = 7;
  const std::string from(reinterpret_cast<const char*>(&seven), sizeof(seven));
  bytes.replace(bytes.find(from), sizeof(seven), reinterpret_cast<const char*>(&instead),
                sizeof(instead));
  return bytes.substr(0, bytes.rfind("end ")) + "end 7\n";
}

TEST(BadInformation, IsFoundInBinaryFilesToo) {
  const std::string bytes = BinaryWithBadNoise(1);
  const std::string message = MessageOf([&] { Read(bytes, "a.fg", false); });
  EXPECT_EQ(message.find("a.fg: at byte "), 0u) << message;
  EXPECT_NE(message.find("(2 of 4 in this file are not, smallest eigenvalue -1)"),
            std::string::npos)
      << message;
  const Recording recording = Read(bytes, "a.fg", true);
  ASSERT_TRUE(recording.repaired);
  EXPECT_EQ(recording.repaired->count, 2u);
  EXPECT_EQ(recording.repaired->of, 4u);
  EXPECT_EQ(recording.repaired->first.find("a.fg, byte "), 0u);
  for (const FactorId id : {1u, 2u})
    EXPECT_NEAR(recording.graph.FactorAt(id).noise.values[1], 1.5, 1e-8);
}

TEST(BadInformation, ThatIsNoNumberIsNeverRepaired) {
  for (const double bad : {std::nan(""), HUGE_VAL})
    EXPECT_NE(MessageOf([&] { Read(BinaryWithBadNoise(bad), "a.fg", true); }).find("nan or inf"),
              std::string::npos);
  std::string text = kG2o;
  text.replace(text.find("1 2 0 1 0 1"), 11, "1 nan 0 1 0");
  EXPECT_NE(MessageOf([&] { Read(text, "a.g2o", true); }).find("a.g2o:5:"), std::string::npos);
}

TEST(BadInformation, HidesNoOtherFault) {
  const std::string vertices = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
  const std::string bad = " 1 0 0 1 2 0 1 0 1\n";
  EXPECT_EQ(MessageOf([&] { Read(vertices + "EDGE_SE2 1 1" + bad, "a.g2o", true); }),
            "a.g2o:3:1: between_se2/1 (pose:1 pose:1): the same key twice");
  EXPECT_EQ(MessageOf([&] {
              Read(vertices + "EDGE_SE2 0 1" + bad + "EDGE_SE2 0 2" + bad, "a.g2o", true);
            }),
            "a.g2o:4:12: there is no vertex 2 in this file");
}

TEST(BadInformation, IsMeasuredAsTheReadingOfRotationsHasIt) {
  std::string edge =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\n"
      "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1";
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      edge += row == column ? row == 5 ? " -1" : " 1" : " 0";
  ReadOptions options;
  options.repair_information = true;
  for (const auto rotation : {G2oRotation::kHalf, G2oRotation::kDouble, G2oRotation::kFull}) {
    options.rotation = rotation;
    const Recording recording = ParseProblem(edge, "a.g2o", TestRegistry(), options);
    EXPECT_EQ(recording.repaired->smallest_eigenvalue, rotation == G2oRotation::kDouble ? -4 : -1);
  }
}

}  // namespace
}  // namespace graticule
