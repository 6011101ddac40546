#include "graticule/io/bal.hpp"

#include <gtest/gtest.h>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

const char* const kSmall =
    "1 2 2\n0 0 -3.8e+02 2\n0 1\t3 4\n1\n2\n3\n4\n5\n6\n500\n0.1\n0.2\n1\n2\n3\n4\n5\n6\n";

Recording Read(std::string_view text) { return ParseBal(text, "x.bal", TestRegistry()); }

std::string Write(const Recording& recording) {
  std::vector<std::string> notes;
  return FormatBal(recording, &notes);
}

TEST(Bal, ReadsCamerasPointsAndObservations) {
  const Graph graph = Read(kSmall).graph;
  ASSERT_EQ(graph.VariableCount(), 3u);
  EXPECT_EQ(graph.KeyOf(0).ToString(), "camera:0");
  EXPECT_EQ(graph.KeyOf(2).ToString(), "point:1");
  EXPECT_EQ(graph.ValueOf(0)[6], 500);
  EXPECT_EQ(graph.ValueOf(2)[2], 6);
  const FactorView factor = graph.FactorAt(0);
  EXPECT_EQ(factor.type->name, "bal_reprojection/1");
  EXPECT_EQ(factor.measurement[0], -380);
  EXPECT_EQ(factor.noise.kind, NoiseKind::kUnit);
  EXPECT_EQ(factor.source, "observation");
}

TEST(Bal, ComesBackToTheBit) {
  const Recording recording = Read(kSmall);
  ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
}

TEST(Bal, NumbersCamerasAndPointsInKeyOrder) {
  Recording recording(TestRegistry());
  Graph& graph = recording.graph;
  graph.Add(Key("point:8"), "point3/1", {8, 8, 8});
  graph.Add(Key("point:3"), "point3/1", {3, 3, 3});
  graph.Add(Key("view:4"), "bal_camera/1", {0, 0, 0, 0, 0, 0, 1, 0, 0});
  graph.Add({"bal_reprojection/1",
             {Key("view:4"), Key("point:8")},
             {1, 2},
             Noise::Sigma(1),
             {LossKind::kHuber, 1},
             ""});
  std::vector<std::string> notes;
  const std::string text = FormatBal(recording, &notes);
  EXPECT_EQ(text.substr(0, 14), "1 2 1\n0 1 1 2\n");
  EXPECT_EQ(notes.size(), 2u) << "losses and keys";
}

TEST(Bal, RefusesNoiseThatItCannotExpress) {
  Recording recording = Read(kSmall);
  recording.graph.Add(
      {"bal_reprojection/1", {Key("camera:0"), Key("point:0")}, {1, 2}, Noise::Sigma(2), {}, ""});
  EXPECT_THROW(Write(recording), Error);
}

TEST(Bal, ReadsTheRecordedFiles) {
  GRATICULE_NEEDS_DATA();
  const Recording small = Read(ReadFile(DataFile("gtsam_dubrovnik-3-7-pre.txt")));
  EXPECT_EQ(small.graph.VariableCount(), 3u + 7u);
  EXPECT_EQ(small.graph.FactorCount(), 19u);
  ExpectSameGraph(Read(Write(small)).graph, small.graph);
  const Recording large = Read(ReadFile(DataFile("synth-problem-49-7776-pre.txt.gz")));
  EXPECT_EQ(large.graph.VariableCount(), 49u + 7776u);
  EXPECT_EQ(large.graph.FactorCount(), 44149u);  // the number in the file's first line
  ExpectSameGraph(Read(Write(large)).graph, large.graph);
}

}  // namespace
}  // namespace graticule
