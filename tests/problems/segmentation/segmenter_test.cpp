#include "graticule/problems/segmentation/segmenter.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "clouds.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"
#include "graticule/solver/error.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
}  // namespace

// Counted, so that a frame can be shown to need none.
void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // GCC 12 does not see that new is ours
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#pragma GCC diagnostic pop

namespace graticule {
namespace {

constexpr SegmentMethod kMethods[] = {SegmentMethod::kConvex, SegmentMethod::kJoint,
                                      SegmentMethod::kColour, SegmentMethod::kNormals,
                                      SegmentMethod::kImage};

TEST(Segmenter, AllocatesNothingAfterTheFirstFrame) {
  const PointCloud first = test::RandomCloud(80, 60, 1), second = test::RandomCloud(80, 60, 1);
  for (const SegmentMethod method : kMethods) {
    Segmenter segmenter(DefaultsOf(method));
    segmenter.Segment(first);
    const std::size_t before = allocations;
    segmenter.Segment(second);
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(method);
  }
}

TEST(Segmenter, SaysTheSameTwiceWhateverCameBefore) {
  const PointCloud cloud = test::RandomCloud(80, 60, 2), other = test::RandomCloud(30, 90, 3);
  for (const SegmentMethod method : kMethods) {
    Segmenter fresh(DefaultsOf(method)), used(DefaultsOf(method));
    used.Segment(other);
    EXPECT_EQ(fresh.Segment(cloud), used.Segment(cloud));
  }
}

TEST(Segmenter, RefusesACloudWithoutColoursWhereItNeedsThem) {
  PointCloud cloud = test::RandomCloud(20, 20, 4);
  cloud.colours.clear();
  EXPECT_THROW(Segmenter(DefaultsOf(SegmentMethod::kJoint)).Segment(cloud), Error);
  EXPECT_NO_THROW(Segmenter(DefaultsOf(SegmentMethod::kConvex)).Segment(cloud));
  EXPECT_THROW(SegmentMethodOf("watershed"), Error);
}

TEST(Segmenter, GivesPointsWithoutReturnNoSegment) {
  const PointCloud cloud = test::RandomCloud(50, 40, 5);
  for (const SegmentMethod method : {SegmentMethod::kConvex, SegmentMethod::kJoint}) {
    Segmenter segmenter(DefaultsOf(method));
    const auto& labels = segmenter.Segment(cloud);
    for (std::size_t i = 0; i < cloud.Size(); ++i)
      EXPECT_TRUE(cloud.in_sensor[i].allFinite() || labels[i] == 0) << i;
  }
}

class Scenes : public testing::TestWithParam<const char*> {};

TEST_P(Scenes, AreFoundByConvexity) {
  const SimulatedScene scene = SimulateScene(GetParam());
  Segmenter segmenter(DefaultsOf(SegmentMethod::kConvex));
  ScoreOptions options;
  options.least_object = 20;
  const SegmentScore score = ScoreOf(scene.cloud.labels, segmenter.Segment(scene.cloud), options);
  EXPECT_GT(score.found, 0.99) << score.mean_f;
  EXPECT_GT(score.mean_f, 0.85);
}

INSTANTIATE_TEST_SUITE_P(Both, Scenes, testing::Values("hallway", "hill"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace graticule
