// Lenses from plug-ins.  That one calibrates recorded corners: tests/apps/calibrate_test.cpp.

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/factors/camera_model.hpp"
#include "graticule/factors/lens_plugin.hpp"
#include "graticule/solver/check.hpp"
#include "load.hpp"

namespace graticule {
namespace {

using testing::PluginFile;
using testing::With;

TEST(LensPlugin, IsACameraModelByName) {
  const Registry types = With({"division"});
  EXPECT_EQ(LoadLenses(PluginFile("division"), types), std::vector<std::string>{"division"});
  const CameraModel& model = CameraModelOf("division");
  EXPECT_EQ(model.parameters, 5);
  EXPECT_TRUE(model.sees_behind);
  EXPECT_EQ(model.start[0], -0.25);
  // lambda = -1/4 is stereographic: 2 tan(theta / 2), here of a ray 120 degrees off the axis.
  const double parameters[] = {100, 100, 0, 0, -0.25};
  const double angle = 2 * M_PI / 3, ray[] = {std::sin(angle), 0, std::cos(angle)};
  double pixel[2];
  ASSERT_TRUE(model.project(parameters, ray, pixel, nullptr, nullptr));
  EXPECT_NEAR(pixel[0], 200 * std::tan(angle / 2), 1e-10);
  // The same again is no mistake, and moves nothing.
  EXPECT_EQ(LoadLenses(PluginFile("division"), types).size(), 1u);
  EXPECT_EQ(&CameraModelOf("division"), &model);
}

TEST(LensPlugin, BringsFactorsWithRightJacobians) {
  const Registry types = With({"division"});
  Graph graph(types);
  graph.Add(Key("camera:0"), "camera_division/1", {500, 510, 320, 240, -0.1});
  graph.Add(Key("camera_from_rig:0"), "se3/1", {.1, 0, .02, 0, std::sin(.1), 0, std::cos(.1)});
  graph.Add(Key("target:0"), "se3/1", {.2, -.1, .5, std::sin(.2), 0, 0, std::cos(.2)});
  graph.Add(Key("warp:0"), "board_warp/1", {.1, -.2, .05});
  graph.Add(Key("corner:0"), "point3/1", {.1, .2, .01});
  const std::vector<Key> chain = {Key("camera:0"), Key("camera_from_rig:0"), Key("target:0")};
  std::vector<Key> view = chain, corner = chain;
  view.push_back(Key("warp:0"));
  corner.push_back(Key("corner:0"));
  graph.Add({"reprojection_division/1",
             view,
             {.1, .2, 0, 300, 200, -.1, .1, 0, 250, 220},
             Noise::Sigma(.1),
             {},
             ""});
  graph.Add({"corner_reprojection_division/1", corner, {300, 200}, Noise::Sigma(.1), {}, ""});
  graph.Add({"prior_camera_division/1",
             {Key("camera:0")},
             {500, 500, 320, 240, 0},
             Noise::Unit(),
             {},
             ""});
  const std::vector<JacobianCheck> checks = CheckJacobians(graph, graph.InitialValues());
  EXPECT_EQ(checks.size(), 3u);
  for (const JacobianCheck& check : checks)
    EXPECT_EQ(check.wrong + check.failed, 0u) << check.type << " " << check.worst;
}

TEST(LensPlugin, IsRefusedWithAReasonAndLeavesNothing) {
  const auto refusal = [](const std::string& name) {
    Registry types = Builtins();
    LoadPlugin(PluginFile(name), &types);
    try {
      LoadLenses(PluginFile(name), types);
    } catch (const Error& error) {
      EXPECT_EQ(error.Kind(), ErrorKind::kMissingType);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refusal("lens_taken").find("camera model pinhole is already taken"), std::string::npos);
  EXPECT_NE(refusal("lens_without_types").find("lens bare needs variable type camera_bare/1"),
            std::string::npos);
  EXPECT_THROW(CameraModelOf("bare"), Error);
}

TEST(LensPlugin, IsNotWhatOtherPluginsAre) {
  EXPECT_TRUE(LoadLenses(PluginFile("radar"), With({"radar"})).empty());
}

}  // namespace
}  // namespace graticule
