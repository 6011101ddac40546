#include "graticule/io/correspondences.hpp"

#include <gtest/gtest.h>

#include "graphs.hpp"
#include "graticule/io/rig.hpp"

namespace graticule {
namespace {

TEST(Correspondences, ComeBackToTheBitAndAreRefusedAtTheirPlace) {
  const std::string text = "x,y,z,u,v,name\n# by hand,,\n1,2,3,4.5,5,left\n-1 0.1 1e-9 7 8\n";
  const auto points = ParseCorrespondences(text, "c.csv");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].name, "left");
  EXPECT_EQ(points[1].name, "2");
  EXPECT_EQ(points[1].in_lidar, (std::array<double, 3>{-1, 0.1, 1e-9}));
  const std::string once = FormatCorrespondences(points);
  EXPECT_EQ(FormatCorrespondences(ParseCorrespondences(once, "d.csv")), once);
  const struct {
    const char *text, *message;
  } cases[] = {
      {"", "c.csv:1:1: the file is empty"},
      {"x,y,z,u,v\n", "c.csv:1:1: there is no correspondence in this file"},
      {"1,2,3,4\n", "c.csv:1:8: expected a number (v of the pixel), found the end of the line"},
      {"1,2,nan,4,5\n", "c.csv:1:5: expected a finite number (z of the point), found 'nan'"},
      {"1,2,3,4,5,a\n1,2,3,4,5,a\n", "c.csv:2:11: the name 'a' is there already"},
      {"2,,8,4,5,6\n", "c.csv:1:3: expected a value before this comma"},
      {"1 2 3 4 5\n ,2,3,4,5\n", "c.csv:2:2: expected a value before this comma"},
      {"1,2,3,4,5,a,b\n", "c.csv:1:13: expected the end of the line, found 'b'"},
      {"1,2,3,4,5", "c.csv:1:10: expected the end of the line: the file may be cut short"},
      {"1,2,3,4e7,5\n", "c.csv:1:7: expected u of the pixel within 1e6, found '4e7'"},
  };
  for (const auto& broken : cases)
    EXPECT_EQ(MessageOf([&] { ParseCorrespondences(broken.text, "c.csv"); }), broken.message);
}

TEST(Planes, HaveNormalsOfLengthOne) {
  const auto planes = ParsePlanes("image,nx,ny,nz,offset\na.png,0,0.6,0.8,2\n", "p.csv");
  EXPECT_EQ(planes[0].image, "a.png");
  EXPECT_EQ(planes[0].offset_m, 2);
  EXPECT_EQ(MessageOf([] { ParsePlanes("a.png,0,1,1,2\n", "p.csv"); }),
            "p.csv:1:11: expected a normal of length 1");
}

TEST(Rig, IsACameraFileWithTheLidarAsItsFrame) {
  LidarRig rig;
  rig.camera = {"cam", "brown4", 640, 480, {500, 501, 320, 240, 0.1, -0.02, 1e-3, 0}};
  rig.camera_from_lidar = {0.1, -0.2, 1. / 3, 0.5, -0.5, 0.5, 0.5};
  for (int i = 0; i < 36; ++i) rig.covariance.push_back(i / 7.);
  rig.meta["rms_px"] = "1.5";
  const LidarRig read = ParseRig(FormatRig(rig), "rig.yaml");
  EXPECT_EQ(read.camera.parameters, rig.camera.parameters);
  EXPECT_EQ(read.camera_from_lidar, rig.camera_from_lidar);
  EXPECT_EQ(read.covariance, rig.covariance);
  EXPECT_EQ(read.meta, rig.meta);
  EXPECT_EQ(FormatRig(read), FormatRig(rig));
  CameraRig camera;
  camera.cameras.push_back({rig.camera, {0, 0, 0, 0, 0, 0, 1}, {}});
  EXPECT_NE(MessageOf([&] {
              ParseRig(FormatCameras(camera, CameraFormat::kGraticule), "camera.yaml");
            }).find("camera.yaml: this camera file does not say where a LIDAR is"),
            std::string::npos);
}

}  // namespace
}  // namespace graticule
