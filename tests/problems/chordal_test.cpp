// Chordal initialisation against the least squares problems that it claims to solve, posed again
// from the factors' own residuals and solved densely.

#include "graticule/problems/pose_graph/chordal.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <numeric>
#include <random>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/spanning_tree.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

// A ring of twelve poses with chords, badly measured, a landmark that all see, a fixed landmark,
// and a prior; informations are full matrices.
class Ring {
 public:
  static constexpr int kPoses = 12;
  Graph graph{Builtins()};

  explicit Ring(int dimension) : dimension_(dimension) {
    for (std::uint64_t i = 0; i < kPoses; ++i)
      graph.Add(Key("pose", i), dimension == 2 ? "se2/1" : "se3/1", Pose(0, 0), i == 3);
    const std::vector<double> place =
        dimension == 2 ? std::vector<double>{2, 7} : std::vector<double>{2, 7, 1};
    const char* point = dimension == 2 ? "point2/1" : "point3/1";
    graph.Add(Key("landmark:0"), point, std::vector<double>(place.size(), 0.0));
    graph.Add(Key("landmark:1"), point, place, true);
    for (std::uint64_t i = 0; i < kPoses; ++i) {
      Between(i, (i + 1) % kPoses, 0.5, 1);
      if (i % 2 == 0) Between((i + 5) % kPoses, i, 2.6, 3);
    }
    const std::size_t n = dimension == 2 ? 3 : 6;
    graph.Add(Factor{dimension == 2 ? "prior_se2/1" : "prior_se3_quaternion/1",
                     {Key("pose:7")},
                     Pose(1, 3),
                     Information(n),
                     Loss{},
                     ""});
    for (std::uint64_t i = 0; i < kPoses; ++i)
      See(dimension == 2 ? "landmark_se2/1" : "landmark_se3/1", i, i % 5 == 0 ? 1 : 0);
    if (dimension == 2) {
      graph.Add(Factor{"position_se2/1", {Key("pose:9")}, {1, 2}, Information(2), Loss{}, ""});
    } else {
      graph.Add(Factor{
          "position_se3/1", {Key("pose:9")}, {1, 2, 0, 0.5, 0, 1}, Information(3), Loss{}, ""});
      Factor offset{"landmark_offset_se3/1",
                    {Key("pose:1"), Key("landmark:0")},
                    {3, 1, 2},
                    Information(3),
                    Loss{},
                    ""};
      const std::vector<double> sensor = Pose(0.2, 1);
      offset.measurement.insert(offset.measurement.end(), sensor.begin(), sensor.end());
      graph.Add(offset);
      Factor prior{"prior_offset_se3/1", {Key("pose:10")}, Pose(1, 4), Information(6), Loss{}, ""};
      prior.measurement.insert(prior.measurement.end(), sensor.begin(), sensor.end());
      graph.Add(prior);
    }
  }

  int dimension_;

 private:
  double Normal() { return normal_(random_); }

  std::vector<double> Pose(double angle, double length) {
    if (dimension_ == 2) return {length + 0.3 * Normal(), 0.3 * Normal(), angle + 0.2 * Normal()};
    Eigen::Quaterniond q(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d axis(Normal(), Normal(), Normal());
    q = q * Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * axis.norm(), axis.normalized()));
    return {length + 0.3 * Normal(), 0.3 * Normal(), 0.3 * Normal(), q.x(), q.y(), q.z(), q.w()};
  }

  Noise Information(std::size_t n) {
    const auto size = static_cast<Eigen::Index>(n);
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return Normal(); });
    const Eigen::MatrixXd w = root.transpose() * root + Eigen::MatrixXd::Identity(size, size);
    std::vector<double> upper;
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = i; j < size; ++j) upper.push_back(w(i, j));
    return Noise::Information(upper);
  }

  void Between(std::uint64_t a, std::uint64_t b, double angle, double length) {
    // In space both readings of a rotation, side by side.
    const char* type = dimension_ == 2 ? "between_se2/1"
                       : b % 2         ? "between_se3/1"
                                       : "between_se3_quaternion/1";
    graph.Add(Factor{type,
                     {Key("pose", a), Key("pose", b)},
                     Pose(angle, length),
                     Information(dimension_ == 2 ? 3 : 6),
                     Loss{},
                     ""});
  }

  void See(const char* type, std::uint64_t pose, std::uint64_t landmark) {
    std::vector<double> seen = {2 + Normal(), Normal()};
    if (dimension_ == 3) seen.push_back(Normal());
    graph.Add(Factor{type,
                     {Key("pose", pose), Key("landmark", landmark)},
                     seen,
                     Information(seen.size()),
                     Loss{},
                     ""});
  }

  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
};

Eigen::MatrixXd RotationOf(Span<const double> pose, std::size_t from = 0) {
  if (pose.size() == 3) return Eigen::Rotation2Dd(pose[2]).toRotationMatrix();
  return Eigen::Quaterniond(pose[from + 6], pose[from + 3], pose[from + 4], pose[from + 5])
      .normalized()
      .toRotationMatrix();
}

double KappaOf(const FactorView& factor, int d) {
  const int turn = d == 2 ? 1 : 3, n = d + turn;
  Eigen::MatrixXd w(n, n);
  std::size_t next = 0;
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j) w(i, j) = w(j, i) = factor.noise.values[next++];
  const double kappa = turn / w.bottomRightCorner(turn, turn).inverse().trace();
  return factor.type->name.find("quaternion") == std::string::npos ? kappa : kappa / 4;
}

class ChordalRing : public testing::TestWithParam<int> {};

TEST_P(ChordalRing, HasTheRotationsOfADenseSolve) {
  const int d = GetParam();
  Ring ring(d);
  // The unknowns: rows of R, side by side, of every pose.
  const int unknowns = Ring::kPoses * d * d;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> right;
  const auto state = [&](int b, const Eigen::MatrixXd* a_from_b, int a, const Eigen::MatrixXd& is,
                         double weight) {
    for (int i = 0; i < d; ++i)
      for (int j = 0; j < d; ++j) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns);
        row[b * d * d + i * d + j] = weight;
        if (a_from_b)
          for (int k = 0; k < d; ++k) row[a * d * d + i * d + k] -= weight * (*a_from_b)(k, j);
        rows.push_back(row);
        right.push_back(a_from_b ? 0 : weight * is(i, j));
      }
  };
  for (FactorId id = 0; id < ring.graph.FactorCount(); ++id) {
    const FactorView factor = ring.graph.FactorAt(id);
    const std::string& type = factor.type->name;
    if (type.rfind("between", 0) != 0 && type.rfind("prior", 0) != 0) continue;
    Eigen::MatrixXd measured = RotationOf(factor.measurement);
    if (type.rfind("prior_offset", 0) == 0)
      measured = measured * RotationOf(factor.measurement, 7).transpose();
    const double weight = std::sqrt(KappaOf(factor, d));
    const int first = static_cast<int>(factor.variables[0]);
    if (type.rfind("between", 0) == 0)
      state(static_cast<int>(factor.variables[1]), &measured, first, measured, weight);
    else
      state(first, nullptr, 0, measured, weight);
  }
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), unknowns);
  for (std::size_t i = 0; i < rows.size(); ++i)
    matrix.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  Eigen::VectorXd known =
      Eigen::Map<const Eigen::VectorXd>(right.data(), static_cast<Eigen::Index>(right.size()));
  // Pose 3 is fixed: its columns are known, and the least norm leaves them alone.
  const Eigen::MatrixXd fixed = RotationOf(ring.graph.ValueOf(3));
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < d; ++j) {
      auto column = matrix.col(3 * d * d + i * d + j);
      known -= column * fixed(i, j);
      column.setZero();
    }
  const Eigen::VectorXd x = matrix.completeOrthogonalDecomposition().solve(known);

  const InitialiseReport report = Initialise(&ring.graph, InitialGuess::kChordal, false);
  EXPECT_EQ(report.used, InitialGuess::kChordal);
  EXPECT_EQ(report.kept_pieces, 0u);
  for (int pose = 0; pose < Ring::kPoses; ++pose) {
    if (pose == 3) continue;
    Eigen::MatrixXd relaxed(d, d);
    for (int i = 0; i < d; ++i) relaxed.row(i) = x.segment(pose * d * d + i * d, d).transpose();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(relaxed, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::MatrixXd nearest = svd.matrixU() * svd.matrixV().transpose();
    ASSERT_GT(nearest.determinant(), 0);
    const Eigen::MatrixXd found = RotationOf(ring.graph.ValueOf(static_cast<VariableId>(pose)));
    EXPECT_LT((found - nearest).norm(), 1e-12) << "pose " << pose;
  }
}

TEST_P(ChordalRing, HasTranslationsThatNoOtherPlaceImproves) {
  Ring ring(GetParam());
  Initialise(&ring.graph, InitialGuess::kChordal, false);
  const auto cost = [&](const Values& values) {
    const std::vector<double> chi2 = FactorChi2(ring.graph, values);
    return 0.5 * std::accumulate(chi2.begin(), chi2.end(), 0.0);
  };
  Values values = ring.graph.InitialValues();
  const double before = cost(values);
  for (VariableId id = 0; id < ring.graph.VariableCount(); ++id) {
    if (ring.graph.IsFixed(id)) continue;
    for (int i = 0; i < GetParam(); ++i) {
      // Quadratic in the place: a central difference is the derivative but for rounding.
      const double place = values[id][static_cast<std::size_t>(i)];
      values.Mutable(id)[i] = place + 0.5;
      const double above = cost(values);
      values.Mutable(id)[i] = place - 0.5;
      const double below = cost(values);
      values.Mutable(id)[i] = place;
      EXPECT_NEAR(above - below, 0, 1e-11 * before)
          << ring.graph.KeyOf(id).ToString() << "[" << i << "]";
      EXPECT_GT(above, before);
    }
  }
}

TEST_P(ChordalRing, HasTheSameDigitsAgain) {
  Ring a(GetParam()), b(GetParam());
  const std::string summary = Initialise(&a.graph, InitialGuess::kChordal, false).summary;
  EXPECT_EQ(Initialise(&b.graph, InitialGuess::kChordal, false).summary, summary);
  EXPECT_EQ(a.graph.InitialValues().Data(), b.graph.InitialValues().Data());
}

INSTANTIATE_TEST_SUITE_P(Dimension, ChordalRing, testing::Values(2, 3));

const Noise kNoise = Noise::Sigma(0.1);

// A square, each side 2 m and a quarter turn to the left, its first pose at `first`.
void AddSquare(Graph* graph, const char* family, const std::vector<double>& first,
               double side = 2) {
  for (std::uint64_t i = 0; i < 4; ++i)
    graph->Add(Key(family, i), "se2/1", i == 0 ? first : std::vector<double>{0, 0, 0});
  for (std::uint64_t i = 0; i < 4; ++i)
    graph->Add(
        BetweenSe2Factor(Key(family, i), Key(family, (i + 1) % 4), {side, 0, M_PI / 2}, kNoise));
}

void ExpectPose(const Graph& graph, const char* key, double x, double y, double yaw) {
  const auto pose = graph.ValueOf(graph.IdOf(Key(key)));
  EXPECT_NEAR(pose[0], x, 1e-12) << key;
  EXPECT_NEAR(pose[1], y, 1e-12) << key;
  EXPECT_NEAR(std::remainder(pose[2] - yaw, 2 * M_PI), 0, 1e-12) << key;
}

TEST(Chordal, SolvesEveryPieceFromItsOwnGauge) {
  Graph graph(Builtins());
  AddSquare(&graph, "a", {100, 0, 0});
  AddSquare(&graph, "b", {0, -50, M_PI});
  // Seen from both pieces, which do not agree on a frame: the first to see it has it.
  graph.Add(Key("landmark:0"), "point2/1", {0, 0});
  graph.Add(LandmarkSe2Factor(Key("a:0"), Key("landmark:0"), {1, 1}, kNoise));
  graph.Add(LandmarkSe2Factor(Key("b:0"), Key("landmark:0"), {1, 1}, kNoise));
  const InitialiseReport report = Initialise(&graph, InitialGuess::kChordal, false);
  EXPECT_EQ(report.free_roots, 2u);
  EXPECT_EQ(report.kept_pieces, 0u);
  ExpectPose(graph, "a:2", 102, 2, M_PI);
  ExpectPose(graph, "b:2", -2, -52, 0);
  const auto landmark = graph.ValueOf(graph.IdOf(Key("landmark:0")));
  EXPECT_NEAR(landmark[0], 101, 1e-12);
  EXPECT_NEAR(landmark[1], 1, 1e-12);
}

TEST(Chordal, LeavesAPieceToTheTreeWhereItsSystemIsSingularAndSaysSo) {
  Graph graph(Builtins());
  AddSquare(&graph, "a", {0, 0, 0});
  AddSquare(&graph, "b", {9, 9, 0}, 2.5);
  // Where b:4 looks was never measured.
  graph.Add(Key("b:4"), "se2/1", {0, 0, 0});
  graph.Add(
      BetweenSe2Factor(Key("b:0"), Key("b:4"), {1, 2, 0}, Noise::Information({1, 0, 0, 1, 0, 0})));
  Values tree = graph.InitialValues();
  PlaceBySpanningTree(graph, Growth::kBreadthFirst, &tree);
  const InitialiseReport report = Initialise(&graph, InitialGuess::kChordal, false);
  EXPECT_EQ(report.kept_pieces, 1u);
  EXPECT_NE(report.summary.find("1 piece by the spanning tree"), std::string::npos)
      << report.summary;
  ExpectPose(graph, "a:2", 2, 2, M_PI);
  for (const char* key : {"b:0", "b:1", "b:2", "b:3", "b:4"}) {
    const auto pose = tree.At(Key(key));
    ExpectPose(graph, key, pose[0], pose[1], pose[2]);
  }
}

}  // namespace
}  // namespace graticule
