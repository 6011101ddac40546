#include "graticule/io/detections.hpp"
#include "graphs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>

#include "../solver/expect_error.hpp"
#include "graticule/io/file.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

// One camera, two views: the least that has everything.
const char* const kSmall = R"({"name": "left", "size": [640, 480], "meta": {"lens": "any"},
 "views": [
  {"name": "left01.jpg", "ids": [0, [1, 2]], "obj": [[0, 0, 0], [0.1, 0.2, 0]],
   "img": [[1.5, 2], [3, 4]], "w": [1, 0.5]},
  {"name": "left02.jpg", "ids": [0, 7], "obj": [[0, 0, 0], [1, 1, 0]],
   "img": [[5, 6], [7, 8]], "w": [-1, 1]}]}
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) ADD_FAILURE() << "there is no " << from;
  return text.replace(at, from.size(), to);
}

Detections Sample(std::size_t cameras) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1e3, 1e3);
  Detections detections;
  for (std::size_t c = 0; c < cameras; ++c)
    detections.cameras.push_back({"cam \"" + std::to_string(c), 640 + int(c), 480});
  detections.exposures = 9;
  std::array<double, 3> places[5];
  for (auto& place : places) place = {any(random), any(random) * 1e-9, -0.0};
  for (std::size_t i = 0; i < 8; ++i) {
    TargetView view{"v" + std::to_string(i), i % cameras, i, {}};
    for (int k = 0; k < 5; ++k) {
      if (any(random) < 0) continue;
      view.corners.push_back({3 * k, places[k], {any(random), std::ldexp(any(random), -1060)}});
    }
    detections.views.push_back(view);
  }
  return detections;
}

void ExpectSame(const Detections& a, const Detections& b) {
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    EXPECT_EQ(a.cameras[i].camera, b.cameras[i].camera);
    EXPECT_EQ(a.cameras[i].width, b.cameras[i].width);
    EXPECT_EQ(a.cameras[i].height, b.cameras[i].height);
  }
  EXPECT_EQ(a.exposures, b.exposures);
  ASSERT_EQ(a.views.size(), b.views.size());
  for (std::size_t i = 0; i < a.views.size(); ++i) {
    const TargetView &v = a.views[i], &w = b.views[i];
    EXPECT_EQ(v.image, w.image);
    EXPECT_EQ(v.camera, w.camera);
    EXPECT_EQ(v.exposure, w.exposure);
    ASSERT_EQ(v.corners.size(), w.corners.size());
    for (std::size_t k = 0; k < v.corners.size(); ++k) {
      EXPECT_EQ(v.corners[k].id, w.corners[k].id);
      EXPECT_EQ(v.corners[k].in_target, w.corners[k].in_target);
      EXPECT_EQ(std::signbit(v.corners[k].in_target[2]), std::signbit(w.corners[k].in_target[2]));
      EXPECT_EQ(v.corners[k].pixel, w.corners[k].pixel);
    }
  }
}

TEST(Detections, ReadsWhatWasRecorded) {
  const Detections detections = ParseDetections(kSmall, "a.json");
  ASSERT_EQ(detections.cameras.size(), 1u);
  EXPECT_EQ(detections.cameras[0].camera, "left");
  EXPECT_EQ(detections.cameras[0].width, 640);
  EXPECT_EQ(detections.cameras[0].height, 480);
  EXPECT_EQ(detections.exposures, 2u);
  ASSERT_EQ(detections.views.size(), 2u);
  EXPECT_EQ(detections.views[0].image, "left01.jpg");
  ASSERT_EQ(detections.views[0].corners.size(), 2u);
  EXPECT_EQ(detections.views[0].corners[1].id, 65536 + 2);
  EXPECT_EQ(detections.views[0].corners[1].in_target, (std::array<double, 3>{.1, .2, 0}));
  EXPECT_EQ(detections.views[0].corners[1].pixel, (std::array<double, 2>{3, 4}));
  // The recordist set the other one aside.
  ASSERT_EQ(detections.views[1].corners.size(), 1u);
  EXPECT_EQ(detections.views[1].corners[0].id, 7);
  EXPECT_EQ(detections.views[1].exposure, 1u);
}

TEST(Detections, ComesBackToTheLastBit) {
  for (const std::size_t cameras : {1u, 3u}) {
    const Detections written = Sample(cameras);
    const std::string text = FormatDetections(written);
    const Detections read = ParseDetections(text, "a.json");
    ExpectSame(written, read);
    EXPECT_EQ(FormatDetections(read), text);
  }
}

TEST(Detections, RefusesAFileThatWasCutShort) {
  const std::string whole = FormatDetections(Sample(2));
  for (std::size_t n = 0; n + 1 < whole.size(); n += n < 2000 ? 1 : 7)
    EXPECT_THROW(ParseDetections(std::string_view(whole).substr(0, n), "a.json"), Error) << n;
}

TEST(Detections, SaysWhatIsWrongAndWhere) {
  const struct {
    const char *from, *to, *message;
  } cases[] = {
      {"[1.5, 2]", "[NaN, 2]", "a.json:4:13: not JSON: syntax error"},
      {"[1.5, 2]", "[1e999, 2]", "a number is larger than a double can hold"},
      {"[1.5, 2]", "[null, 2]", "a.json: views[0].img[0][0]: expected a number, found 'null'"},
      {"[1.5, 2]", "[1.5]", "views[0].img[0]: expected a list of 2, found a list of 1"},
      {"[[5, 6], ", "[", "views[1].img: expected a list of 2, found a list of 1"},
      {"\"w\": [-1, 1]", "\"w\": [1]", "views[1].w: expected a list of 2, found a list of 1"},
      {"\"ids\": [0, 7]", "\"ids\": [0, 0]", "views[1].ids[1]: corner 0 is in this view already"},
      {"\"ids\": [0, 7]", "\"ids\": [7, 0]",
       "views[1].obj[1]: corner 0 has another place on the target elsewhere"},
      {"\"ids\": [0, 7]", "\"ids\": [0, -7]",
       "views[1].ids[1]: expected a whole number in 0 to 1073741823, found '-7'"},
      {"\"ids\": [0, 7]", "\"ids\": [0, [1, 70000]]",
       "views[1].ids[1][1]: expected a whole number in 0 to 65535, found '70000'"},
      {"[640, 480]", "[640, 0]", "size[1]: expected a whole number in 1 to 1048576, found '0'"},
      {"[640, 480]", "[640, 18446744073709551615]", "size[1]: expected a whole number"},
      {"\"name\": \"left02.jpg\"", "\"name\": \"left02.jpg\", \"size\": [320, 480]",
       "views[1].size: images of one camera have one size: this is 320 x 480, the camera 640 x "
       "480"},
      {"\"obj\"", "\"object\"", "views[0]: expected a member 'obj'"},
      {"\"views\"", "\"exposures\": 1, \"views\"", "exposures: expected a whole number in 2 to"},
      {"\"left01.jpg\"", "\"left01.jpg\", \"exposure\": 1",
       "views[1]: exposure 1 of this camera is there already"},
  };
  for (const auto& c : cases)
    ExpectError(ErrorKind::kInput, {"a.json:", c.message},
                [&] { ParseDetections(Replaced(kSmall, c.from, c.to), "a.json"); });
  ExpectError(ErrorKind::kInput, {"a.json: views: there is no view"},
              [] { ParseDetections(R"({"name": "", "size": [1, 1], "views": []})", "a.json"); });
}

Detections Camera(const std::string& name, const std::vector<std::string>& images) {
  Detections detections;
  detections.cameras.push_back({name, 640, 480});
  for (const std::string& image : images)
    detections.views.push_back({image, 0, detections.exposures++, {{1, {1, 2, 0}, {3, 4}}}});
  return detections;
}

std::vector<std::size_t> Exposures(const Detections& detections) {
  std::vector<std::size_t> exposures;
  for (const TargetView& view : detections.views) exposures.push_back(view.exposure);
  return exposures;
}

TEST(Detections, MatchesTheExposuresOfARig) {
  const auto combine = [](const Detections& a, const Detections& b) {
    return CombineCameras({a, b}, {"a.json", "b.json"});
  };
  // By the number where the names differ; 10 is not 1.
  const Detections numbered = combine(Camera("l", {"left01.jpg", "left02.jpg", "left10.jpg"}),
                                      Camera("r", {"right2.png", "right10.png", "right11.png"}));
  EXPECT_EQ(Exposures(numbered), (std::vector<std::size_t>{0, 1, 2, 1, 2, 3}));
  EXPECT_EQ(numbered.exposures, 4u);
  EXPECT_EQ(numbered.views[3].camera, 1u);
  // By the whole name where one is the same: numbers may then mean something else.
  const Detections named =
      combine(Camera("l", {"a1.jpg", "b1.jpg", "c7.jpg"}), Camera("r", {"b1.png", "d7.png"}));
  EXPECT_EQ(Exposures(named), (std::vector<std::size_t>{0, 1, 2, 1, 3}));
  // What cannot be told apart is not matched.
  const Detections unclear = combine(Camera("l", {"a1.jpg", "b1.jpg", "one.jpg"}),
                                     Camera("r", {"c1.jpg", "d2.jpg", "two.jpg"}));
  EXPECT_EQ(Exposures(unclear), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Detections, RefusesCamerasThatAreNotOneRig) {
  ExpectError(ErrorKind::kInput, {"b.json: there is a camera 'l' already"}, [] {
    CombineCameras({Camera("l", {"1"}), Camera("l", {"2"})}, {"a.json", "b.json"});
  });
  Detections moved = Camera("r", {"2"});
  moved.views[0].corners[0].in_target[0] += 1e-9;
  ExpectError(ErrorKind::kInput, {"b.json: corner 1 has another place on the target elsewhere"},
              [&] {
                CombineCameras({Camera("l", {"1"}), moved}, {"a.json", "b.json"});
              });
}

// --- lists of corners

const CornerListOptions kTwoByTwo = {2, 2, 0.5, 640, 480};

std::string CornersOf(const std::string& image, const std::string& last = "") {
  std::string text;
  for (int i = 0; i < 4; ++i)
    text +=
        image + " " + std::to_string(i) + ".5 7 " + (i == 2 && !last.empty() ? last : "1") + "\n";
  return text;
}

Detections ParseList(const std::string& text, const CornerListOptions& options = kTwoByTwo) {
  return ParseCornerList(text, "a.vnl", "camera", options);
}

TEST(CornerList, ReadsWhatMrcalKeeps) {
  const Detections detections =
      ParseList("# mrgingham\n# filename x y weight\n" + CornersOf("a.jpg") + "empty.jpg - - -\n" +
                CornersOf("b.jpg", "0"));
  EXPECT_EQ(detections.cameras[0].camera, "camera");
  ASSERT_EQ(detections.views.size(), 2u);
  ASSERT_EQ(detections.views[0].corners.size(), 4u);
  const DetectedCorner& corner = detections.views[0].corners[3];
  EXPECT_EQ(corner.id, 3);
  EXPECT_EQ(corner.in_target, (std::array<double, 3>{0.5, 0.5, 0}));
  EXPECT_EQ(corner.pixel, (std::array<double, 2>{3.5, 7}));
  ASSERT_EQ(detections.views[1].corners.size(), 3u);
  EXPECT_EQ(detections.views[1].corners[2].id, 3);
}

TEST(CornerList, KnowsLevelsFromWeights) {
  // Level 0 is the full picture, and the best there is; "-" was not seen.
  const std::string corners = CornersOf("a.jpg", "0");
  EXPECT_EQ(ParseList("# filename x y level\n" + corners).views[0].corners.size(), 4u);
  EXPECT_EQ(ParseList("# filename x y weight\n" + corners).views[0].corners.size(), 3u);
  EXPECT_EQ(ParseList("# filename x y level\n" + CornersOf("a.jpg", "-")).views[0].corners.size(),
            3u);
}

TEST(CornerList, SaysWhatIsWrongAndWhere) {
  const std::string header = "# filename x y weight\n", a = CornersOf("a.jpg");
  const struct {
    std::string text;
    const char* message;
  } cases[] = {
      {"", "a.vnl:1:1: the file is empty"},
      {header, "a.vnl:1:1: there is no view"},
      {header + a.substr(0, a.size() - 1), "a.vnl:5:14: expected the end of the line"},
      {header + a + "b.jpg 1 2 1\n", "a.vnl:7:1: expected 4 corners of 'b.jpg', found 1"},
      {header + a + a, "a.vnl:10:1: expected 4 corners of 'a.jpg', found 8"},
      {header + a + CornersOf("b.jpg") + a, "a.vnl:10:1: corners of 'a.jpg' are there already"},
      {header + "a.jpg nan 2 1\n", "a.vnl:2:7: expected a finite number (x of the corner)"},
      {header + "a.jpg 1 2\n", "a.vnl:2:10: expected a number (the weight), found the end of"},
  };
  for (const auto& c : cases)
    ExpectError(ErrorKind::kInput, {c.message}, [&] { ParseList(c.text); });
  ExpectError(ErrorKind::kUsage, {"a.vnl: a list of corners says neither"},
              [&] { ParseList(header + a, {}); });
}

// --- recorded

std::string Recorded(const std::string& file) { return GRATICULE_DATA_DIR "/calib/" + file; }

class RecordedDetections : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(Recorded("MANIFEST.md"))) return;
    const std::string missing = "no recorded images in " GRATICULE_DATA_DIR
                                "/calib; set GRATICULE_DATA_DIR when configuring";
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << missing;
    GTEST_SKIP() << missing;
  }
};

std::size_t CountCorners(const Detections& detections) {
  std::size_t corners = 0;
  for (const TargetView& view : detections.views) corners += view.corners.size();
  return corners;
}

TEST_F(RecordedDetections, AreReadWholeAndComeBack) {
  const struct {
    const char* file;
    std::size_t views, corners;
  } sets[] = {
      {"opencv_samples/detections/opencv_left.json", 13, 702},
      {"urban_fisheye2/detections/urban_fisheye2.json", 16, 768},
      {"tumvi_aprilgrid/detections/tumvi_aprilgrid6.json", 6, 859},
      {"babelcalib_ov_plane/detections/babelcalib_ov_plane_train.json", 18, 6864},
      {"photonvision_charuco/detections/pv_charuco_2024-05-07_lifecam_1280.json", 16, 749},
      {"semeniuta264/detections/semeniuta264_cam1.json", 264, 16632},
      // 25 were set aside: c920.cameramodel.
      {"mrcal_alpha7/detections/mrcaljava_c920.json", 16, 1600 - 25},
  };
  for (const auto& set : sets) {
    const Detections detections = ReadDetections({Recorded(set.file)});
    EXPECT_EQ(detections.views.size(), set.views) << set.file;
    EXPECT_EQ(CountCorners(detections), set.corners) << set.file;
    ExpectSame(detections, ParseDetections(FormatDetections(detections), "again.json"));
  }
}

TEST_F(RecordedDetections, OfARigAreMatched) {
  const Detections stereo =
      ReadDetections({Recorded("opencv_samples/detections/opencv_left.json"),
                      Recorded("opencv_samples/detections/opencv_right.json")});
  EXPECT_EQ(stereo.exposures, 13u);
  for (std::size_t i = 0; i < 13; ++i)
    EXPECT_EQ(stereo.views[i].exposure, stereo.views[13 + i].exposure);
  const Detections large =
      ReadDetections({Recorded("semeniuta264/detections/semeniuta264_cam1.json"),
                      Recorded("semeniuta264/detections/semeniuta264_cam2.json")});
  EXPECT_EQ(large.exposures, 264u);
}

TEST_F(RecordedDetections, AreTheSameFromTheOriginalToolsFiles) {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(Recorded("babelcalib_ov_plane/train")))
    if (entry.path().extension() == ".orpc") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  const Detections original = ReadDetections(files);
  const Detections json =
      ReadDetections({Recorded("babelcalib_ov_plane/detections/babelcalib_ov_plane_train.json")});
  EXPECT_EQ(original.cameras[0].camera, "train");
  ASSERT_EQ(original.views.size(), json.views.size());
  for (std::size_t i = 0; i < json.views.size(); ++i) {
    const TargetView &a = original.views[i], &b = json.views[i];
    EXPECT_EQ(a.image, b.image);
    ASSERT_EQ(a.corners.size(), b.corners.size());
    for (std::size_t k = 0; k < a.corners.size(); ++k) {
      EXPECT_EQ(a.corners[k].id, b.corners[k].id);
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(a.corners[k].in_target[j], b.corners[k].in_target[j], 1e-12);
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(a.corners[k].pixel[j], b.corners[k].pixel[j], 1e-9);
    }
  }

  // Packed.
  const TemporaryDirectory packed;
  std::filesystem::create_directory(packed / "train");
  WriteFile(packed / ("train/" + std::filesystem::path(files[0]).filename().string() + ".gz"),
            ReadFile(files[0]));
  for (const auto& entry : std::filesystem::directory_iterator(Recorded("babelcalib_ov_plane")))
    if (entry.path().extension() == ".dsc" || entry.path().extension() == ".tp")
      WriteFile(packed / (entry.path().filename().string() + ".gz"),
                ReadFile(entry.path().string()));
  const Detections first = ReadDetections(std::vector<std::string>{
      packed / ("train/" + std::filesystem::path(files[0]).filename().string() + ".gz")});
  ASSERT_EQ(first.views.size(), 1u);
  EXPECT_EQ(first.views[0].corners.size(), original.views[0].corners.size());

  const Detections list =
      ReadDetections({Recorded("mrcal_alpha7/corners_c920.vnl")}, {10, 10, 0.0254, 1600, 896});
  EXPECT_EQ(list.views.size(), 16u);
  EXPECT_EQ(list.cameras[0].camera, "corners_c920");
  EXPECT_EQ(CountCorners(list), 1600u);
}

TEST_F(RecordedDetections, CutShortAreRefused) {
  const std::string name = Recorded("babelcalib_ov_plane/train/br0_cam01-2020-05-07-14-10-53.orpc");
  const NamedText view = {name, ReadFile(name)};
  const NamedText board = {"b.dsc", ReadFile(Recorded("babelcalib_ov_plane/ov_plane.dsc"))};
  const NamedText places = {"b.tp", ReadFile(Recorded("babelcalib_ov_plane/ov_plane.tp"))};
  for (std::size_t n = 0; n + 2 < view.text.size(); n += n < 400 ? 1 : 97) {
    const NamedText cut = {"a.orpc", view.text.substr(0, n)};
    EXPECT_THROW(ParseBabelcalib({cut}, board, places), Error) << n;
  }
  for (std::size_t n = 0; n + 2 < board.text.size(); n += 131)
    EXPECT_THROW(ParseBabelcalib({view}, {"b.dsc", board.text.substr(0, n)}, places), Error) << n;
}

}  // namespace
}  // namespace graticule
