// The killian recording, cut into 14 robots: shared/data/mapping/MANIFEST.md.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "graticule/io/file.hpp"
#include "graticule/io/g2o_laser.hpp"
#include "graticule/io/pose_sequence.hpp"
#include "room.hpp"

namespace graticule {
namespace {

constexpr const char* kScans = GRATICULE_DATA_DIR "/mapping/killian_g2o/killian.g2o.gz";
constexpr const char* kSequence = GRATICULE_DATA_DIR "/mapping/sequences/killian14_seq.pgseq.gz";

class LiveMapRecorded : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_regular_file(kScans) || !std::filesystem::is_regular_file(kSequence)) {
      ASSERT_EQ(std::getenv("CI"), nullptr) << "recorded data is missing: " << kScans;
      GTEST_SKIP() << "no recorded data: " << kScans;
    }
    laser_ = ParseG2oLaser(ReadFile(kScans), kScans);
    sequence_ = ParsePoseSequence(ReadFile(kSequence), kSequence);
    ASSERT_EQ(laser_.log.scans.size(), 3873u);
    ASSERT_EQ(sequence_.nodes, 3873u);
    ASSERT_EQ(sequence_.GraphCount(), 430u);
  }

  void Add(std::uint32_t node, const PlanarPose& pose, LiveMap* map) const {
    const LaserScan& scan = laser_.log.scans[node];
    map->AddNode(sequence_.RobotOf(node), laser_.log.GeometryOf(scan), laser_.log.RangesOf(scan),
                 pose);
  }

  G2oLaser laser_;
  PoseSequence sequence_;
};

TEST_F(LiveMapRecorded, TheCoverKeepsTheStructureAndWhatIsKnown) {
  std::vector<PlanarPose> last(sequence_.nodes);
  for (const PoseSequence::Pose& pose : sequence_.poses) last[pose.node] = pose.world_from_robot;
  LiveMapOptions options;
  LiveMap covered(options);
  options.method = MapMethod::kNaive;
  LiveMap naive(options);
  for (std::uint32_t node = 0; node < sequence_.nodes; ++node) {
    Add(node, last[node], &covered);
    Add(node, last[node], &naive);
  }
  const MapUpdate update = covered.Update();
  naive.Update();
  EXPECT_LT(update.cover, update.nodes);
  const MapAgreement agreement = CompareMaps(naive.Map()->Grid(), covered.Map()->Grid());
  EXPECT_GE(agreement.Iou(Occupancy::kStructure), 0.9);
  EXPECT_GE(agreement.KnownRecall(), 0.97);
}

TEST_F(LiveMapRecorded, FollowsTheSequenceExactly) {
  LiveMapOptions options;
  LiveMap map(options);
  std::vector<NodeId> ids(sequence_.nodes, UINT32_MAX);
  std::vector<test::Node> nodes;
  for (std::size_t g = 0; g < sequence_.GraphCount(); ++g) {
    for (const PoseSequence::Pose& pose : sequence_.Graph(g)) {
      NodeId& id = ids[pose.node];
      if (id != UINT32_MAX) {
        map.UpdatePose(id, pose.world_from_robot);
        continue;
      }
      id = static_cast<NodeId>(nodes.size());
      Add(pose.node, pose.world_from_robot, &map);
      const LaserScan& scan = laser_.log.scans[pose.node];
      const Span<const float> ranges = laser_.log.RangesOf(scan);
      nodes.push_back({sequence_.RobotOf(pose.node),
                       laser_.log.GeometryOf(scan),
                       {ranges.begin(), ranges.end()}});
    }
    map.Update();
    if (g % 60 != 9 && g + 1 != sequence_.GraphCount()) continue;
    ASSERT_TRUE(test::SameMap(*map.Map(), *test::Fresh(map, options, nodes))) << "graph " << g;
  }
  EXPECT_EQ(map.NodeCount(), 3873u);
}

}  // namespace
}  // namespace graticule
