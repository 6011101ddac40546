#include "graticule/problems/calibration/render.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "graticule/problems/calibration/detect.hpp"
#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Found {
  std::size_t seen = 0, visible = 0;
  double rms_px = 0, right_px = 0, down_px = 0;  // of detected - true
};

// Pictures of a target at several poses, and where its corners are found in them.
Found Detected(const Target& target, const CameraIntrinsics& lens, const RenderOptions& options) {
  const Camera camera(lens);
  const TargetLayout layout = LayoutOf(target);
  const TargetRenderer renderer(target, camera, options);
  const TargetDetector detector(target);
  RandomNumbers random(5);
  Found found;
  for (int i = 0; i < 4; ++i) {
    Placement placement;
    placement.across = .42 + .05 * i;
    placement.down = .45 + .03 * i;
    placement.size = .5 + .05 * i;
    placement.tilt_sideways = .4 - .25 * i;
    placement.tilt_up = .2 * i - .3;
    const auto pose = PlaceTarget(camera, layout, placement);
    const std::vector<DetectedCorner> truth = VisibleCorners(camera, layout, *pose, {}, {0, 0});
    found.visible += VisibleCorners(camera, layout, *pose).size();
    std::map<int, std::array<double, 2>> where;
    for (const DetectedCorner& corner : truth) where[corner.id] = corner.pixel;
    for (const DetectedCorner& corner : detector.Detect(renderer.Render(pose, &random))) {
      if (where.count(corner.id) == 0) continue;
      const double right = corner.pixel[0] - where[corner.id][0];
      const double down = corner.pixel[1] - where[corner.id][1];
      found.right_px += right;
      found.down_px += down;
      found.rms_px += right * right + down * down;
      ++found.seen;
    }
  }
  const auto count = static_cast<double>(found.seen);
  found.right_px /= count;
  found.down_px /= count;
  found.rms_px = std::sqrt(found.rms_px / count);
  return found;
}

TEST(Render, ShowsTagsWhereTheModelSays) {
  for (const std::size_t lens : {0u, 3u}) {
    const Found found = Detected(AprilCalMosaic(), StudyLenses()[lens].camera, {});
    EXPECT_GT(found.seen, found.visible * 95 / 100) << lens;
    EXPECT_LT(found.rms_px, .25) << lens;  // of libapriltag on mosaics (CALIBRATION.md: .15 - .21)
    EXPECT_NEAR(found.right_px, 0, .05) << lens;
    EXPECT_NEAR(found.down_px, 0, .05) << lens;
  }
}

TEST(Render, ShowsChessboardsToAHundredthOfAPixel) {
  Target board;
  board.kind = TargetKind::kChessboard;
  board.columns = 9;
  board.rows = 6;
  board.pitch_m = .03;
  RenderOptions clean;
  clean.noise = 0;
  const Found found = Detected(board, StudyLenses()[3].camera, clean);
  EXPECT_EQ(found.seen, 4u * 54);
  EXPECT_LT(found.rms_px, .02);
  EXPECT_NEAR(found.right_px, 0, .003);
  EXPECT_NEAR(found.down_px, 0, .003);
}

TEST(Render, ShowsGridsWhoseRowsRunUp) {
  Target grid = AprilCalMosaic();
  grid.kind = TargetKind::kAprilGrid;
  grid.columns = grid.rows = 6;
  grid.pitch_m = .055;
  grid.border_cells = 2;  // as Kalibr's
  const Found found = Detected(grid, StudyLenses()[3].camera, {});
  EXPECT_GT(found.seen, 500u);
  EXPECT_LT(found.rms_px, .15);
  EXPECT_NEAR(found.right_px, 0, .02);
  EXPECT_NEAR(found.down_px, 0, .02);
}

TEST(Render, HasTheSameShadesForTheSameSeed) {
  const Camera camera(StudyLenses()[2].camera);
  const Target target = AprilCalMosaic();
  const TargetRenderer renderer(target, camera);
  const auto pose = PlaceTarget(camera, LayoutOf(target), {});
  RandomNumbers a(3), b(3), c(4);
  const GreyImage first = renderer.Render(pose, &a);
  EXPECT_EQ(first.shades, renderer.Render(pose, &b).shades);
  EXPECT_NE(first.shades, renderer.Render(pose, &c).shades);
}

TEST(Render, HasTheNoiseAndTheBlurThatWereAskedFor) {
  const Camera camera(StudyLenses()[3].camera);
  RenderOptions plain;
  plain.has_room = false;
  plain.blur_px = 0;
  plain.noise = 5;
  RandomNumbers random(1);
  const GreyImage wall =
      TargetRenderer(AprilCalMosaic(), camera, plain).Render(std::nullopt, &random);
  double sum = 0, squares = 0;
  for (const std::uint8_t shade : wall.shades) {
    sum += shade;
    squares += shade * shade;
  }
  const auto count = static_cast<double>(wall.shades.size());
  EXPECT_NEAR(sum / count, 140, .1);
  EXPECT_NEAR(std::sqrt(squares / count - sum * sum / count / count), 5, .1);

  const auto contrast = [&](double blur_px) {
    RenderOptions options;
    options.noise = 0;
    options.blur_px = blur_px;
    const GreyImage image =
        TargetRenderer(AprilCalMosaic(), camera, options)
            .Render(PlaceTarget(camera, LayoutOf(AprilCalMosaic()), {}), &random);
    double steps = 0;
    for (std::size_t i = 1; i < image.shades.size(); ++i)
      steps += std::pow(image.shades[i] - image.shades[i - 1], 2);
    return steps;
  };
  EXPECT_LT(contrast(2), .5 * contrast(.5));
}

TEST(Render, ShowsNothingFromBehindAndRefusesWhatIsNoTarget) {
  const Camera camera(StudyLenses()[2].camera);
  RenderOptions clean;
  clean.noise = 0;
  const TargetRenderer renderer(AprilCalMosaic(), camera, clean);
  RandomNumbers random(1);
  Se3Array behind = *PlaceTarget(camera, LayoutOf(AprilCalMosaic()), {});
  behind = PoseOf(IsometryOf(behind) * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()));
  EXPECT_EQ(renderer.Render(behind, &random).shades, renderer.Render(std::nullopt, &random).shades);
  Target none = AprilCalMosaic();
  none.columns = 0;
  EXPECT_THROW(TargetRenderer(none, camera), Error);
  clean.rays = 0;
  EXPECT_THROW(TargetRenderer(AprilCalMosaic(), camera, clean), Error);
}

}  // namespace
}  // namespace graticule
