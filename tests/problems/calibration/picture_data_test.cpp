#include "graticule/problems/calibration/picture_data.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/problems/calibration/advice.hpp"
#include "graticule/problems/calibration/simulate.hpp"

namespace graticule {
namespace {

// A calibration that is the truth: what is described is known.
struct Known {
  SimulatedDetections simulated;
  ModelSelection selection;
  Posterior posterior;

  explicit Known(const CalibrationSimulation& simulation, Person person = Person::kRosRules)
      : simulated(SimulateDetections(simulation, person, 12)) {
    Calibration& solved = selection.calibration;
    solved.state = simulated.truth;
    solved.sigma_px = simulation.sigma_px;
    for (const TargetView& view : simulated.detections.views) {
      solved.use.emplace_back(view.corners.size(), 1);
      solved.corners += view.corners.size();
    }
    solved.use[1][0] = 0;
    solved.outliers = {{1, 0, 3}};
    PosteriorOptions options;
    options.sigma_px = simulation.sigma_px;
    posterior = ComputePosterior(simulated.detections, solved.state, solved.use, options);
  }
};

CalibrationSimulation Simulation() {
  CalibrationSimulation simulation;
  simulation.camera = StudyLenses()[2].camera;
  simulation.camera.name = "cam0";
  simulation.sigma_px = 0.2;
  return simulation;
}

TEST(PictureData, DescribesACameraByItsNumbers) {
  const Known known(Simulation());
  DescribeOptions options;
  options.posterior = &known.posterior;
  options.accuracy_px = 1;
  const CameraReport report =
      DescribeCamera(known.simulated.detections, known.selection.calibration, 0, options);
  ASSERT_EQ(report.numbers.size(), 8u);
  EXPECT_EQ(report.numbers[0].name, "fx");
  EXPECT_EQ(report.numbers[0].unit, "px");
  EXPECT_EQ(report.numbers[0].deviation, known.posterior.Deviations("camera:0")[0]);
  ASSERT_EQ(report.views.size(), 12u);
  EXPECT_EQ(report.views[1].outliers, 1u);
  // Distances of two axes of 0.2 px each.
  EXPECT_NEAR(report.rms_px, 0.2 * std::sqrt(2), 0.02);
  std::size_t corners = 0;
  for (const TargetView& view : known.simulated.detections.views) corners += view.corners.size();
  EXPECT_EQ(report.residuals.corners.size(), corners);
  EXPECT_EQ(report.coverage.corners.size(), corners);
  // A lens of 114 degrees: rings to 50.
  ASSERT_EQ(report.coverage.rings.size(), 5u);
  EXPECT_EQ(report.coverage.rings.back().angle_deg, 50);
  ASSERT_EQ(report.maps.size(), 2u);
  EreOptions where_seen;
  where_seen.gauge_pixels =
      SeenPixels(known.simulated.detections, 0, known.selection.calibration.use);
  EXPECT_EQ(report.max_ere_px,
            EreGrid(Camera(report.camera), where_seen).Map(known.posterior.OfCamera(0)).MaxPx());
  ASSERT_EQ(report.section->curves.size(), 2u);
  EXPECT_EQ(report.section->curves[0].points.size(), 121u);
  EXPECT_GT(report.section->seen_to_px, 50);
}

TEST(PictureData, DrawsTheLensAsItIs) {
  const Known known(Simulation());
  const Camera camera(known.simulated.truth.cameras[0]);
  const DistortionCurve curve = DescribeDistortion(camera, known.posterior.OfCamera(0));
  ASSERT_GT(curve.points.size(), 50u);
  for (const DistortionCurve::Point& point : curve.points) {
    const double angle = point.angle_deg * M_PI / 180;
    const auto pixel = camera.Project({std::sin(angle), 0, std::cos(angle)});
    ASSERT_TRUE(pixel);
    const std::vector<double>& p = camera.Intrinsics().parameters;
    // Focal lengths differ by a part in a thousand, and the mean of both is shown.
    EXPECT_NEAR(point.radius_px, pixel->x() - p[2], 2e-3 * point.radius_px + 1e-9);
  }
  EXPECT_EQ(curve.points[0].deviation_px, 0);
  EXPECT_GT(curve.points.back().deviation_px, 0);
}

TEST(PictureData, StraightensRowsOfCorners) {
  const Known known(Simulation());
  const UndistortionPicture picture =
      DescribeUndistortion(known.simulated.detections, 0, Camera(known.simulated.truth.cameras[0]));
  EXPECT_FALSE(picture.before.marks.empty());
  ASSERT_FALSE(picture.after.grid.empty());
  // The grid is straight after, and bent before.
  const ImageLine &first = picture.before.grid.front(), &straight = picture.after.grid.front();
  EXPECT_EQ(straight.front().x, straight[straight.size() / 2].x);
  EXPECT_GT(std::fabs(first.front().x - first[first.size() / 2].x), 5);
  EXPECT_NE(picture.note.find("px from straight lines before"), std::string::npos);
}

TEST(PictureData, ShowsTheImageWhereThereIsOne) {
  const Known known(Simulation());
  const Detections& detections = known.simulated.detections;
  const Camera camera(known.simulated.truth.cameras[0]);
  const auto view = FarthestView(detections, 0, camera);
  ASSERT_TRUE(view);
  EXPECT_FALSE(FarthestView(detections, 1, camera));
  ShownImage shown;
  shown.image.width = static_cast<std::size_t>(camera.Width());
  shown.image.height = static_cast<std::size_t>(camera.Height());
  shown.image.shades.assign(shown.image.width * shown.image.height, 90);
  shown.view = detections.views[*view].image;
  const UndistortionPicture picture = DescribeUndistortion(detections, 0, camera, shown);
  ASSERT_TRUE(picture.before.image && picture.after.image);
  EXPECT_EQ(picture.before.image->shades, shown.image.shades);
  EXPECT_EQ(picture.after.image->width, static_cast<std::size_t>(picture.after.width));
  EXPECT_TRUE(picture.before.grid.empty());
  // The rows of that view alone.
  EXPECT_FALSE(picture.before.marks.empty());
}

TEST(PictureData, FindsTheBendOfABoard) {
  CalibrationSimulation simulation = Simulation();
  simulation.warp = {0.3, 0, 0};
  const Known known(simulation, Person::kNovice);
  const auto board = DescribeBoard(known.simulated.detections, known.simulated.truth);
  ASSERT_TRUE(board);
  EXPECT_EQ(board->corners.size(), LayoutOf(AprilCalMosaic()).corners.size());
  // Heights 0.3 x^2, without their plane: as far from the ends to the middle as before.
  double low = HUGE_VAL, high = -HUGE_VAL, left = HUGE_VAL, right = -HUGE_VAL;
  for (const BoardPicture::Corner& corner : board->corners) {
    low = std::min(low, corner.dz);
    high = std::max(high, corner.dz);
    left = std::min(left, corner.x);
    right = std::max(right, corner.x);
  }
  const double half = (right - left) / 2;
  EXPECT_NEAR(high - low, 0.3 * half * half, 0.05 * 0.3 * half * half);
  EXPECT_FALSE(
      DescribeBoard(Known(Simulation()).simulated.detections, Known(Simulation()).simulated.truth));
}

TEST(PictureData, MakesQuadsOfTagsAndSquares) {
  const TargetLayout mosaic = LayoutOf(AprilCalMosaic(3, 2));
  std::vector<DetectedCorner> corners;
  for (const TargetCorner& corner : mosaic.corners)
    corners.push_back({corner.id, corner.in_target, {corner.in_target[0], corner.in_target[1]}});
  corners.pop_back();  // a corner of the last tag
  std::vector<int> names;
  EXPECT_EQ(QuadsOf(mosaic, corners, &names).size(), 5u);
  EXPECT_EQ(names, (std::vector<int>{0, 1, 2, 3, 4}));
  TargetLayout board;
  board.corners_per_tag = 1;
  corners.clear();
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) {
      board.corners.push_back({5 * y + x, {.02 * x, .02 * y, 0}});
      corners.push_back({5 * y + x, {}, {1. * x, 1. * y}});
    }
  EXPECT_EQ(QuadsOf(board, corners).size(), 6u);  // half of 4 x 3
}

TEST(PictureData, SumsUpACalibration) {
  const Known known(Simulation());
  DescribeOptions options;
  options.posterior = &known.posterior;
  options.accuracy_px = 1e-6;
  CalibrationReport report =
      DescribeCalibration(known.simulated.detections, known.selection, options);
  EXPECT_EQ(report.verdict, CalibrationVerdict::kNotMet);
  EXPECT_EQ(report.title, "Calibration of cam0");
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_NEAR(report.errors[0].rms_px, 0.2 * std::sqrt(2), 0.02);
  options.accuracy_px = 1e6;
  report = DescribeCalibration(known.simulated.detections, known.selection, options);
  EXPECT_EQ(report.verdict, CalibrationVerdict::kMet);
  EXPECT_TRUE(report.advice.empty());
  EXPECT_EQ(CalibrationReportHtml(report).find("nan"), std::string::npos);
}

TEST(Advice, NamesTheViewsThatAreMissing) {
  const CalibrationSimulation simulation = Simulation();
  const Camera camera(simulation.camera);
  const auto at = [&](double across, double down, double tilt) {
    Placement placement;
    placement.across = across;
    placement.down = down;
    placement.size = 0.3;
    placement.tilt_sideways = tilt;
    return *PlaceTarget(camera, simulation.target, placement);
  };
  const auto advise = [&](const std::vector<Se3Array>& poses) {
    const SimulatedDetections simulated = SimulateDetections(simulation, poses);
    std::string all;
    for (const std::string& line : AdviseViews(simulated.detections, simulated.truth, 0, nullptr))
      all += line + "\n";
    return all;
  };
  const std::string flat = advise({at(.5, .5, 0)});
  EXPECT_NE(flat.find("there is 1 that can be used"), std::string::npos) << flat;
  EXPECT_NE(flat.find("Tilt the target"), std::string::npos) << flat;
  EXPECT_NE(flat.find("the upper left corner"), std::string::npos) << flat;
  const std::string tilted = advise({at(.5, .5, .6), at(.2, .2, 0), at(.3, .5, 0), at(.2, .8, 0)});
  EXPECT_EQ(tilted.find("Tilt"), std::string::npos) << tilted;
  EXPECT_EQ(tilted.find("the upper left corner"), std::string::npos) << tilted;
  EXPECT_NE(tilted.find("the upper right corner"), std::string::npos) << tilted;
}

}  // namespace
}  // namespace graticule
