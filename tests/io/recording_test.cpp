#include "graticule/io/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "graphs.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

// One of everything that a file can say.
Recording Corridor() {
  Recording recording(TestRegistry());
  recording.title = "corridor, two poses";
  recording.made_by = " a path with C:\\new and a break\nin it ";
  recording.frames = "map body";
  recording.solved_by = "graticule 0.1.0";
  recording.report = R"({"note":"a \"quoted\" word\\n"})";
  recording.g2o_rotation = G2oRotation::kDouble;
  recording.has_initial_guess = false;
  Graph& graph = recording.graph;
  graph.DeclareVariableType("wheel/1", "radius:m slip");
  graph.DeclareFactorType("odometer/3", "pose:se2/1 wheel:wheel/1* | ticks*");
  graph.Add(Key("pose:0"), "se2/1", {0, -0.0, 0}, true);
  graph.Add(Key("robot-1.x:18446744073709551615"), "se2/1", {1.02, 5e-324, 0.1 + 0.2});
  graph.Add(Key("wheel:3"), "wheel/1", {1e308, -1.0 / 3});
  graph.Add(Key("v:1"), "vector2/1", {1, 2});
  const std::vector<double> information = {4, 1, 0, 9, 0.5, 16};
  graph.Add({"between_se2/1",
             {Key("pose:0"), Key("robot-1.x:18446744073709551615")},
             {1, 0, 0.1},
             Noise::Information(information),
             MakeLoss("huber", 1.345),
             "loop 17"});
  graph.Add({"between_se2/1",
             {Key("pose:0"), Key("robot-1.x:18446744073709551615")},
             {1, 0, 0.1},
             Noise::Information(information),
             {},
             ""});
  graph.Add({"prior_se2/1", {Key("pose:0")}, {1, 2, 3}, Noise::Sigmas({1, 2, 3}), {}, "a | b"});
  graph.Add({"prior_se2/1",
             {Key("pose:0")},
             {1, 2, 3},
             Noise::Sigma(0.5),
             {LossKind::kNone, 2},
             "\ttwo\nlines \\ "});
  graph.Add(
      {"odometer/3", {Key("pose:0"), Key("wheel:3")}, {5, 6, 7}, Noise::Unit(), {}, "loop 17"});
  return recording;
}

void ExpectSame(const Recording& a, const Recording& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.made_by, b.made_by);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.solved_by, b.solved_by);
  EXPECT_EQ(a.report, b.report);
  EXPECT_EQ(a.g2o_rotation, b.g2o_rotation);
  EXPECT_EQ(a.has_initial_guess, b.has_initial_guess);
  ExpectSameGraph(a.graph, b.graph);
}

Recording Read(std::string_view text) { return ParseRecording(text, "a.fg", TestRegistry()); }

TEST(Recording, ComesBackToTheBitAsTextAndAsBinary) {
  const Recording corridor = Corridor();
  const std::string text = FormatRecording(corridor);
  const std::string binary = FormatRecording(corridor, true);
  ExpectSame(Read(text), corridor);
  ExpectSame(Read(binary), corridor);
  EXPECT_EQ(FormatRecording(Read(binary)), text);
  EXPECT_EQ(FormatRecording(Read(text), true), binary);
}

TEST(Recording, ReadsTypesThatAreNotInstalled) {
  Registry empty;
  for (const graticule_variable_type_v1* table : BuiltinVariableTables())
    empty.Add(MakeVariableType(*table, "built-in"));
  const std::string text = FormatRecording(Corridor());
  const Recording read = ParseRecording(text, "a.fg", empty);
  EXPECT_EQ(FormatRecording(read), text);
  EXPECT_FALSE(read.graph.FactorAt(0).type->Known());
}

// Only the factor knows how many residuals `ticks*` stands for, and it is not here.
TEST(Recording, ReadsTheNoiseOfTypesThatAreNotInstalledWhateverItsSize) {
  for (const char* noise : {"unit", "sigma 2", "sigma 1 2 3", "information 1 0 0 1 0 1"}) {
    const std::string text =
        std::string("graticule-problem 1\nfactor odometer/3 pose:se2/1 | ticks*\nvariables 1\n") +
        "pose:0 se2/1 0 0 0\nfactors 1\nodometer/3 pose:0 | 5 6 7 | " + noise + "\nend 2\n";
    const Recording read = Read(text);
    EXPECT_NE(FormatRecording(read).find(noise), std::string::npos) << noise;
  }
}

TEST(Recording, RefusesAFileThatWasCutShort) {
  for (const bool binary : {false, true}) {
    const std::string whole = FormatRecording(Corridor(), binary);
    for (std::size_t n = 0; n + 1 < whole.size(); ++n)
      EXPECT_THROW(Read(std::string_view(whole).substr(0, n)), Error) << n << " bytes";
  }
}

TEST(Recording, RefusesAnyBitThatChanged) {
  for (const bool binary : {false, true}) {
    const std::string whole = FormatRecording(Corridor(), binary);
    for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(damaged[i] ^ 4);
      EXPECT_THROW(Read(damaged), Error) << "byte " << i;
    }
  }
}

TEST(Recording, ReadsAFileThatWasWrittenByHand) {
  const Recording read = Read(
      "graticule-problem 1\r\n# no encoding, no declarations, no checksum\r\n"
      "variables 2\r\npose:0 se2/1 0 0 +0 fixed\r\n\r\n  # between\r\npose:1 se2/1 1 0 0\r\n"
      "factors 1\r\nbetween_se2/1 pose:0 pose:1 | 1 0 0 | sigma 0.1 | cauchy 2\r\nend 3\r\n");
  EXPECT_EQ(read.graph.VariableCount(), 2u);
  EXPECT_TRUE(read.graph.IsFixed(0));
  EXPECT_EQ(read.graph.FactorAt(0).loss.kind, LossKind::kCauchy);
}

TEST(Recording, KeepsAnEmptyGraph) {
  const Recording empty{TestRegistry()};
  EXPECT_EQ(Read(FormatRecording(empty)).graph.VariableCount(), 0u);
  EXPECT_EQ(Read(FormatRecording(empty, true)).graph.VariableCount(), 0u);
}

TEST(Recording, DoesNotAllocateWhatAFileOnlyClaims) {
  EXPECT_THROW(Read("graticule-problem 1\nvariables 99999999999999\nend 3\n"), Error);
  EXPECT_THROW(Read("graticule-problem 1\nencoding binary\nvariables 99999999999999\n\nend 3\n"),
               Error);
}

TEST(Recording, KeepsTheDigitsOfUnitQuaternions) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Recording recording(TestRegistry());
  for (std::uint64_t i = 0; i < 100000; ++i) {
    double q[4];
    double norm = 0;
    for (double& x : q) {
      x = normal(random);
      norm += x * x;
    }
    for (double& x : q) x /= std::sqrt(norm);
    recording.graph.Add(Key("pose", i), "so3/1", {q[0], q[1], q[2], q[3]});
  }
  ExpectSameGraph(Read(FormatRecording(recording)).graph, recording.graph);
}

}  // namespace
}  // namespace graticule
