#include "graticule/io/toro.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graphs.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/toro_angles.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

Recording Read(std::string_view text) { return ParseToro(text, "x.graph", TestRegistry()); }

std::string Write(const Recording& recording) {
  std::vector<std::string> notes;
  return FormatToro(recording, &notes);
}

TEST(Toro, ReadsThePlaneWithItsOrderOfTheInformation) {
  const Recording recording = Read(
      "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0.5\nVERTEX2 5 1 0 0.5\n"
      "EDGE2 0 1 1 2 0.5 11 12 22 33 13 23\nEDGE2 0 5 1 2 0.5 11 0 22 33 0 0\n");
  const Graph& graph = recording.graph;
  const Span<const double> information = graph.FactorAt(0).noise.values;
  const double expected[6] = {11, 12, 13, 22, 23, 33};
  EXPECT_TRUE(SameBits(information, {expected, 6}));
  EXPECT_EQ(graph.FactorAt(0).source, "odometry");
  EXPECT_EQ(graph.FactorAt(1).source, "loop");
  ExpectSameGraph(Read(Write(recording)).graph, graph);
}

TEST(Toro, KeepsEquivAsTheSourceOfTheEdgesBetween) {
  const Recording recording = Read(
      "VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0.5\nVERTEX2 2 1 0 0.5\nEDGE2 0 1 1 2 0.5 1 0 1 1 0 0\n"
      "EDGE2 0 2 1 2 0.5 1 0 1 1 0 0\nEQUIV 2 0\n");
  ASSERT_EQ(recording.graph.FactorCount(), 2u);
  EXPECT_EQ(recording.graph.FactorAt(1).source, "equiv");
  ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
}

TEST(Toro, ReadsSpaceAsRollPitchYaw) {
  std::string information;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column) information += row == column ? " 1" : " 0";
  const Recording recording = Read(
      "VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 2 3 0.1 0.2 0.3\n"
      "EDGE3 0 1 1 2 3 0 0 1.5707963267948966" +
      information);
  const Span<const double> measured = recording.graph.FactorAt(0).measurement;
  EXPECT_EQ(recording.graph.FactorAt(0).type->name, "between_se3/1");
  EXPECT_NEAR(measured[5], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(measured[6], std::sqrt(0.5), 1e-15);
  const Recording again = Read(Write(recording));
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(again.graph.ValueOf(1)[i], recording.graph.ValueOf(1)[i], 1e-15);
}

TEST(Toro, TurnsQuaternionsIntoAnglesAndBackAlsoLookingStraightUp) {
  for (double roll = -3; roll < 3.1; roll += 0.5)
    for (const double pitch : {-M_PI / 2, -M_PI / 2 + 1e-7, -1.0, 0.0, 0.3, M_PI / 2})
      for (double yaw = -3; yaw < 3.1; yaw += 0.5) {
        const double angles[3] = {roll, pitch, yaw};
        double q[4], back[3], again[4];
        QuaternionFromAngles(angles, q);
        AnglesFromQuaternion(q, back);
        QuaternionFromAngles(back, again);
        const double dot = q[0] * again[0] + q[1] * again[1] + q[2] * again[2] + q[3] * again[3];
        // 1 - |cos(half the angle)|: 1e-16 is an angle of 3e-8 rad, what is left at the poles.
        EXPECT_NEAR(std::abs(dot), 1, 1e-15) << roll << " " << pitch << " " << yaw;
      }
}

TEST(Toro, RefusesToWriteWhatItCannotExpressAndSaysWhatIsLost) {
  Recording recording = Read("VERTEX2 0 0 0 0\nVERTEX2 1 1 0 0\nEDGE2 0 1 1 2 0.5 1 0 1 1 0 0\n");
  recording.graph.SetFixed(0, true);
  recording.graph.SetLosses(MakeLoss("huber", 1));
  std::vector<std::string> notes;
  FormatToro(recording, &notes);
  EXPECT_EQ(notes.size(), 2u);
  recording.graph.Add(Key("landmark:0"), "point2/1", {0, 0});
  EXPECT_EQ(MessageOf([&] { Write(recording); }),
            "TORO has only poses and the edges between them, not point2/1 (1); write .fg");
}

TEST(Toro, KeepsKeysThatItCannotExpress) {
  Recording recording(TestRegistry());
  recording.graph.Add(Key("robot1:0"), "se2/1", {0, 0, 0});
  recording.graph.Add(Key("robot2:0"), "se2/1", {0, 0, 0});
  recording.graph.Add({"between_se2/1",
                       {Key("robot1:0"), Key("robot2:0")},
                       {1, 2, 3},
                       Noise::Sigma(0.5),
                       {},
                       "odometry"});
  const Recording read = Read(Write(recording));
  EXPECT_EQ(read.graph.KeyOf(1).ToString(), "robot2:0");
  EXPECT_EQ(read.graph.FactorAt(0).noise.values[3], 4);
}

TEST(Toro, ReadsTheRecordedFile) {
  GRATICULE_NEEDS_DATA();
  const Recording recording = Read(ReadFile(DataFile("gtsam_w100.graph")));
  EXPECT_EQ(recording.graph.VariableCount(), 100u);
  EXPECT_EQ(recording.graph.FactorCount(), 300u);
  std::size_t equivalences = 0;
  for (FactorId id = 0; id < recording.graph.FactorCount(); ++id)
    equivalences += recording.graph.FactorAt(id).source == "equiv";
  EXPECT_GT(equivalences, 0u);
  ExpectSameGraph(Read(Write(recording)).graph, recording.graph);
}

}  // namespace
}  // namespace graticule
