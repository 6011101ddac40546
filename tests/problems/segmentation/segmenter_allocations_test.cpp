// That a frame needs no memory once there was one like it.  Not built with the thread sanitizer,
// for new cannot be replaced there.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "clouds.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
}  // namespace

// Counted, so that a frame can be shown to need none.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
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

TEST(Segmenter, ScanByScanAllocatesNothingAfterTheFirstSweep) {
  const PointCloud cloud = test::RandomCloud(80, 60, 1);
  for (const SegmentMethod method : kMethods) {
    Segmenter segmenter(DefaultsOf(method));
    const auto sweep = [&] {
      segmenter.Begin(cloud.width);
      for (std::size_t i = 0; i < cloud.Size(); i += cloud.width)
        segmenter.AddScan({&cloud.in_sensor[i], cloud.width}, {&cloud.colours[i], cloud.width});
      segmenter.Finish();
    };
    sweep();
    const std::size_t before = allocations;
    sweep();
    EXPECT_EQ(allocations - before, 0u) << static_cast<int>(method);
  }
}

}  // namespace
}  // namespace graticule
