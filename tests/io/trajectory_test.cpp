#include "graticule/io/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graphs.hpp"
#include "test_registry.hpp"

namespace graticule {
namespace {

TEST(Trajectory, ReadsWhatItWroteToTheBit) {
  const std::vector<StampedPose> poses = {
      {1305031102.1758, {1.3405, 0.6266, 1.6575, 0, 0.6, 0, 0.8}},
      {0.1 + 0.2, {-0.0, 1e300, 5e-324, 0, 0, 0, 1}}};
  const std::vector<StampedPose> back = ParseTum("# a comment\n\n" + FormatTum(poses), "a.tum");
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(SameBits({&back[i].stamp_s, 1}, {&poses[i].stamp_s, 1}));
    EXPECT_TRUE(
        SameBits({back[i].world_from_body.data(), 7}, {poses[i].world_from_body.data(), 7}));
  }
}

TEST(Trajectory, TakesPosesInKeyOrderAndTurnsThePlaneAboutZ) {
  Graph graph(TestRegistry());
  graph.Add(Key("pose:10"), "se2/1", {3, 4, 3 * M_PI});
  graph.Add(Key("pose:9"), "se3/1", {1, 2, 3, 0, 0, 0.6, 0.8});
  graph.Add(Key("landmark:1"), "point2/1", {1, 2});
  const std::vector<StampedPose> poses = Trajectory(graph, graph.InitialValues());
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].stamp_s, 9);
  EXPECT_EQ(poses[0].world_from_body[5], 0.6);
  EXPECT_EQ(poses[1].stamp_s, 10);
  EXPECT_EQ(poses[1].world_from_body[2], 0);
  EXPECT_NEAR(std::abs(poses[1].world_from_body[5]), 1, 1e-15);
  EXPECT_GE(poses[1].world_from_body[6], 0);
}

TEST(Trajectory, AsksForAFamilyWhereThereAreSeveral) {
  Graph graph(TestRegistry());
  EXPECT_THROW(Trajectory(graph, graph.InitialValues()), Error);
  graph.Add(Key("robot1:0"), "se2/1", {3, 4, 0});
  graph.Add(Key("robot2:0"), "se2/1", {3, 4, 0});
  EXPECT_EQ(PoseFamilies(graph), (std::vector<std::string>{"robot1", "robot2"}));
  EXPECT_EQ(MessageOf([&] { Trajectory(graph, graph.InitialValues()); }),
            "poses of several key families: name the one to write (robot1, robot2)");
  EXPECT_EQ(Trajectory(graph, graph.InitialValues(), "robot2").size(), 1u);
  EXPECT_THROW(Trajectory(graph, graph.InitialValues(), "robot3"), Error);
}

}  // namespace
}  // namespace graticule
