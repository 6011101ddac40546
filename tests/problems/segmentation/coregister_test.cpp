#include "graticule/problems/segmentation/coregister.hpp"

#include <algorithm>

#include "correspondences.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/target_pose.hpp"
#include "graticule/problems/f_quantile.hpp"
#include "graticule/problems/segmentation/coregister_error.hpp"
#include "graticule/problems/segmentation/coregister_evaluate.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::test {
namespace {

// A camera that looks along the LIDAR's x, and points in front of it.
KittiFrame Scene(const std::string& model = "brown5") {
  KittiFrame frame;
  frame.camera = {"cam", model, 964, 724, {484, 485, 457, 365, -0.2, 0.07, 0.003, 0.0003, 0}};
  if (model == "angular4") frame.camera.parameters = {300, 300, 480, 360, 0.01, -0.002, 0.001, 0};
  Eigen::Matrix3d turn;
  turn << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  frame.camera_from_lidar = Eigen::Isometry3d::Identity();
  frame.camera_from_lidar.linear() =
      turn * Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized());
  frame.camera_from_lidar.translation() = Eigen::Vector3d(-0.15, -0.5, -0.28);
  const Camera camera(frame.camera);
  RandomNumbers random(3);
  while (frame.visible.size() < 500) {
    const Eigen::Vector3d point(random.Uniform(2, 12), random.Uniform(-8, 8),
                                random.Uniform(-4, 4));
    const auto pixel = camera.Project(frame.camera_from_lidar * point);
    if (pixel && pixel->x() > 0 && pixel->y() > 0 && pixel->x() < 963 && pixel->y() < 723)
      frame.visible.push_back(point);
  }
  return frame;
}

std::string RefusalOf(const CoregisterData& data, const CameraIntrinsics& camera) {
  try {
    Coregister(Builtins(), data, camera);
  } catch (const Error& error) {
    EXPECT_EQ(error.Kind(), ErrorKind::kIllPosed);
    return error.what();
  }
  return "";
}

TEST(FQuantile, IsThatOfTables) {
  EXPECT_NEAR(FQuantile(0.95, 6, 10), 3.2172, 1e-4);
  EXPECT_NEAR(FQuantile(0.95, 1, 1), 161.4476, 1e-3);
  EXPECT_NEAR(FQuantile(0.95, 6, 1e7), 2.0986, 1e-4);  // chi-square's 12.5916 / 6
  for (const double share : {0.1, 0.9, 0.999})
    EXPECT_NEAR(FExceeded(FQuantile(share, 2, 24), 2, 24), 1 - share, 1e-12);
  EXPECT_NEAR(FExceeded(300, 2, 24) / std::pow(1 + 300 / 12., -12), 1, 1e-12);  // in closed form
}

TEST(Coregister, FindsTheCameraWithoutAStart) {
  for (const char* model : {"brown5", "angular4"}) {
    const KittiFrame frame = Scene(model);
    const Simulated exact = Simulate(frame, 12, {0}, 5, 1e-9, 1e-12);
    const Coregistration solved = Coregister(Builtins(), {exact.points, {}}, frame.camera);
    EXPECT_LT(ErrorOf(solved.state.camera_from_lidar, frame.camera_from_lidar).norm(), 1e-9);
    EXPECT_TRUE(solved.outliers.empty());
  }
}

TEST(Coregister, NamesWrongCorrespondences) {
  const KittiFrame frame = Scene();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Simulated simulated = Simulate(frame, 24, {0.25}, seed);
    const Coregistration solved = Coregister(Builtins(), {simulated.points, {}}, frame.camera);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(solved.use[i], 0) << seed << " " << i;
    EXPECT_LE(solved.outliers.size(), 8u) << seed;
    EXPECT_LT(ErrorOf(solved.state.camera_from_lidar, frame.camera_from_lidar).tail<3>().norm(),
              0.02);
  }
}

TEST(Coregister, GivesTheSameDigitsTwice) {
  const KittiFrame frame = Scene();
  const Simulated simulated = Simulate(frame, 40, {0.15}, 2);
  const Coregistration a = Coregister(Builtins(), {simulated.points, {}}, frame.camera);
  const Coregistration b = Coregister(Builtins(), {simulated.points, {}}, frame.camera);
  EXPECT_EQ(a.state.camera_from_lidar, b.state.camera_from_lidar);
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(Coregister, RefusesWhatHasNoSingleAnswer) {
  const KittiFrame frame = Scene();
  const Simulated good = Simulate(frame, 12, {0}, 1);
  CoregisterData data{{good.points.begin(), good.points.begin() + 3}, {}};
  EXPECT_EQ(RefusalOf(data, frame.camera),
            "expected at least 4 correspondences (6 to see which is wrong) or 3 boards, found 3 "
            "and 0");

  const Camera camera(frame.camera);
  data.points.clear();
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d point(4 + 0.3 * i, -1 + 0.2 * i, 0.1 * i);
    const Eigen::Vector2d pixel = *camera.Project(frame.camera_from_lidar * point);
    data.points.push_back(
        {{point.x(), point.y(), point.z()}, {pixel.x(), pixel.y()}, std::to_string(i)});
  }
  EXPECT_NE(RefusalOf(data, frame.camera).find("lie on a line"), std::string::npos);

  data.points = good.points;
  for (Correspondence& point : data.points) point.in_lidar[1] *= -1;
  EXPECT_NE(RefusalOf(data, frame.camera).find("mirror image only"), std::string::npos);

  data.points = good.points;
  for (std::size_t i = 0; i < data.points.size(); ++i)
    data.points[i].pixel = good.points[(i * 5 + 3) % good.points.size()].pixel;
  EXPECT_NE(RefusalOf(data, frame.camera).find("no pose of the camera explains half"),
            std::string::npos);

  // Four corners of a small board that faces the camera from afar: its tilt may be either.
  data.points.clear();
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
  camera_from_board.linear() =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 0.5, 0).normalized()).toRotationMatrix();
  camera_from_board.translation() = Eigen::Vector3d(0.2, 0.1, 9);
  RandomNumbers random(1);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d in_board(i % 2 ? 0.3 : -0.3, i / 2 ? 0.3 : -0.3, 0);
    const Eigen::Vector3d in_camera = camera_from_board * in_board;
    const Eigen::Vector3d point = frame.camera_from_lidar.inverse() * in_camera;
    const Eigen::Vector2d pixel = *camera.Project(in_camera);
    data.points.push_back({{point.x(), point.y(), point.z()},
                           {pixel.x() + 0.5 * random.Normal(), pixel.y() + 0.5 * random.Normal()},
                           std::to_string(i)});
  }
  EXPECT_NE(RefusalOf(data, frame.camera).find("two poses of the camera"), std::string::npos);
}

TEST(Coregister, AlsoFromThePlanesOfBoards) {
  const KittiFrame frame = Scene();
  CoregisterData data;
  RandomNumbers random(7);
  for (int i = 0; i < 8; ++i) {
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d axis(random.Normal(), random.Normal(), random.Normal());
    camera_from_board.linear() = Eigen::AngleAxisd(0.6, axis.normalized()).toRotationMatrix();
    camera_from_board.translation() =
        Eigen::Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(2, 5));
    const Eigen::Isometry3d lidar_from_board =
        frame.camera_from_lidar.inverse() * camera_from_board;
    const Eigen::Vector3d normal = (i % 2 ? 1 : -1) * lidar_from_board.linear().col(2);
    data.boards.push_back({std::to_string(i), PoseOf(camera_from_board), normal,
                           normal.dot(lidar_from_board.translation())});
  }
  const Coregistration solved = Coregister(Builtins(), data, frame.camera);
  EXPECT_LT(ErrorOf(solved.state.camera_from_lidar, frame.camera_from_lidar).norm(), 1e-8);
  // Together with points, and with one board moved.
  data.points = Simulate(frame, 10, {0}, 4).points;
  data.boards[2].offset_m += 0.5;
  CoregisterOptions options;
  options.sigmas_are_known = true;
  const Coregistration both = Coregister(Builtins(), data, frame.camera, options);
  EXPECT_EQ(both.outliers, (std::vector<std::size_t>{12}));
  EXPECT_LT(ErrorOf(both.state.camera_from_lidar, frame.camera_from_lidar).norm(), 0.05);
  data.boards.resize(2);
  data.points.clear();
  EXPECT_NE(RefusalOf(data, frame.camera).find("found 0 and 2"), std::string::npos);
}

TEST(ExpectedErrors, ShrinkMostWhereTheyAreSaidTo) {
  const KittiFrame frame = Scene();
  const Simulated simulated = Simulate(frame, 8, {0}, 11);
  CoregisterOptions options;
  options.sigma_px = 1.5;
  options.sigmas_are_known = true;
  const Coregistration solved =
      Coregister(Builtins(), {simulated.points, {}}, frame.camera, options);
  const Camera camera(frame.camera);
  const std::vector<double> ranges = {2, 10};
  const NextCorrespondence next = SuggestCorrespondence(camera, solved, options, ranges);
  EXPECT_LT(next.max_px, next.max_px_before);
  // With that correspondence added to the data, the error is what was said.
  CoregisterData more{simulated.points, {}};
  const Eigen::Vector3d in_camera = next.range_m * *camera.Unproject({next.pixel.x, next.pixel.y});
  const Eigen::Vector3d point = IsometryOf(solved.state.camera_from_lidar).inverse() * in_camera;
  more.points.push_back({{point.x(), point.y(), point.z()}, {next.pixel.x, next.pixel.y}, "new"});
  const Coregistration after = RefineCoregistration(Builtins(), more, solved.state, options);
  double largest = 0;
  for (const ExtrinsicError& error :
       ExpectedErrors(camera, after.state.camera_from_lidar, after.covariance, ranges, 11))
    largest = std::max(largest, error.max_px);
  EXPECT_NEAR(largest, next.max_px, 1e-3 * next.max_px);
}

// Monte Carlo: the expected error is the mean error.
TEST(ExpectedErrors, AreTheMeanOfErrors) {
  const KittiFrame frame = Scene();
  const Camera camera(frame.camera);
  CoregisterOptions options;
  options.sigma_px = 1.5;
  options.sigmas_are_known = true;
  const Eigen::Vector3d ray = *camera.Unproject({0, 0});
  const Eigen::Vector3d in_lidar = frame.camera_from_lidar.inverse() * (5 * ray);
  const Simulated places = Simulate(frame, 20, {0}, 1, 1e-9, 1e-12);
  double mean = 0, expected = 0;
  const int trials = 300;
  RandomNumbers random(2);
  for (int trial = 0; trial < trials; ++trial) {
    CoregisterData data{places.points, {}};
    for (Correspondence& point : data.points) {
      for (double& value : point.in_lidar) value += 0.02 * random.Normal();
      for (double& value : point.pixel) value += 1.5 * random.Normal();
    }
    const Coregistration solved = RefineCoregistration(
        Builtins(), data, {frame.camera, PoseOf(frame.camera_from_lidar)}, options);
    const Eigen::Vector2d pixel =
        *camera.Project(IsometryOf(solved.state.camera_from_lidar) * in_lidar);
    mean += pixel.norm() / trials;
    if (trial == 0)
      expected = ExpectedErrors(camera, solved.state.camera_from_lidar, solved.covariance, {5})[0]
                     .field.values[0];
  }
  EXPECT_NEAR(mean / expected, 1, 0.15);  // 300 lengths: 3 %; one trial's noise model: some more
}

// The thesis' way (Eq. 4.2): steps along each parameter, halved where none helps.
struct CompassSearch {
  const CoregisterData& data;
  CoregisterState state;
  int evaluations = 0;

  double Cost(const CoregisterState& at) {
    ++evaluations;
    double cost = 0;
    for (const Eigen::Vector2d& r : PointResiduals(at, data.points))
      cost += std::isfinite(r.norm()) ? r.squaredNorm() : 1e8;
    return cost;
  }

  static CoregisterState Moved(const CoregisterState& from, int i, double step) {
    CoregisterState to = from;
    Eigen::Isometry3d pose = IsometryOf(from.camera_from_lidar);
    if (i < 3)
      pose.translation()[i] += step;
    else
      pose.linear() = pose.linear() * Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(i - 3));
    to.camera_from_lidar = PoseOf(pose);
    return to;
  }

  double Run(int most) {
    double step[6] = {0.1, 0.1, 0.1, 0.05, 0.05, 0.05};
    double cost = Cost(state);
    while (evaluations<most&& * std::max_element(step, step + 6)> 1e-9)
      for (int i = 0; i < 6; ++i) {
        bool is_better = false;
        for (const double sign : {1.0, -1.0}) {
          const CoregisterState moved = Moved(state, i, sign * step[i]);
          const double there = Cost(moved);
          if (there >= cost) continue;
          state = moved;
          cost = there;
          is_better = true;
          break;
        }
        if (!is_better) step[i] /= 2;
      }
    return cost;
  }
};

TEST(Coregister, CompassSearchFindsNoLowerCostInManyMoreEvaluations) {
  const KittiFrame frame = Scene();
  CoregisterData data{Simulate(frame, 16, {0}, 9).points, {}};
  CoregisterOptions plain;  // the thesis' cost: pixels, all alike, all points
  plain.sigma_m = 0;
  plain.outlier_share = 1e-300;
  Eigen::Isometry3d off = frame.camera_from_lidar;
  off.linear() = off.linear() * Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY());
  off.translation() += Eigen::Vector3d(0.1, -0.1, 0.1);
  const CoregisterState start{frame.camera, PoseOf(off)};
  const Coregistration solved = RefineCoregistration(Builtins(), data, start, plain);
  CompassSearch compass{data, start};
  const double found = compass.Run(200000);
  double least = 0;
  for (const Eigen::Vector2d& r : PointResiduals(solved.state, data.points))
    least += r.squaredNorm();
  std::printf("compass %d evaluations, cost %.9g; least squares %.9g, %d steps in the last solve\n",
              compass.evaluations, found, least, static_cast<int>(solved.report.iterations.size()));
  EXPECT_GE(found, least * (1 - 1e-9));
  EXPECT_GT(compass.evaluations, 1000);
}

}  // namespace
}  // namespace graticule::test
