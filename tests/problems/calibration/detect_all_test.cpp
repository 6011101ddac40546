#include "graticule/problems/calibration/detect_all.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "../../solver/expect_error.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/print_target.hpp"
#include "targets.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

using testing::ExpectError;

class DetectAllTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              (std::string("detect_all_") +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  std::string Picture(int width = 400) const {
    return PngFromSvg(PrintTargetSvg(target_, {297, 210}), width);
  }

  Target target_ = test::OneOfEachKind()[2];
  fs::path folder_;
};

TEST_F(DetectAllTest, ListsWhatItCouldNotUseAndWhy) {
  for (const char* name : {"c.png", "a.png", "e.png"}) WriteFile(Path(name), Picture());
  WriteFile(Path("b.png"), Picture().substr(0, 300));
  WriteFile(Path("d.png"), Picture(500));
  WriteFile(Path("f.png"), FormatPng(GreyImage{400, 283, std::vector<std::uint8_t>(400 * 283, 200)}));
  WriteFile(Path("notes.txt"), "no picture");
  DetectAllOptions options;
  options.target = target_;
  std::size_t last = 0;
  const FoundDetections found =
      DetectAll(ExpandImages({folder_.string()}), options, [&](std::size_t done, std::size_t all) {
        EXPECT_EQ(done, last + 1);
        EXPECT_EQ(all, 6u);
        last = done;
      });
  EXPECT_EQ(last, 6u);
  EXPECT_FALSE(found.is_guessed);
  ASSERT_EQ(found.detections.views.size(), 3u);
  EXPECT_EQ(found.detections.exposures, 3u);
  EXPECT_EQ(found.detections.views[0].image, "a.png");
  EXPECT_EQ(found.detections.views[2].image, "e.png");
  EXPECT_EQ(found.files, (std::vector<std::string>{Path("a.png"), Path("c.png"), Path("e.png")}));
  EXPECT_EQ(found.detections.cameras[0].width, 400);
  EXPECT_EQ(found.detections.views[0].corners.size(), CornersOf(target_).size());
  ASSERT_EQ(found.skipped.size(), 3u);
  EXPECT_EQ(found.skipped[0].image, Path("b.png"));
  EXPECT_NE(found.skipped[0].reason.find("the picture is cut short"), std::string::npos)
      << found.skipped[0].reason;
  EXPECT_EQ(found.skipped[1].reason, "its size is 500 x 354, that of most is 400 x 283");
  EXPECT_EQ(found.skipped[2].reason, "the target was not found in it");
}

TEST_F(DetectAllTest, FindsTheSameByAnyNumberOfThreads) {
  for (int i = 0; i < 5; ++i) WriteFile(Path(std::to_string(i) + ".png"), Picture(400 + i % 2));
  DetectAllOptions options;
  options.threads = 1;
  const std::vector<std::string> images = ExpandImages({Path("?.png")});
  const FoundDetections one = DetectAll(images, options);
  options.threads = 3;
  const FoundDetections three = DetectAll(images, options);
  EXPECT_TRUE(one.is_guessed);
  EXPECT_EQ(one.detections.views.size(), 3u);
  EXPECT_EQ(FormatDetections(one.detections), FormatDetections(three.detections));
}

TEST_F(DetectAllTest, SaysSoWhereThereIsNoTarget) {
  WriteFile(Path("a.png"), FormatPng(GreyImage{400, 283, std::vector<std::uint8_t>(400 * 283, 200)}));
  ExpectError(ErrorKind::kInput, {"no calibration target was recognised in 1 of 1 images"},
              [&] { DetectAll({Path("a.png")}, {}); });
  DetectAllOptions options;
  options.target = target_;
  ExpectError(ErrorKind::kInput, {"the target (ChArUco board", "is in none of 1 images"},
              [&] { DetectAll({Path("a.png")}, options); });
  WriteFile(Path("b.png"), "no");
  ExpectError(ErrorKind::kInput, {"none of 1 images can be read; the first:", "b.png"},
              [&] { DetectAll({Path("b.png")}, options); });
  ExpectError(ErrorKind::kInput, {"x*.png: no picture has such a name"},
              [&] { ExpandImages({Path("x*.png")}); });
  ExpectError(ErrorKind::kInput, {"missing.png: No such file"},
              [&] { ExpandImages({Path("missing.png")}); });
}

TEST(GroupByCamera, GoesByWhatComesBeforeTheLastNumber) {
  const auto names = [](const std::vector<std::string>& images) {
    std::string text;
    const auto [cameras, strays] = GroupByCamera(images);
    for (const CameraImages& camera : cameras)
      text += camera.camera + ":" + std::to_string(camera.images.size()) + " ";
    for (const std::string& stray : strays) text += "not " + stray + " ";
    return text;
  };
  EXPECT_EQ(names({"a/left1.jpg", "a/left2.jpg", "a/left3.jpg", "a/right1.jpg", "a/right2.jpg",
                   "a/right4.jpg"}),
            "left:3 right:3 ");
  EXPECT_EQ(names({"cam0/1.png", "cam0/2.png", "cam0/3.png", "cam1/1.png", "cam1/2.png",
                   "cam1/3.png", "cam1/4.png"}),
            "cam0:3 cam1:4 ");
  EXPECT_EQ(names({"img_1_1.jpg", "img_1_2.jpg", "img_1_3.jpg", "img_2_1.jpg", "img_2_2.jpg",
                   "img_2_3.jpg"}),
            "img_1:3 img_2:3 ");
  // The name is where they differ, however deep; a picture of the rig itself is of no camera.
  EXPECT_EQ(names({"cam0/data/1.png", "cam0/data/2.png", "cam0/data/3.png", "cam1/data/1.png",
                   "cam1/data/2.png", "cam1/data/3.png"}),
            "cam0:3 cam1:3 ");
  EXPECT_EQ(names({"rig.png", "left1.png", "left2.png", "left3.png", "right1.png", "right2.png",
                   "right3.png"}),
            "left:3 right:3 not rig.png ");
  // One camera: one of many names, other numbers, too few.
  EXPECT_EQ(names({"a1.jpg", "a2.jpg", "a3.jpg", "a4.jpg"}), "cam0:4 ");
  EXPECT_EQ(names({"top.png", "right.png", "r45.png"}), "cam0:3 ");
  EXPECT_EQ(names({"a1.jpg", "a2.jpg", "a3.jpg", "b7.jpg", "b8.jpg", "b9.jpg"}), "cam0:6 ");
  EXPECT_EQ(names({"a1.jpg", "a2.jpg", "a3.jpg", "b1.jpg", "b2.jpg"}), "cam0:5 ");
  EXPECT_EQ(names({}), "cam0:0 ");
}

TEST_F(DetectAllTest, TakesFramesOfAVideo) {
  const GreyImage page = ParseGreyPhoto(Picture(640), "page.png");
  cv::Mat frame(static_cast<int>(page.height), static_cast<int>(page.width), CV_8UC1,
                const_cast<std::uint8_t*>(page.shades.data()));
  // Both sides even, as encoders want them; OpenCV's own encoder.
  frame = frame(cv::Rect(0, 0, 640, frame.rows / 2 * 2));
  cv::Mat colour;
  cv::cvtColor(frame, colour, cv::COLOR_GRAY2BGR);
  cv::VideoWriter video(Path("a.avi"), cv::CAP_OPENCV_MJPEG,
                        cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, colour.size());
  ASSERT_TRUE(video.isOpened());
  for (int i = 0; i < 12; ++i) video.write(colour);
  video.release();
  DetectAllOptions options;
  options.target = target_;
  options.video_frames = 4;
  const FoundDetections found = DetectAll({Path("a.avi")}, options);
  EXPECT_EQ(found.detections.views.size(), 4u);
  EXPECT_EQ(found.detections.views[1].image, "a.avi#1");
  EXPECT_EQ(found.detections.views[1].corners.size(), CornersOf(target_).size());
  WriteFile(Path("b.avi"), "no video");
  ExpectError(ErrorKind::kInput, {"b.avi: expected a video"},
              [&] { DetectAll({Path("b.avi")}, options); });
}

// --- recorded images: the tables of docs/calibration_targets.md are of all of them

class RecordedImages : public ::testing::Test {
 protected:
  void SetUp() override {
    if (fs::exists(Path("MANIFEST.md"))) return;
    const std::string missing = "no recorded images in " GRATICULE_DATA_DIR
                                "/calib; set GRATICULE_DATA_DIR when configuring";
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << missing;
    GTEST_SKIP() << missing;
  }
  static std::string Path(const std::string& file) { return GRATICULE_DATA_DIR "/calib/" + file; }

  /// Distance of the corners of these views from the recorded ones [px], both without their mean.
  static double DistanceToRecorded(const Detections& found, const std::string& recorded,
                                   std::size_t least_corners) {
    std::map<std::string, std::map<int, std::array<double, 2>>> known;
    for (const TargetView& view : ReadDetections({Path(recorded)}).views)
      for (const DetectedCorner& corner : view.corners) known[view.image][corner.id] = corner.pixel;
    double sum[2] = {}, squares = 0;
    std::size_t common = 0;
    for (const TargetView& view : found.views)
      for (const DetectedCorner& corner : view.corners) {
        const auto& own = known[view.image];
        const auto other = own.find(corner.id);
        if (other == own.end()) continue;
        ++common;
        for (const std::size_t k : {0u, 1u}) {
          const double off = corner.pixel[k] - other->second[k];
          sum[k] += off;
          squares += off * off;
        }
      }
    EXPECT_GE(common, least_corners);
    const auto n = static_cast<double>(common);
    return std::sqrt((squares - (sum[0] * sum[0] + sum[1] * sum[1]) / n) / n);
  }
};

TEST_F(RecordedImages, ShowAChessboardThatNobodyDescribed) {
  std::vector<std::string> images;
  for (const char* number : {"01", "02", "03", "14"})
    images.push_back(Path("opencv_samples/images/left") + number + ".jpg");
  const FoundDetections found = DetectAll(images, {});
  EXPECT_EQ(Described(found.target), "chessboard of 9 x 6 corners, squares of 30 mm");
  EXPECT_LT(
      DistanceToRecorded(found.detections, "opencv_samples/detections/opencv_left.json", 4 * 54),
      0.15);
}

TEST_F(DetectAllTest, TakesTheFoldersOfARigsCameras) {
  for (const char* camera : {"cam1", "cam0"})
    for (const char* name : {"10.png", "20.png", "30.png"}) {
      fs::create_directories(folder_ / "rig" / camera / "data");
      WriteFile(Path(std::string("rig/") + camera + "/data/" + name), Picture());
    }
  const std::vector<std::string> images = ExpandImages({Path("rig")});
  EXPECT_EQ(images.size(), 6u);
  const FoundDetections found = DetectCameras(GroupByCamera(images).cameras, {});
  ASSERT_EQ(found.detections.cameras.size(), 2u);
  EXPECT_EQ(found.detections.cameras[0].camera, "cam0");
  EXPECT_EQ(found.detections.exposures, 3u);

  // Other numbers: two recordings, perhaps of one camera.
  for (const char* name : {"10.png", "20.png", "30.png"})
    fs::rename(Path(std::string("rig/cam1/data/") + name),
               Path(std::string("rig/cam1/data/1") + name));
  ExpectError(ErrorKind::kInput, {"not of several cameras", "cam0/data"},
              [&] { ExpandImages({Path("rig")}); });
}

TEST_F(RecordedImages, OfTwoCamerasInOneFolderAreARig) {
  std::vector<std::string> images;
  for (const char* side : {"left", "right"})
    for (const char* number : {"01", "02", "03"})
      images.push_back(Path("opencv_samples/images/") + side + number + ".jpg");
  const FoundDetections found = DetectCameras(GroupByCamera(images).cameras, {});
  ASSERT_EQ(found.detections.cameras.size(), 2u);
  EXPECT_EQ(found.detections.cameras[1].camera, "right");
  EXPECT_EQ(found.detections.views.size(), 6u);
  EXPECT_EQ(found.detections.exposures, 3u);
}

TEST_F(RecordedImages, ShowKalibrsGridInAFisheye) {
  for (const char* name : {"TUM_VI", "top_right"}) {
    FoundDetections found = DetectAll({Path("tumvi_aprilgrid/images/") + name + ".png"}, {});
    EXPECT_EQ(Described(found.target), "aprilgrid of 6 x 6 tag36h11 tags of 30 mm, 9 mm apart");
    // All of them, to the edge of the lens' picture.
    EXPECT_EQ(found.detections.views[0].corners.size(), 144u) << name;
    found.detections.views[0].image = std::string(name) + "_1024.png";
    EXPECT_LT(DistanceToRecorded(found.detections,
                                 "tumvi_aprilgrid/detections/tumvi_aprilgrid6.json", 140),
              0.15);
  }
}

TEST_F(RecordedImages, ShowCharucoBoardsOldAndNew) {
  for (const char* set : {"2024-05-07_lifecam_480", "2024-06-19_lifecam_480_Old_Pattern"}) {
    std::vector<std::string> images =
        ExpandImages({Path(std::string("photonvision_charuco/") + set)});
    images.resize(4);
    const FoundDetections found = DetectAll(images, {});
    EXPECT_EQ(found.target.columns, 8);
    EXPECT_EQ(found.target.rows, 8);
    EXPECT_EQ(found.target.family, "DICT_4X4_50");
    EXPECT_EQ(found.target.is_legacy, std::string(set).find("Old") != std::string::npos);
    EXPECT_EQ(found.detections.views.size(), 4u);
    // OpenCV's ChArUco corners are half a pixel to the lower right; the mean is taken out.
    EXPECT_LT(DistanceToRecorded(
                  found.detections,
                  std::string("photonvision_charuco/detections/pv_charuco_") + set + ".json", 150),
              0.35);
  }
}

}  // namespace
}  // namespace graticule
