#include "graticule/problems/segmentation/segment_score.hpp"

#include <gtest/gtest.h>

#include "graticule/problems/segmentation/segment_statistics.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

TEST(SegmentScore, OfTheTruthIsOne) {
  const std::vector<std::uint32_t> labels = {1, 1, 2, 2, 0, 3};
  ScoreOptions options;
  options.width = 3;
  const SegmentScore score = ScoreOf(labels, {7, 7, 4, 4, 9, 1}, options);
  EXPECT_EQ(score.weighted_overlap, 1);
  EXPECT_EQ(score.achievable, 1);
  EXPECT_EQ(score.under_segmentation, 0);
  EXPECT_EQ(score.boundary_recall, 1);
  EXPECT_EQ(score.mean_f, 1);
  EXPECT_EQ(score.found, 1);
  EXPECT_EQ(score.objects, 3u);
  EXPECT_EQ(score.segments, 4u - 1u);
}

TEST(SegmentScore, IsWhatOneCountsByHand) {
  // Two labels of four points; one segment has all of the first and one of the second.
  const std::vector<std::uint32_t> labels = {1, 1, 1, 1, 20, 20, 20, 20};
  ScoreOptions options;
  options.least_object = 10;
  const SegmentScore score = ScoreOf(labels, {5, 5, 5, 5, 5, 6, 6, 6}, options);
  EXPECT_DOUBLE_EQ(score.weighted_overlap, 0.5 * 4 / 5 + 0.5 * 3 / 4);
  EXPECT_DOUBLE_EQ(score.achievable, 7.0 / 8);
  EXPECT_DOUBLE_EQ(score.under_segmentation, (1.0 + 1.0) / 8);
  EXPECT_DOUBLE_EQ(score.mean_f, 6.0 / 7);
  EXPECT_EQ(score.found, 1);
  EXPECT_EQ(score.objects, 1u);
}

TEST(SegmentScore, TakesAPointWithoutASegmentForOneOfItsOwn) {
  const SegmentScore none = ScoreOf({1, 1, 1, 1}, {0, 0, 0, 0});
  EXPECT_DOUBLE_EQ(none.weighted_overlap, 1.0 / 4);
  EXPECT_DOUBLE_EQ(none.mean_f, 2.0 / 5);
  EXPECT_EQ(none.found, 0);
  EXPECT_EQ(none.achievable, 1);
  EXPECT_EQ(none.segments, 0u);
  // Points of two labels that are alone do not join these.
  const SegmentScore some = ScoreOf({1, 1, 1, 2, 2, 2}, {7, 7, 0, 0, 8, 8});
  EXPECT_EQ(some.under_segmentation, 0);
  EXPECT_DOUBLE_EQ(some.weighted_overlap, 2.0 / 3);
  EXPECT_EQ(some.segments, 2u);
}

TEST(SegmentScore, CountsBordersThatAreNear) {
  std::vector<std::uint32_t> labels(100), near(100), far(100);
  for (std::size_t i = 0; i < 100; ++i) {
    labels[i] = i % 10 < 5 ? 1 : 2;
    near[i] = i % 10 < 7 ? 1 : 2;
    far[i] = i % 10 < 8 ? 1 : 2;
  }
  ScoreOptions options;
  options.width = 10;
  EXPECT_EQ(ScoreOf(labels, near, options).boundary_recall, 1);
  EXPECT_EQ(ScoreOf(labels, far, options).boundary_recall, 0);
}

TEST(SegmentScore, RefusesListsOfUnequalLengths) { EXPECT_THROW(ScoreOf({1, 2}, {1}), Error); }

TEST(SegmentStatistics, OfATileAreItsPlaceAndPlane) {
  PointCloud cloud;
  std::vector<std::uint32_t> labels;
  for (int i = 0; i < 21; ++i)
    for (int k = 0; k < 11; ++k) {
      cloud.in_sensor.push_back(Eigen::Vector3d(2, 0.1 * i - 1, 0.1 * k).cast<float>());
      cloud.colours.push_back({10, 20, static_cast<std::uint8_t>(k * 10)});
      labels.push_back(1);
    }
  cloud.in_sensor.push_back(kNoReturn);
  cloud.colours.push_back({255, 255, 255});
  labels.push_back(0);
  cloud.width = cloud.Size();
  const auto segments = StatisticsOf(cloud, labels, 1);
  ASSERT_EQ(segments.size(), 1u);
  const SegmentStatistics& tile = segments[0];
  EXPECT_EQ(tile.points, 231u);
  EXPECT_LT((tile.centre - Eigen::Vector3d(2, 0, 0.5)).norm(), 1e-6);
  EXPECT_LT((tile.least - Eigen::Vector3d(2, -1, 0)).norm(), 1e-6);
  EXPECT_LT((tile.most - Eigen::Vector3d(2, 1, 1)).norm(), 1e-6);
  EXPECT_LT((tile.normal - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(tile.offset_m, 2, 1e-6);
  EXPECT_NEAR(tile.spread.x(), std::sqrt(440.0 / 12) * 0.1, 1e-6);
  EXPECT_NEAR(tile.spread.z(), 0, 1e-6);
  EXPECT_NEAR(tile.mean_colour.z(), 50, 1e-9);
  EXPECT_EQ(MeanColours(labels, segments)[3], (Rgb{10, 20, 50}));
  EXPECT_EQ(FalseColours(labels).back(), (Rgb{0, 0, 0}));
  EXPECT_THROW(StatisticsOf(cloud, {1}, 1), Error);
}

}  // namespace
}  // namespace graticule
