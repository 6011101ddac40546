// Recorded corners of real cameras, without a focal length or any other word: the right basin,
// always.  Bounds: shared/design/CALIBRATION.md, what others reach on the same corners.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/evaluate.hpp"

namespace graticule {
namespace {

std::string Recorded(const std::string& name) { return GRATICULE_DATA_DIR "/calib/" + name; }

struct RecordedSet {
  const char* name;  // of the test
  const char* file;
  double flat_px, free_px;  // rms that must be reached, the board as described or free
};

void PrintTo(const RecordedSet& set, std::ostream* out) { *out << set.name; }

// Flat: the thesis-like prototype's train error of the design page, or 5 % above what was measured
// here where it has none.  Free: 5 % above what was measured here.
const RecordedSet kSets[] = {
    {"opencv_left", "opencv_samples/detections/opencv_left.json", .200, .133},
    {"opencv_right", "opencv_samples/detections/opencv_right.json", .202, .119},
    {"urban_fisheye2", "urban_fisheye2/detections/urban_fisheye2.json", .182, .126},
    {"photonvision_1280", "photonvision_charuco/detections/pv_charuco_2024-05-07_lifecam_1280.json",
     .278, .205},
    {"photonvision_480", "photonvision_charuco/detections/pv_charuco_2024-05-07_lifecam_480.json",
     .358, .216},
    {"mrcal_c920", "mrcal_alpha7/detections/mrcaljava_c920.json", .293, .274},
    {"mrcal_alpha7", "mrcal_alpha7/detections/mrcal_alpha7_samyang.json", 1.48, .68},
    {"babelcalib", "babelcalib_ov_plane/detections/babelcalib_ov_plane_train.json", .479, .182},
    {"semeniuta_cam1", "semeniuta264/detections/semeniuta264_cam1.json", .271, .11},
    {"tumvi", "tumvi_aprilgrid/detections/tumvi_aprilgrid6.json", .10, .06},
};

class CalibrateRecorded : public testing::TestWithParam<RecordedSet> {
 protected:
  void SetUp() override {
    if (std::filesystem::is_regular_file(Recorded(GetParam().file))) return;
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << "no recorded corners: " << GRATICULE_DATA_DIR;
    GTEST_SKIP() << "no recorded corners: " << GRATICULE_DATA_DIR;
  }
};

TEST_P(CalibrateRecorded, ReachesTheOptimumFromCornersAlone) {
  const Detections detections = ReadDetections({Recorded(GetParam().file)});
  const Registry types = Builtins();
  CalibrationOptions options;
  const Calibration flat = BootstrapCalibration(types, detections, options);
  EXPECT_EQ(flat.report.termination, Termination::kConverged);
  EXPECT_TRUE(flat.left_out.empty());
  EXPECT_LT(flat.rms_px, GetParam().flat_px);
  EXPECT_LT(static_cast<double>(flat.outliers.size()), 0.05 * static_cast<double>(flat.corners));
  options.board = BoardShape::kFree;
  const Calibration free = RefineCalibration(types, detections, flat.state, options);
  EXPECT_LT(free.rms_px, GetParam().free_px);
}

INSTANTIATE_TEST_SUITE_P(Sets, CalibrateRecorded, testing::ValuesIn(kSets),
                         [](const auto& info) { return std::string(info.param.name); });

class BabelCalib : public CalibrateRecorded {};

// Published protocol: fit on the training set, poses only on the test set.
TEST_P(BabelCalib, PredictsTheTestSet) {
  const Registry types = Builtins();
  const Detections train = ReadDetections({Recorded(GetParam().file)});
  const Detections test =
      ReadDetections({Recorded("babelcalib_ov_plane/detections/babelcalib_ov_plane_test.json")});
  CalibrationOptions options;
  options.board = BoardShape::kFree;
  const Calibration found = BootstrapCalibration(types, train, options);
  const ReprojectionError error = EvaluateOn(found.state, test);
  EXPECT_EQ(error.unseen, 0u);
  EXPECT_EQ(error.views, 7u);
  EXPECT_LT(error.rms_px, 0.22);  // the goal; OpenCV's fisheye 0.479, mrcal's splines 0.360
}
INSTANTIATE_TEST_SUITE_P(Set, BabelCalib, testing::Values(kSets[7]),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace graticule
