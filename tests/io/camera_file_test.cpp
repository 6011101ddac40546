#include "graticule/io/camera_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "../solver/expect_error.hpp"
#include "graticule/io/file.hpp"

namespace graticule {
namespace {

using testing::ExpectError;

CameraIntrinsics Intrinsics(const std::string& model, const std::vector<double>& terms) {
  CameraIntrinsics camera{"left", model, 640, 480, {535.91573396163199, 536.1, 342.28, 235.57 / 3}};
  camera.parameters.insert(camera.parameters.end(), terms.begin(), terms.end());
  return camera;
}

CameraRig RigOf(const CameraIntrinsics& camera) {
  CameraRig rig;
  rig.cameras.push_back({camera, {0, 0, 0, 0, 0, 0, 1}, {}});
  return rig;
}

CameraRig Pair(const CameraIntrinsics& camera) {
  CameraRig rig = RigOf(camera);
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[1].intrinsics.parameters[0] += 1;
  const double s = std::sqrt(1 - .01 - .04 - .0009);
  rig.cameras[1].camera_from_rig = {.1, -.02, .003, .1, -.2, .03, s};
  return rig;
}

CameraRig Again(const CameraRig& rig, CameraFormat format) {
  return ParseCameras(FormatCameras(rig, format), "again");
}

void ExpectSame(const CameraIntrinsics& a, const CameraIntrinsics& b) {
  EXPECT_EQ(a.model, b.model);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.parameters, b.parameters);  // to the last bit
}

const CameraIntrinsics kBrown4 = Intrinsics("brown4", {-.26, -.0385 / 7, .00178, -.00028});
const CameraIntrinsics kBrown5 = Intrinsics("brown5", {-.26, -.0385 / 7, .00178, -.00028, .238});
const CameraIntrinsics kBrown8 =
    Intrinsics("brown8", {.479, .0266, 4.4e-05, -1.2e-05, 9e-5, .7667, .0963, .0014});
const CameraIntrinsics kAngular4 = Intrinsics("angular4", {.01, -.0108, .0059, -.00166});
const CameraIntrinsics kUnified = Intrinsics("unified", {.62});
const CameraIntrinsics kExtended = Intrinsics("extended_unified", {.62, 1.1});
const CameraIntrinsics kSphere = Intrinsics("double_sphere", {-.2, .59});
const CameraIntrinsics kPinhole = Intrinsics("pinhole", {});

TEST(CameraFile, ComesBackToTheLastBitInEveryFormatThatHasItsModel) {
  const struct {
    CameraFormat format;
    std::vector<CameraIntrinsics> cameras;
  } cases[] = {
      {CameraFormat::kGraticule,
       {kPinhole, kBrown4, kBrown5, kBrown8, kAngular4, kUnified, kExtended, kSphere,
        Intrinsics("radial3", {1, 2, 3}), Intrinsics("angular6", {1, 2, 3, 4, 5, 1e-300}),
        Intrinsics("plugged_in", {1, -0.0, 3, 4, 5, 6, 7, 8, 9, 10})}},
      {CameraFormat::kOpenCv, {kBrown4, kBrown5, kBrown8, kAngular4}},
      {CameraFormat::kRos, {kBrown5, kBrown8, kAngular4}},
      {CameraFormat::kKalibr, {kPinhole, kBrown4, kAngular4, kExtended, kSphere}},
      {CameraFormat::kMrcal, {kPinhole, kBrown4, kBrown5, kBrown8}},
  };
  for (const auto& c : cases)
    for (const CameraIntrinsics& camera : c.cameras) {
      SCOPED_TRACE(std::string(ToString(c.format)) + " " + camera.model);
      const CameraRig again = Again(RigOf(camera), c.format);
      ASSERT_EQ(again.cameras.size(), 1u);
      ExpectSame(again.cameras[0].intrinsics, camera);
    }
}

TEST(CameraFile, WritesASmallModelAsTheLargerOneThatContainsIt) {
  const struct {
    CameraFormat format;
    CameraIntrinsics written, read;
  } cases[] = {
      {CameraFormat::kOpenCv, kPinhole, Intrinsics("brown4", {0, 0, 0, 0})},
      {CameraFormat::kOpenCv, Intrinsics("radial2", {1, 2}), Intrinsics("brown4", {1, 2, 0, 0})},
      {CameraFormat::kOpenCv, Intrinsics("radial3", {1, 2, 3}),
       Intrinsics("brown5", {1, 2, 0, 0, 3})},
      {CameraFormat::kRos, kBrown4, Intrinsics("brown5", {-.26, -.0385 / 7, .00178, -.00028, 0})},
      {CameraFormat::kRos, Intrinsics("angular3", {1, 2, 3}), Intrinsics("angular4", {1, 2, 3, 0})},
      {CameraFormat::kKalibr, Intrinsics("brown5", {1, 2, 3, 4, 0}),
       Intrinsics("brown4", {1, 2, 3, 4})},
      {CameraFormat::kKalibr, Intrinsics("angular6", {1, 2, 3, 4, 0, 0}),
       Intrinsics("angular4", {1, 2, 3, 4})},
      {CameraFormat::kMrcal, Intrinsics("brown8", {1, 2, 3, 4, 5, 0, 0, 0}),
       Intrinsics("brown5", {1, 2, 3, 4, 5})},
  };
  for (const auto& c : cases)
    ExpectSame(Again(RigOf(c.written), c.format).cameras[0].intrinsics, c.read);
}

TEST(CameraFile, HasTheUnifiedModelInTheOmnidirectionalOnesTerms) {
  for (const CameraFormat format : {CameraFormat::kOpenCv, CameraFormat::kKalibr}) {
    const CameraIntrinsics again = Again(RigOf(kUnified), format).cameras[0].intrinsics;
    EXPECT_EQ(again.model, "unified");
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR(again.parameters[i], kUnified.parameters[i], 1e-12);
  }
  const CameraIntrinsics read = ParseCameras(
                                    "cam0:\n  camera_model: omni\n  distortion_model: none\n"
                                    "  distortion_coeffs: []\n"
                                    "  intrinsics: [1.5, 800, 810, 320, 240]\n"
                                    "  resolution: [640, 480]\n",
                                    "a.yaml")
                                    .cameras[0]
                                    .intrinsics;
  EXPECT_EQ(read.parameters, (std::vector<double>{320, 324, 320, 240, 0.6}));
}

TEST(CameraFile, SaysWhichFormatsHoldWhatThisOneCannot) {
  const auto refuses = [](const CameraRig& rig, CameraFormat format, const char* message) {
    ExpectError(ErrorKind::kUsage, {message}, [&] { FormatCameras(rig, format); });
  };
  refuses(RigOf(kExtended), CameraFormat::kRos,
          "camera 'left': the ros format cannot say this extended_unified model: graticule and "
          "kalibr hold it");
  refuses(RigOf(Intrinsics("angular6", {1, 2, 3, 4, 0, 1})), CameraFormat::kOpenCv,
          "the opencv format cannot say this angular6 model: graticule holds it");
  refuses(RigOf(kAngular4), CameraFormat::kMrcal, ": graticule, opencv, ros and kalibr hold it");
  refuses(RigOf(kBrown5), CameraFormat::kKalibr, ": graticule, opencv, ros and mrcal hold it");
  refuses(Pair(kBrown5), CameraFormat::kRos, "a rig of 2 cameras does not go into one ros file");
  refuses({}, CameraFormat::kRos, "there is no camera to write");
  refuses(RigOf(Intrinsics("pinhole", {NAN})), CameraFormat::kGraticule, "all finite");
  refuses(RigOf(Intrinsics("brown4", {1})), CameraFormat::kRos,
          "camera 'left': expected 8 parameters of brown4, found 5");
}

TEST(CameraFile, KeepsARigCovariancesAndMeta) {
  CameraRig rig = Pair(kAngular4);
  rig.meta = {{"rms_px", "0.1"}, {"said \"so\"", "line\nbreak: [x]"}};
  for (int i = 0; i < 64; ++i) rig.cameras[1].covariance.push_back(1e-7 / (1 + i));
  const CameraRig again = Again(rig, CameraFormat::kGraticule);
  EXPECT_EQ(again.meta, rig.meta);
  ASSERT_EQ(again.cameras.size(), 2u);
  EXPECT_EQ(again.cameras[1].intrinsics.name, "left");
  EXPECT_EQ(again.cameras[1].camera_from_rig, rig.cameras[1].camera_from_rig);
  EXPECT_EQ(again.cameras[1].covariance, rig.cameras[1].covariance);
  EXPECT_TRUE(again.cameras[0].covariance.empty());
}

TEST(CameraFile, KeepsThePlacesOfARigsCameras) {
  CameraRig rig = Pair(kBrown4);
  for (const CameraFormat format : {CameraFormat::kKalibr, CameraFormat::kOpenCv}) {
    const CameraRig again = Again(rig, format);
    ASSERT_EQ(again.cameras.size(), 2u);
    ExpectSame(again.cameras[1].intrinsics, rig.cameras[1].intrinsics);
    for (std::size_t i = 0; i < 7; ++i)
      EXPECT_NEAR(again.cameras[1].camera_from_rig[i], rig.cameras[1].camera_from_rig[i], 1e-14);
  }
  // A third camera, and turns of nearly half a circle: the chain goes through all.
  rig.cameras.push_back(rig.cameras[1]);
  rig.cameras[2].camera_from_rig = {0, 1, 2, .999, .01, -.02, 0};
  double* q = rig.cameras[2].camera_from_rig.data() + 3;
  q[3] = std::sqrt(1 - q[0] * q[0] - q[1] * q[1] - q[2] * q[2]);
  const CameraRig chain = Again(rig, CameraFormat::kKalibr);
  ASSERT_EQ(chain.cameras.size(), 3u);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(chain.cameras[2].camera_from_rig[i], rig.cameras[2].camera_from_rig[i], 1e-14);
  CameraRig single;
  single.cameras = {rig.cameras[2]};
  const CameraRig mrcal = Again(single, CameraFormat::kMrcal);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(mrcal.cameras[0].camera_from_rig[i], rig.cameras[2].camera_from_rig[i], 1e-14);
}

TEST(CameraFile, RefusesAFileThatWasCutShort) {
  for (const CameraFormat format :
       {CameraFormat::kGraticule, CameraFormat::kOpenCv, CameraFormat::kRos, CameraFormat::kKalibr,
        CameraFormat::kMrcal}) {
    CameraRig rig = format == CameraFormat::kRos || format == CameraFormat::kMrcal ? RigOf(kBrown4)
                                                                                   : Pair(kBrown4);
    rig.meta["a"] = "b";
    if (format == CameraFormat::kMrcal) rig.cameras[0].intrinsics = kBrown8;
    const std::string whole = FormatCameras(rig, format);
    for (std::size_t n = 0; n + 1 < whole.size(); ++n)
      EXPECT_THROW(ParseCameras(std::string_view(whole).substr(0, n), "a"), Error)
          << ToString(format) << ": " << n << " of " << whole.size() << " bytes";
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) ADD_FAILURE() << "there is no " << from << " in " << text;
  return text.replace(at, from.size(), to);
}

TEST(CameraFile, SaysWhatIsWrongAndWhere) {
  const std::string opencv = FormatCameras(RigOf(Intrinsics("brown5", {1, 2, 3, 4, 5})),
                                           CameraFormat::kOpenCv),
                    ros = FormatCameras(RigOf(kAngular4), CameraFormat::kRos),
                    kalibr = FormatCameras(Pair(kAngular4), CameraFormat::kKalibr),
                    mrcal = FormatCameras(RigOf(kBrown8), CameraFormat::kMrcal),
                    own = FormatCameras(RigOf(kSphere), CameraFormat::kGraticule);
  const struct {
    std::string text;
    const char* message;
  } cases[] = {
      {"", "a.yaml: the file is empty"},
      {"a: 1\n", "a.yaml: expected a camera's file"},
      {Replaced(opencv, "1, 2, 3, 4, 5", "1, 2, nan, 4, 5"), "a.yaml:16:17: expected a finite"},
      {Replaced(opencv, "1, 2, 3, 4, 5", "1, 2, 3, 4"), "expected 5 x 1 numbers, found 4"},
      {Replaced(Replaced(opencv, "1, 2, 3, 4, 5", "1, 2, 3, 4, 5, 6, 7"), "rows: 5", "rows: 7"),
       "expected 0, 4, 5, 8, 12 or 14 coefficients of distortion, found 7"},
      {Replaced(Replaced(opencv, "4, 5]", "4, 5, 6, 7, 8, 1, 0, 0, 0]"), "rows: 5", "rows: 12"),
       "the thin prism and the tilted sensor are none of our models"},
      {Replaced(opencv, "image_width: 640", "image_width: 0"),
       "a.yaml:4:14: expected a whole number in 1 to 1048576, found '0'"},
      {Replaced(opencv, "[535.915733961632, 0", "[535.915733961632, 0.5"),
       "expected a camera matrix without skew"},
      {Replaced(opencv, "fisheye_model: 0", "fisheye_model: 1"),
       "expected 4 coefficients of a fisheye model, found 5"},
      {Replaced(opencv, "camera_matrix", "image_width"), "'image_width' is there already"},
      {Replaced(ros, "equidistant", "double_sphere"),
       "expected plumb_bob, rational_polynomial or equidistant, found 'double_sphere'"},
      {Replaced(kalibr, "pinhole", "pinhole-fov"),
       "a.yaml:3:17: expected pinhole, omni, eucm or ds"},
      {Replaced(kalibr, "equi", "fov"), "expected radtan, equi or none, found 'fov'"},
      {Replaced(kalibr, "cam1", "cam2"), "expected cam1: the cameras before overlap with cam1"},
      {Replaced(kalibr, "[0, 0, 0, 1]", "[0, 0, 1, 1]"), "expected 0, 0, 0, 1"},
      {Replaced(kalibr, "  - [0", "  - [1"), "expected a rotation"},
      {Replaced(mrcal, "OPENCV8", "CAHVOR"), "a.yaml:3:19: expected LENSMODEL_PINHOLE"},
      {Replaced(mrcal, "OPENCV8", "OPENCV5"), "expected a list of 9 numbers, found a list of 12"},
      {Replaced(mrcal, "],", "]"), "expected ',' or '}'"},
      {Replaced(own, "end: 1", "end: 2"), "expected a whole number in 1 to 1, found '2'"},
      {Replaced(own, "graticule-camera: 1", "graticule-camera: 2"), "a.yaml:1:19: expected"},
      {Replaced(own, "0, 1]", "0, 2]"), "expected a unit quaternion"},
      {Replaced(own, "model: ", "model: the "), "expected the name of a camera model, found 'the "},
      {"<opencv_storage><a>1</b></opencv_storage>", "a.yaml:1:24: expected '</a>'"},
      {std::string(5000, '['), "a.yaml:"},
      {"{'lensmodel': " + std::string(5000, '['), "expected at most 100 levels"},
  };
  for (const auto& c : cases)
    ExpectError(ErrorKind::kInput, {"a.yaml:", c.message}, [&] { ParseCameras(c.text, "a.yaml"); });
}

TEST(CameraFile, ReadsOpenCvsXml) {
  const CameraRig rig = ParseCameras(R"(<?xml version="1.0"?>
<opencv_storage>
<!-- by hand -->
<image_width>640</image_width><image_height>480</image_height>
<camera_matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>
<data>500. 0. 320. 0. 510. 240. 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix"><rows>5</rows><cols>1</cols><dt>d</dt>
<data>-1e-1 .2 0 0 3.</data></distortion_coefficients>
<images><_>a.png</_><_>b.png</_></images>
</opencv_storage>
)",
                                     "a.xml");
  ASSERT_EQ(rig.cameras.size(), 1u);
  EXPECT_EQ(rig.cameras[0].intrinsics.model, "brown5");
  EXPECT_EQ(rig.cameras[0].intrinsics.width, 640);
  EXPECT_EQ(rig.cameras[0].intrinsics.parameters,
            (std::vector<double>{500, 510, 320, 240, -.1, .2, 0, 0, 3}));
}

TEST(CameraFile, KnowsItsFormatsByName) {
  EXPECT_EQ(CameraFormatFromWord("mrcal"), CameraFormat::kMrcal);
  EXPECT_EQ(CameraFormatOf("a/b.cameramodel"), CameraFormat::kMrcal);
  EXPECT_EQ(CameraFormatOf("a/b.cameramodel.gz"), CameraFormat::kMrcal);
  EXPECT_EQ(CameraFormatOf("camera.yaml"), CameraFormat::kGraticule);
  ExpectError(ErrorKind::kUsage, {"there is no format 'matlab' of cameras; expected graticule"},
              [] { CameraFormatFromWord("matlab"); });
}

// --- files of the original tools

class RecordedCameras : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(Path("MANIFEST.md"))) return;
    const std::string missing = "no recorded images in " GRATICULE_DATA_DIR
                                "/calib; set GRATICULE_DATA_DIR when configuring";
    const char* ci = std::getenv("CI");
    if (ci && std::string(ci) == "true") FAIL() << missing;
    GTEST_SKIP() << missing;
  }
  static std::string Path(const std::string& file) { return GRATICULE_DATA_DIR "/calib/" + file; }
};

TEST_F(RecordedCameras, AreRead) {
  const CameraIntrinsics left = ReadCamera(Path("opencv_samples/left_intrinsics.yml"));
  EXPECT_EQ(left.model, "brown5");
  EXPECT_EQ(left.width, 640);
  EXPECT_EQ(left.parameters[0], 535.91573396163199);
  EXPECT_EQ(left.parameters[8], .23839153080878486);

  const CameraRig stereo = ReadCameras(Path("opencv_samples/intrinsics.yml"));
  ASSERT_EQ(stereo.cameras.size(), 2u);
  EXPECT_EQ(stereo.cameras[1].intrinsics.parameters[4], -.16916358306948096);
  EXPECT_EQ(stereo.cameras[1].intrinsics.width, 0);

  const CameraIntrinsics alpha = ReadCamera(Path("mrcal_alpha7/opencv8-0.cameramodel"));
  EXPECT_EQ(alpha.model, "brown8");
  EXPECT_EQ(alpha.width, 6016);
  EXPECT_EQ(alpha.parameters[11], 0.001407513313);
  ExpectSame(ReadCamera(Path("mrcal_alpha7/c920.cameramodel")),
             {"",
              "brown8",
              1600,
              896,
              {1190.608979, 1190.068998, 804.2783086, 455.1773601, 0.02722490305, -0.1509815462,
               -0.0005247860649, 0.000941291852, 0.1112874619, -0.009490756014, 0.01096065265,
               -0.0004255420927}});
  ExpectError(ErrorKind::kInput, {"splined-0.cameramodel:", "LENSMODEL_SPLINED_STEREOGRAPHIC"},
              [] { ReadCamera(Path("mrcal_alpha7/splined-0.cameramodel")); });
}

}  // namespace
}  // namespace graticule
