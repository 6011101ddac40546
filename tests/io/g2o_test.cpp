#include "graticule/io/g2o.hpp"

#include <gtest/gtest.h>

#include <map>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

Recording Read(std::string_view text, const ReadOptions& options = {}) {
  return ParseG2o(text, "x.g2o", TestRegistry(), options);
}

std::string Write(const Recording& recording) {
  std::vector<std::string> notes;
  return FormatG2o(recording, &notes);
}

std::string Repeat(const std::string& word, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += " " + word;
  return text;
}

// An information matrix of 6 x 6 with ones on the diagonal and 0.125 beside it.
std::string Information6() {
  std::string text;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column)
      text += row == column ? " 1" : row + 1 == column ? " 0.125" : " 0";
  return text;
}

const char* const kPlane =
    "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0.5\nVERTEX_SE2 4 1 2 3\nVERTEX_XY 7 5 6\nFIX 0 4\n"
    "EDGE_SE2 0 1 1 0 0.5 1 0 0 2 0 3\nEDGE_SE2 1 4 1 0 0.5 1 0 0 2 0 3\n"
    "EDGE_SE2_XY 1 7 4 5 10 1 20\nEDGE_BEARING_SE2_XY 0 7 0.25 100\n"
    "EDGE_PRIOR_SE2 0 1 2 3 1 0 0 1 0 1\nEDGE_SE2_PRIOR 1 1 2 3 1 0 0 1 0 1\n"
    "EDGE_PRIOR_SE2_XY 4 1 2 3 0 4\n";

TEST(G2o, CallsItOdometryWhereNoOtherPoseStandsBetween) {
  // Landmark 1 shares the poses' numbers; the edge that comes first needs a vertex that comes last.
  const Recording recording = Read(
      "EDGE_SE2 0 2 1 0 0 1 0 0 1 0 1\nVERTEX_SE2 0 0 0 0\nVERTEX_XY 1 5 6\nVERTEX_SE2 2 1 0 0\n"
      "VERTEX_SE2 3 2 0 0\nEDGE_SE2 3 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 3 1 0 0 1 0 0 1 0 1\n");
  std::map<std::string, std::string> sources;
  for (FactorId id = 0; id < recording.graph.FactorCount(); ++id) {
    const Factor factor = recording.graph.FactorRecord(id);
    sources[factor.keys[0].ToString() + " " + factor.keys[1].ToString()] = factor.source;
  }
  EXPECT_EQ(sources["pose:0 pose:2"], "odometry");
  EXPECT_EQ(sources["pose:3 pose:2"], "odometry");
  EXPECT_EQ(sources["pose:0 pose:3"], "loop");
}

TEST(G2o, ReadsEveryTagOfThePlane) {
  const Recording recording = Read(kPlane);
  const Graph& graph = recording.graph;
  ASSERT_EQ(graph.VariableCount(), 4u);
  EXPECT_EQ(graph.KeyOf(3).ToString(), "landmark:7");
  EXPECT_TRUE(graph.IsFixed(0) && !graph.IsFixed(1) && graph.IsFixed(2));
  const char* const types[] = {"between_se2/1", "between_se2/1", "landmark_se2/1", "bearing_se2/1",
                               "prior_se2/1",   "prior_se2/1",   "position_se2/1"};
  const char* const sources[] = {"odometry", "odometry", "landmark", "landmark",
                                 "prior",    "prior",    "prior"};
  ASSERT_EQ(graph.FactorCount(), 7u);
  for (FactorId id = 0; id < 7; ++id) {
    EXPECT_EQ(graph.FactorAt(id).type->name, types[id]);
    EXPECT_EQ(graph.FactorAt(id).source, sources[id]);
  }
  EXPECT_EQ(graph.FactorAt(2).noise.values[1], 1);
  EXPECT_FALSE(recording.g2o_rotation.has_value());
  EXPECT_TRUE(recording.has_initial_guess);
}

std::string Space() {
  return "# graticule-rotation half\nPARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n"
         "PARAMS_SE3OFFSET 5 0.1 0.2 0.3 0 0 0.6 0.8\n"
         "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2 3 0 0 0.6 0.8\n"
         "VERTEX_TRACKXYZ 2 1 2 3\n"
         "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0.6 0.8" +
         Information6() + "\nEDGE_SE3_TRACKXYZ 0 2 0 1 2 3 1 0 0 1 0 1\n" +
         "EDGE_SE3_TRACKXYZ 0 2 5 1 2 3 1 0 0 1 0 1\n" + "EDGE_SE3_PRIOR 0 0 1 2 3 0 0 0.6 0.8" +
         Information6() + "\nEDGE_SE3_PRIOR 1 5 1 2 3 0 0 0.6 0.8" + Information6() + "\n";
}

TEST(G2o, ReadsEveryTagOfSpaceInEachReading) {
  const char* const half[] = {"between_se3_quaternion/1", "landmark_se3/1", "landmark_offset_se3/1",
                              "prior_se3_quaternion/1", "prior_offset_se3_quaternion/1"};
  const char* const full[] = {"between_se3/1", "landmark_se3/1", "landmark_offset_se3/1",
                              "prior_se3/1", "prior_offset_se3/1"};
  for (const auto rotation : {G2oRotation::kHalf, G2oRotation::kDouble, G2oRotation::kFull}) {
    ReadOptions options;
    options.rotation = rotation;
    const Recording recording = Read(Space(), options);
    EXPECT_EQ(recording.g2o_rotation, rotation);
    ASSERT_EQ(recording.graph.FactorCount(), 5u);
    for (FactorId id = 0; id < 5; ++id)
      EXPECT_EQ(recording.graph.FactorAt(id).type->name,
                (rotation == G2oRotation::kFull ? full : half)[id]);
    EXPECT_EQ(recording.graph.FactorAt(4).measurement.size(), 14u);
    EXPECT_EQ(recording.graph.FactorAt(4).measurement[7], 0.1);
    const double scale = rotation == G2oRotation::kDouble ? 2 : 1;
    const Span<const double> information = recording.graph.FactorAt(0).noise.values;
    EXPECT_EQ(information[12], 0.125 * scale);  // z with the first rotation
    EXPECT_EQ(information[20], scale * scale);  // the last rotation
    EXPECT_EQ(information[0], 1);
    ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
    EXPECT_EQ(Read(Write(recording)).g2o_rotation, rotation);
  }
}

TEST(G2o, ComesBackToTheBit) {
  const Recording recording = Read(kPlane);
  ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
}

TEST(G2o, ReadsEdgesThatComeBeforeTheirVertices) {
  const Recording recording = Read(
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nFIX 0\nVERTEX_SE2 0 0 0 0\n"
      "EDGE_PRIOR_SE2 0 0 0 0 1 0 0 1 0 1\nVERTEX_SE2 1 1 0 0\n");
  ASSERT_EQ(recording.graph.FactorCount(), 2u);
  EXPECT_EQ(recording.graph.FactorAt(0).type->name, "between_se2/1") << "the file's order is kept";
  EXPECT_TRUE(recording.graph.IsFixed(0));
  EXPECT_TRUE(recording.has_initial_guess);
}

TEST(G2o, MakesVerticesWhereThereAreNone) {
  const Recording recording = Read(
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2_XY 1 9 1 0 1 0 1\n"
      "EDGE_SE3:QUAT 20 21 1 2 3 0 0 0 1" +
      Information6());
  EXPECT_FALSE(recording.has_initial_guess);
  ASSERT_EQ(recording.graph.VariableCount(), 5u);
  EXPECT_EQ(recording.graph.KeyOf(2).ToString(), "landmark:9");
  EXPECT_EQ(recording.graph.ValueOf(4)[6], 1);
  EXPECT_FALSE(Read(Write(recording)).has_initial_guess);
  ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
}

TEST(G2o, SkipsUnknownTagsOnlyOnRequest) {
  const std::string text = "VERTEX_CAM 3 1 2\nVERTEX_SE2 0 0 0 0\nEDGE_FOO 0\nEDGE_FOO 1\n";
  const std::string message = MessageOf([&] { Read(text); });
  EXPECT_EQ(message,
            "x.g2o:1:1: expected a tag of a g2o file, found 'EDGE_FOO' (2 lines), 'VERTEX_CAM' (1 "
            "line); --skip-unknown reads the file without them");
  ReadOptions options;
  options.skip_unknown = true;
  const Recording recording = Read(text, options);
  EXPECT_EQ(recording.skipped.at("EDGE_FOO"), 2u);
  EXPECT_EQ(recording.graph.VariableCount(), 1u);
}

TEST(G2o, KeepsKeysThatItCannotExpress) {
  Recording recording(TestRegistry());
  Graph& graph = recording.graph;
  for (const char* key : {"robot1:0", "robot2:0", "pose:3", "pose:99999999999"})
    graph.Add(Key(key), "se2/1", {1, 2, 3});
  graph.Add(Key("landmark:3"), "point2/1", {1, 2});
  graph.Add(
      {"between_se2/1", {Key("robot2:0"), Key("pose:3")}, {1, 2, 3}, Noise::Unit(), {}, "loop"});
  const std::string text = Write(recording);
  EXPECT_NE(text.find("VERTEX_SE2 3 1 2 3\n"), std::string::npos) << text;
  const Recording read = Read(text);
  for (VariableId id = 0; id < graph.VariableCount(); ++id)
    EXPECT_EQ(read.graph.KeyOf(id).ToString(), graph.KeyOf(id).ToString());
  EXPECT_EQ(read.graph.FactorAt(0).noise.values[5], 1);
}

TEST(G2o, WritesSigmasAsInformation) {
  Recording recording(TestRegistry());
  recording.graph.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  recording.graph.Add(
      {"prior_se2/1", {Key("pose:0")}, {0, 0, 0}, Noise::Sigmas({0.5, 0.25, 1}), {}, "prior"});
  EXPECT_NE(Write(recording).find("EDGE_PRIOR_SE2 0 0 0 0 4 0 0 16 0 1\n"), std::string::npos);
}

TEST(G2o, RefusesToWriteWhatItCannotExpress) {
  Recording recording(TestRegistry());
  recording.graph.Add(Key("pose:0"), "se2/1", {0, 0, 0});
  recording.graph.Add(Key("landmark:1"), "point2/1", {0, 0});
  recording.graph.Add(
      {"bearing_range_se2/1", {Key("pose:0"), Key("landmark:1")}, {1, 2}, Noise::Unit(), {}, ""});
  EXPECT_EQ(MessageOf([&] { Write(recording); }),
            "g2o has no tag for the factors bearing_range_se2/1 (1); write .fg");
}

TEST(G2o, SaysThatLossesAreLost) {
  Recording recording = Read(kPlane);
  recording.graph.SetLosses(MakeLoss("huber", 1));
  std::vector<std::string> notes;
  FormatG2o(recording, &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0], "g2o has no losses: those of 7 factors are not in the file");
}

TEST(G2o, ReadsHugeAndScatteredIds) {
  std::string text;
  for (const char* id : {"1000000000000000000", "5", "4000000000", "0", "70"})
    text += std::string("VERTEX_SE2 ") + id + Repeat("0", 3) + "\n";
  EXPECT_EQ(Read(text).graph.VariableCount(), 5u);
  EXPECT_THROW(Read(text + "VERTEX_SE2 4000000000 0 0 0"), Error);
}

TEST(G2o, ReadsTheRecordedFiles) {
  GRATICULE_NEEDS_DATA();
  const struct {
    const char* name;
    std::size_t variables, factors;
    bool guess;
  } files[] = {
      {"intel.g2o", 1728, 2512, true},
      {"MIT.g2o", 808, 827, true},
      {"CSAIL.g2o", 1045, 1172, false},
      {"manhattan.g2o", 3500, 5453, false},
      {"manhattanOlson3500.g2o", 3500, 5598, true},
      {"M3500.g2o", 3500, 5453, true},
      {"city10000.g2o.gz", 10000, 20687, true},
      {"kitti_00.g2o", 4541, 4677, false},
      {"ring.g2o", 434, 459, true},
      {"victoria_park.g2o", 6969 + 151, 6968 + 3640, true},
      {"parking-garage.g2o", 1661, 6275, true},
      {"sphere2500.g2o", 2500, 4949, true},
      {"torus3D.g2o.gz", 5000, 9048, true},
      {"sphere_bignoise_vertex3.g2o.gz", 2200, 8647, true},
      {"smallGrid3D.g2o", 125, 297, true},
      {"tinyGrid3D.g2o", 9, 11, true},
  };
  for (const auto& file : files) {
    SCOPED_TRACE(file.name);
    const Recording recording =
        ParseG2o(ReadFile(DataFile(file.name)), file.name, TestRegistry(), {});
    EXPECT_EQ(recording.graph.VariableCount(), file.variables);
    EXPECT_EQ(recording.graph.FactorCount(), file.factors);
    EXPECT_EQ(recording.has_initial_guess, file.guess);
    ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
    ExpectSameGraph(ParseRecording(FormatRecording(recording), "a", TestRegistry()).graph,
                    recording.graph);
    ExpectSameGraph(ParseRecording(FormatRecording(recording, true), "a", TestRegistry()).graph,
                    recording.graph);
  }
}

}  // namespace
}  // namespace graticule
