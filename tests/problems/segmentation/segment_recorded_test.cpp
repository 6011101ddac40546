// Real clouds with labels (mosd): the scores that the page has, less a little.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "graticule/io/cloud_files.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"

namespace graticule {
namespace {

class SegmentRecorded : public testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::is_directory(kFolder)) return;
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << "no recorded clouds: " << kFolder;
    GTEST_SKIP() << "no recorded clouds: " << kFolder;
  }
  static constexpr const char* kFolder = GRATICULE_DATA_DIR "/segment/mosd";

  static SegmentScore ScoresOf(const std::string& set, SegmentMethod method) {
    std::set<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(kFolder) + "/" + set))
      files.insert(entry.path());
    Segmenter segmenter(DefaultsOf(method));
    ScoreOptions options;
    options.least_object = 20;
    std::vector<SegmentScore> scores;
    for (const auto& file : files) {
      const PointCloud cloud = ReadCloud(file.string());
      scores.push_back(ScoreOf(cloud.labels, segmenter.Segment(cloud), options));
    }
    return MeanOf(scores);
  }
};

TEST_F(SegmentRecorded, ConvexityFindsTheObjectsOfATable) {
  const SegmentScore score = ScoresOf("test", SegmentMethod::kConvex);
  EXPECT_GT(score.weighted_overlap, 0.969);
  EXPECT_GT(score.mean_f, 0.957);
}

// The thesis' finding (section 4.4), by what the parameters were chosen by.
TEST_F(SegmentRecorded, ColourAndNormalsAreBetterThanEitherAlone) {
  const auto score_of = [](SegmentMethod method) {
    const SegmentScore score = ScoresOf("test", method);
    return (score.mean_f + score.weighted_overlap) / 2;
  };
  const double joint = score_of(SegmentMethod::kJoint);
  EXPECT_GT(joint, 0.82);
  EXPECT_GT(joint, score_of(SegmentMethod::kColour) + 0.1);
  EXPECT_GT(joint, score_of(SegmentMethod::kNormals) + 0.1);
}

// A LIDAR that turns, 64 beams, beam by beam.
TEST_F(SegmentRecorded, BeamByBeamSaysWhatTheWholeScanDoes) {
  const PointCloud cloud = ReadCloud(GRATICULE_DATA_DIR "/segment/kitti3/velodyne/000001.bin");
  for (const SegmentMethod method : {SegmentMethod::kConvex, SegmentMethod::kNormals}) {
    Segmenter whole(DefaultsOf(method)), beams(DefaultsOf(method));
    beams.Begin(cloud.width);
    for (std::size_t i = 0; i < cloud.Size(); i += cloud.width)
      beams.AddScan({&cloud.in_sensor[i], cloud.width});
    EXPECT_EQ(whole.Segment(cloud), beams.Finish());
    EXPECT_GT(whole.SegmentCount(), 20u);
  }
}

}  // namespace
}  // namespace graticule
