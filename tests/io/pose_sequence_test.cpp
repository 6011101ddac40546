#include "graticule/io/pose_sequence.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <limits>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

void Append(std::string* bytes, std::int32_t number) {
  for (int i = 0; i < 4; ++i)
    bytes->push_back(static_cast<char>(static_cast<std::uint32_t>(number) >> (8 * i)));
}
void Append(std::string* bytes, float number) {
  std::int32_t word;
  std::memcpy(&word, &number, sizeof(word));
  Append(bytes, word);
}

// Five nodes of two robots; of the second graph, one new and one that moved.
std::string Sequence(std::int32_t last_node = 3, float last_x = 5, std::int32_t present = 3) {
  std::string bytes("PGSEQ1\0\0", 8);
  for (const int number : {5, 2, 2, 2, 2}) Append(&bytes, number);
  const auto pose = [&bytes](std::int32_t node, float x, float y, float yaw) {
    Append(&bytes, node);
    for (const float number : {x, y, yaw}) Append(&bytes, number);
  };
  pose(0, 1, 2, 0.5f);
  pose(2, -1, -2, 3);
  Append(&bytes, present);
  Append(&bytes, 2);
  pose(0, 1.25f, 2, 0.5f);
  pose(last_node, last_x, 6, 0);
  return bytes;
}

PoseSequence Parse(std::string_view bytes) { return ParsePoseSequence(bytes, "a.pgseq"); }

TEST(PoseSequence, IsRead) {
  const PoseSequence sequence = Parse(Sequence());
  EXPECT_EQ(sequence.nodes, 5u);
  EXPECT_EQ(sequence.robots, 2u);
  ASSERT_EQ(sequence.GraphCount(), 2u);
  ASSERT_EQ(sequence.Graph(1).size(), 2u);
  EXPECT_EQ(sequence.Graph(0)[1].node, 2u);
  EXPECT_EQ(sequence.Graph(0)[1].world_from_robot.yaw, 3);
  EXPECT_EQ(sequence.Graph(1)[0].world_from_robot.x, 1.25);
  // Robot r has 5 r / 2 <= node < 5 (r + 1) / 2.
  for (const std::uint32_t node : {0u, 1u}) EXPECT_EQ(sequence.RobotOf(node), 0u);
  for (const std::uint32_t node : {2u, 3u, 4u}) EXPECT_EQ(sequence.RobotOf(node), 1u);
}

TEST(PoseSequence, OfUnequalSharesGivesEachNodeItsRobot) {
  PoseSequence sequence;
  sequence.nodes = 3873;
  sequence.robots = 14;
  for (std::uint32_t node = 0; node < sequence.nodes; ++node) {
    const std::uint32_t robot = sequence.RobotOf(node);
    EXPECT_LE(sequence.nodes * robot / 14, node);
    EXPECT_LT(node, sequence.nodes * (robot + 1) / 14);
  }
}

TEST(PoseSequence, RefusesWhatIsBroken) {
  const std::string whole = Sequence();
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_THROW(Parse(std::string_view(whole).substr(0, n)), Error) << n << " bytes";
  EXPECT_THROW(Parse(whole + "x"), Error);
  EXPECT_THROW(Parse(Sequence(5)), Error);
  EXPECT_THROW(Parse(Sequence(-1)), Error);
  EXPECT_THROW(Parse(Sequence(3, std::numeric_limits<float>::infinity())), Error);
  EXPECT_THROW(Parse(Sequence(3, 5, 4)), Error);
  EXPECT_THROW(Parse(Sequence(2, 5, 3)), Error);
  try {
    Parse(Sequence(7));
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a.pgseq: byte 84: expected a node below 5, found 7");
  }
}

// Else 36 bytes would take 2 GB.
TEST(PoseSequence, TakesNoMemoryForNodesThatDoNotCome) {
  std::string bytes("PGSEQ1\0\0", 8);
  for (const int number : {INT32_MAX, 1, 1, 1, 1, INT32_MAX - 1}) Append(&bytes, number);
  for (int i = 0; i < 3; ++i) Append(&bytes, 0.5f);
  const auto most_kilobytes = [] {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before = most_kilobytes();
  const PoseSequence sequence = Parse(bytes);
  EXPECT_LT(most_kilobytes() - before, 100'000);
  EXPECT_EQ(sequence.nodes, static_cast<std::uint32_t>(INT32_MAX));
  EXPECT_EQ(sequence.RobotOf(sequence.poses[0].node), 0u);
}

}  // namespace
}  // namespace graticule
