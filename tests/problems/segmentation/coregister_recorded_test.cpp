// Co-registration of recorded sensors, against the numbers of shared/design/SEGMENTATION.md.

#include <algorithm>

#include "correspondences.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/problems/segmentation/coregister_evaluate.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::test {
namespace {

class Heethesh : public ::testing::Test {
 protected:
  void SetUp() override {
    GRATICULE_NEEDS_SEGMENT_DATA();
    data_.points = HeetheshPoints();
    camera_ = ReadCamera(SegmentData("heethesh_corr/ost.yaml"));
    options_.sigma_m = 0;  // pixels, all alike: the thesis' cost (Eq. 4.2)
  }

  // Least squares over all points.
  CoregisterOptions Plain() const {
    CoregisterOptions plain = options_;
    plain.outlier_share = 1e-300;
    return plain;
  }

  const Registry types_ = Builtins();
  CoregisterData data_;
  CameraIntrinsics camera_;
  CoregisterOptions options_;
};

// Two points are as far off as 0.2 and 0.7 % of right ones: not enough for the default share, which
// the simulations below ask for (docs/coregistration.md).
TEST_F(Heethesh, AtAShareOfATenthOutliersAreNamedAndTheRestIsPredictedBetter) {
  EXPECT_TRUE(Coregister(types_, data_, camera_, options_).outliers.empty());
  options_.outlier_share = 0.1;
  const Coregistration solved = Coregister(types_, data_, camera_, options_);
  const HeldOut held_out = LeaveOneOut(types_, data_, solved, options_);
  std::printf("rms %.2f px, held out %.2f px (all %.2f, median %.2f), outliers:", solved.rms_px,
              held_out.rms_counted_px, held_out.rms_px, held_out.median_px);
  for (const std::size_t i : solved.outliers) std::printf(" %s", data_.points[i].name.c_str());
  std::printf("\n");
  EXPECT_GE(solved.outliers.size(), 2u);
  EXPECT_LE(solved.outliers.size(), 5u);
  EXPECT_LT(held_out.rms_counted_px, 12.9);
}

TEST_F(Heethesh, LeastSquaresIsThePublishedOne) {
  const CoregisterState start = Coregister(types_, data_, camera_, options_).state;
  const Coregistration least = RefineCoregistration(types_, data_, start, Plain());
  EXPECT_NEAR(least.rms_px, 10.7, 0.05);
  EXPECT_NEAR(LeaveOneOut(types_, data_, least, Plain()).rms_px, 12.9, 0.05);
}

// All of K and the distortion at once, as the thesis does (skew, which no model of ours has, is
// missing): 16 points fit better, and predict nothing.
TEST_F(Heethesh, AllParametersOverfit) {
  const CoregisterState start = Coregister(types_, data_, camera_, options_).state;
  CoregisterOptions all = Plain();
  all.free_parameters.assign(camera_.parameters.size(), 1);
  const Coregistration fitted = RefineCoregistration(types_, data_, start, all);
  const HeldOut held_out = LeaveOneOut(types_, data_, fitted, all);
  std::printf("all free: rms %.2f px, held out %.0f px\n", fitted.rms_px, held_out.rms_px);
  EXPECT_LT(fitted.rms_px, 8.9);
  EXPECT_GT(held_out.rms_px, 500);
}

TEST_F(Heethesh, ParametersAreFreedOnlyWhereTheHeldOutErrorFalls) {
  const Coregistration solved = Coregister(types_, data_, camera_, options_);
  const double before = LeaveOneOut(types_, data_, solved, options_).rms_counted_px;
  const FreedCoregistration freed = FreeParameters(types_, data_, solved, options_);
  double least = before;
  for (const FreedParameter& tried : freed.tried) {
    std::printf("%s: %.2f px, %s\n", tried.name.c_str(), tried.held_out_px,
                tried.is_kept ? "kept" : "not kept");
    EXPECT_EQ(tried.is_kept, tried.held_out_px < 0.98 * least);
    if (tried.is_kept) least = tried.held_out_px;
  }
}

class Kitti : public ::testing::Test {
 protected:
  void SetUp() override {
    GRATICULE_NEEDS_SEGMENT_DATA();
    frame_ = ReadKitti("000001");
    options_.sigma_px = 1.5;
  }

  const Registry types_ = Builtins();
  KittiFrame frame_;
  CoregisterOptions options_;
};

/// Medians of the errors of many trials, and how often the truth is inside the 95 % region.
struct Trials {
  double degrees = 0, centimetres = 0;
  double inside = 0;         ///< share
  double wrong_counted = 0;  ///< share of wrong correspondences that are not named
  double right_named = 0;    ///< share of right ones that are
};

Trials RunTrials(const KittiFrame& frame, const CoregisterOptions& options, std::size_t count,
                 const Wrong& wrong, int trials, std::uint64_t seed) {
  const Registry types = Builtins();
  std::vector<double> degrees, centimetres;
  double inside = 0, wrongs = 0, wrong_counted = 0, rights = 0, right_named = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Simulated simulated =
        Simulate(frame, count, wrong, seed + static_cast<std::uint64_t>(trial));
    const Coregistration solved = Coregister(types, {simulated.points, {}}, frame.camera, options);
    const auto error = ErrorOf(solved.state.camera_from_lidar, frame.camera_from_lidar);
    inside += error.dot(solved.covariance.inverse() * error) <= solved.region_95;
    degrees.push_back(error.tail<3>().norm() * 180 / M_PI);
    centimetres.push_back(100 * error.head<3>().norm());
    for (std::size_t i = 0; i < count; ++i) {
      (simulated.is_wrong[i] ? wrongs : rights) += 1;
      if (simulated.is_wrong[i] && solved.use[i]) ++wrong_counted;
      if (!simulated.is_wrong[i] && !solved.use[i]) ++right_named;
    }
  }
  std::sort(degrees.begin(), degrees.end());
  std::sort(centimetres.begin(), centimetres.end());
  const std::size_t middle = degrees.size() / 2;
  return {degrees[middle], centimetres[middle], inside / trials,
          wrongs > 0 ? wrong_counted / wrongs : 0, right_named / rights};
}

void ExpectWithinTheCauchyColumn(const KittiFrame& frame, const CoregisterOptions& options,
                                 int trials) {
  const struct {
    std::size_t count;
    double degrees, centimetres;
  } cases[] = {{8, .40, 6.8}, {16, .20, 3.5}, {32, .20, 3.0}, {64, .12, 2.1}};
  for (const auto& known : cases) {
    const Trials found = RunTrials(frame, options, known.count, {0.15}, trials, 1000);
    std::printf("n %zu: %.3f degrees, %.2f cm\n", known.count, found.degrees, found.centimetres);
    EXPECT_LE(found.degrees, known.degrees) << known.count;
    EXPECT_LE(found.centimetres, known.centimetres) << known.count;
  }
}

// Of 500 trials, 95 % have a standard deviation of 1 %.
void ExpectTheTruthInside(const KittiFrame& frame, CoregisterOptions options, int trials,
                          double least, double most) {
  for (const bool is_known : {false, true})
    for (const double wrong : {0.0, 0.15}) {
      options.sigmas_are_known = is_known;
      const Trials found = RunTrials(frame, options, 32, {wrong}, trials, 5000);
      std::printf("noise %s, %.0f %% wrong: %.1f %% inside\n", is_known ? "given" : "estimated",
                  100 * wrong, 100 * found.inside);
      EXPECT_GE(found.inside, least);
      EXPECT_LE(found.inside, most);
    }
}

TEST_F(Kitti, WithWrongCorrespondencesIsWithinTheCauchyColumn) {
  ExpectWithinTheCauchyColumn(frame_, options_, 41);
}

// Three standard deviations of 100 trials; DISABLED_MeasuredIn500Trials has the claim.
TEST_F(Kitti, TheTruthIsInsideThe95PercentRegion) {
  ExpectTheTruthInside(frame_, options_, 100, 0.885, 1);
}

// Minutes: run with --gtest_also_run_disabled_tests.
TEST_F(Kitti, DISABLED_MeasuredIn500Trials) {
  ExpectWithinTheCauchyColumn(frame_, options_, 500);
  ExpectTheTruthInside(frame_, options_, 500, 0.93, 0.97);
}

// What outlier_share was chosen by: correspondences that are anywhere, and beside the right place.
TEST_F(Kitti, DISABLED_ShareOfRightOnesThatMayBeNamed) {
  for (const Wrong& wrong : {Wrong{0.15, 3, 30}, Wrong{0.15}, Wrong{0}})
    for (const std::size_t count : {16, 32})
      for (const double share : {0.01, 0.05, 0.1}) {
        options_.outlier_share = share;
        const Trials found = RunTrials(frame_, options_, count, wrong, 100, 9000);
        std::printf(
            "%2.0f %% wrong %s, n %zu, share %.3f: %.3f degrees, %.2f cm, %.1f %% inside, %.1f %% "
            "of wrong ones counted, %.1f %% of right ones named\n",
            100 * wrong.share, wrong.most_px > 0 ? "beside" : "anywhere", count, share,
            found.degrees, found.centimetres, 100 * found.inside, 100 * found.wrong_counted,
            100 * found.right_named);
      }
}

}  // namespace
}  // namespace graticule::test
