// LAGO against the two least squares problems that it claims to solve, with the whole turns counted
// along the chain of poses, and solved densely.

#include "graticule/problems/pose_graph/lago.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <random>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/spanning_tree.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Three rounds on a circle, ten poses each, with closures from round to round and a prior;
// informations are full matrices.  Pose 3 is fixed.
class Rounds {
 public:
  static constexpr int kPoses = 30;
  Graph graph{Builtins()};

  Rounds() {
    for (std::uint64_t i = 0; i < kPoses; ++i)
      graph.Add(Key("pose", i), "se2/1",
                i == 3 ? std::vector<double>{1, 2, 0.3} : std::vector<double>{0, 0, 0}, i == 3);
    for (std::uint64_t i = 0; i + 1 < kPoses; ++i) Between(i, i + 1);
    for (std::uint64_t i = 0; i + 10 < kPoses; i += 3) Between(i + 10, i);
    for (std::uint64_t i = 0; i + 14 < kPoses; i += 4) Between(i, i + 14);
    graph.Add(Factor{"prior_se2/1",
                     {Key("pose:20")},
                     Noisy(2, 3, 2 * M_PI / 10 * 20),
                     Information(),
                     Loss{},
                     ""});
  }

 private:
  double Normal() { return normal_(random_); }
  std::vector<double> Noisy(double x, double y, double yaw) {
    return {x + 0.1 * Normal(), y + 0.1 * Normal(), std::remainder(yaw + 0.1 * Normal(), 2 * M_PI)};
  }
  void Between(std::uint64_t a, std::uint64_t b) {
    const double step = 2 * M_PI / 10;
    const auto at = [&](std::uint64_t i) {
      const double angle = step * static_cast<double>(i);
      return Eigen::Vector2d(std::sin(angle), 1 - std::cos(angle));
    };
    const Eigen::Vector2d in_a =
        Eigen::Rotation2Dd(-step * static_cast<double>(a)) * Eigen::Vector2d(at(b) - at(a));
    graph.Add(
        Factor{"between_se2/1",
               {Key("pose", a), Key("pose", b)},
               Noisy(in_a[0], in_a[1], step * (static_cast<double>(b) - static_cast<double>(a))),
               Information(),
               Loss{},
               ""});
  }
  Noise Information() {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return Normal(); });
    const Eigen::Matrix3d w = root.transpose() * root + Eigen::Matrix3d::Identity();
    return Noise::Information({w(0, 0), w(0, 1), w(0, 2), w(1, 1), w(1, 2), w(2, 2)});
  }

  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

Eigen::Matrix3d Whole(const FactorView& factor) {
  const auto v = factor.noise.values;
  Eigen::Matrix3d w;
  w << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
  return w;
}

// Rows of a least squares problem; columns of what is known move to the right.
struct Rows {
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<double> right;

  Eigen::VectorXd Solve(const std::vector<std::pair<int, double>>& known) const {
    Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()), rows[0].size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      matrix.row(static_cast<Eigen::Index>(i)) = rows[i];
    Eigen::VectorXd b =
        Eigen::Map<const Eigen::VectorXd>(right.data(), static_cast<Eigen::Index>(right.size()));
    for (const auto& [column, value] : known) {
      b -= matrix.col(column) * value;
      matrix.col(column).setZero();
    }
    Eigen::VectorXd x = matrix.completeOrthogonalDecomposition().solve(b);
    for (const auto& [column, value] : known) x[column] = value;
    return x;
  }
};

TEST(Lago, HasThePosesOfTwoDenseSolves) {
  Rounds rounds;
  const Graph& graph = rounds.graph;
  const int n = Rounds::kPoses;

  // Angles along the chain from the fixed pose 3, past whole turns.
  Eigen::VectorXd chain = Eigen::VectorXd::Zero(n);
  chain[3] = 0.3;
  for (int i = 3; i + 1 < n; ++i)
    chain[i + 1] = chain[i] + graph.FactorAt(static_cast<FactorId>(i)).measurement[2];
  for (int i = 3; i > 0; --i)
    chain[i - 1] = chain[i] - graph.FactorAt(static_cast<FactorId>(i - 1)).measurement[2];
  EXPECT_GT(chain[n - 1], 4 * M_PI) << "else the turns are not put to the test";

  const auto turned = [&](const FactorView& factor) {  // the measured angle with its whole turns
    const bool prior = factor.variables.size() == 1;
    const double a = prior ? 0 : chain[static_cast<int>(factor.variables[0])];
    const double b = chain[static_cast<int>(factor.variables[prior ? 0 : 1])];
    const double measured = factor.measurement[2];
    return measured + 2 * M_PI * std::round((b - a - measured) / (2 * M_PI));
  };
  Rows angles;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const bool prior = factor.variables.size() == 1;
    const double weight = 1 / std::sqrt(Whole(factor).inverse()(2, 2));
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(n);
    row[static_cast<int>(factor.variables[prior ? 0 : 1])] = weight;
    if (!prior) row[static_cast<int>(factor.variables[0])] = -weight;
    angles.rows.push_back(row);
    angles.right.push_back(weight * turned(factor));
  }
  const Eigen::VectorXd yaw = angles.Solve({{3, 0.3}});

  Rows poses;  // x, y, yaw of each
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const bool prior = factor.variables.size() == 1;
    const int b = static_cast<int>(factor.variables[prior ? 0 : 1]);
    const int a = prior ? -1 : static_cast<int>(factor.variables[0]);
    const double yaw_a = prior ? 0 : yaw[a];
    const Eigen::Vector2d t(factor.measurement[0], factor.measurement[1]);
    const Eigen::Matrix2d to_b =
        Eigen::Rotation2Dd(-yaw_a - factor.measurement[2]).toRotationMatrix();
    const Eigen::Vector2d ahead = Eigen::Rotation2Dd(yaw_a) * t;
    const Eigen::Vector2d sideways = Eigen::Rotation2Dd(yaw_a + M_PI / 2) * t;
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(3, 3 * n);
    Eigen::Vector3d right;
    right << to_b * ahead, turned(factor);
    row.block<2, 2>(0, 3 * b) = to_b;
    row(2, 3 * b + 2) = 1;
    if (!prior) {
      // ahead(yaw) = ahead(yaw_a) + (yaw - yaw_a) sideways
      row.block<2, 2>(0, 3 * a) = -to_b;
      row.block<2, 1>(0, 3 * a + 2) = -to_b * sideways;
      row(2, 3 * a + 2) = -1;
      right.head<2>() -= to_b * sideways * yaw_a;
    }
    const Eigen::Matrix3d upper = Whole(factor).llt().matrixU();
    row = (upper * row).eval();
    right = (upper * right).eval();
    for (int i = 0; i < 3; ++i) {
      poses.rows.emplace_back(row.row(i));
      poses.right.push_back(right[i]);
    }
  }
  const Eigen::VectorXd x = poses.Solve({{9, 1.0}, {10, 2.0}, {11, 0.3}});

  const InitialiseReport report = Initialise(&rounds.graph, InitialGuess::kLago, false);
  EXPECT_EQ(report.used, InitialGuess::kLago);
  EXPECT_EQ(report.kept_pieces, 0u);
  EXPECT_EQ(report.summary.rfind("lago: 29 poses", 0), 0u) << report.summary;
  double moved = 0;
  for (int i = 0; i < n; ++i) {
    const auto pose = rounds.graph.ValueOf(static_cast<VariableId>(i));
    EXPECT_NEAR(pose[0], x[3 * i], 1e-11) << i;
    EXPECT_NEAR(pose[1], x[3 * i + 1], 1e-11) << i;
    EXPECT_NEAR(std::remainder(pose[2] - x[3 * i + 2], 2 * M_PI), 0, 1e-11) << i;
    moved = std::max(moved, std::abs(x[3 * i + 2] - yaw[i]));
  }
  EXPECT_GT(moved, 1e-3) << "positions are to improve the angles";
}

TEST(Lago, HasTheSameDigitsAgain) {
  Rounds a, b;
  Initialise(&a.graph, InitialGuess::kLago, false);
  Initialise(&b.graph, InitialGuess::kLago, false);
  EXPECT_EQ(a.graph.InitialValues().Data(), b.graph.InitialValues().Data());
}

TEST(Lago, IsForThePlaneOnly) {
  Graph graph(Builtins());
  graph.Add(Key("pose:0"), "se3/1", {0, 0, 0, 0, 0, 0, 1});
  const std::vector<double> before = graph.InitialValues().Data();
  try {
    Initialise(&graph, InitialGuess::kLago, false);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.Kind(), ErrorKind::kUsage);
    EXPECT_NE(std::string(error.what()).find("pose:0 is in space (se3/1); take chordal"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(graph.InitialValues().Data(), before);
}

const Noise kNoise = Noise::Sigma(0.1);

void AddSquare(Graph* graph, const char* family, const std::vector<double>& first) {
  for (std::uint64_t i = 0; i < 4; ++i)
    graph->Add(Key(family, i), "se2/1", i == 0 ? first : std::vector<double>{0, 0, 0});
  for (std::uint64_t i = 0; i < 4; ++i)
    graph->Add(BetweenSe2Factor(Key(family, i), Key(family, (i + 1) % 4),
                                {2.1, 0.1, M_PI / 2 + 0.1}, kNoise));
}

TEST(Lago, SolvesEveryPieceFromItsOwnGaugeAndLeavesASingularOneToTheTree) {
  Graph graph(Builtins());
  AddSquare(&graph, "a", {100, 0, 0});
  AddSquare(&graph, "b", {0, -50, M_PI});
  AddSquare(&graph, "c", {0, 50, 1});
  // Where c:4 looks was never measured.
  graph.Add(Key("c:4"), "se2/1", {0, 0, 0});
  graph.Add(
      BetweenSe2Factor(Key("c:0"), Key("c:4"), {1, 2, 0}, Noise::Information({1, 0, 0, 1, 0, 0})));
  Values tree = graph.InitialValues();
  PlaceBySpanningTree(graph, Growth::kBreadthFirst, &tree);
  const InitialiseReport report = Initialise(&graph, InitialGuess::kLago, false);
  EXPECT_EQ(report.kept_pieces, 1u);
  EXPECT_NE(report.summary.find("1 piece by the spanning tree"), std::string::npos);
  for (std::uint64_t i = 0; i < 5; ++i) {
    const auto expected = tree.At(Key("c", i)), found = graph.ValueOf(graph.IdOf(Key("c", i)));
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(found[j], expected[j]) << i;
  }
  // The squares that could be solved are the same figure, turned by half.
  for (std::uint64_t i = 0; i < 4; ++i) {
    const auto a = graph.ValueOf(graph.IdOf(Key("a", i)));
    const auto b = graph.ValueOf(graph.IdOf(Key("b", i)));
    EXPECT_NEAR(a[0] - 100, -b[0], 1e-12);
    EXPECT_NEAR(a[1], -b[1] - 50, 1e-12);
    EXPECT_NEAR(std::abs(std::remainder(a[2] - b[2], 2 * M_PI)), M_PI, 1e-12);
  }
  const auto a2 = graph.ValueOf(graph.IdOf(Key("a:2")));
  const auto by_tree = tree.At(Key("a:2"));
  EXPECT_GT(std::hypot(a2[0] - by_tree[0], a2[1] - by_tree[1]), 0.01) << "it was solved";
}

TEST(Lago, PlacesLandmarksFromThePoses) {
  Graph graph(Builtins());
  AddSquare(&graph, "a", {0, 0, 0});
  graph.Add(Key("landmark:0"), "point2/1", {0, 0});
  graph.Add(LandmarkSe2Factor(Key("a:2"), Key("landmark:0"), {1, 0}, kNoise));
  EXPECT_EQ(Initialise(&graph, InitialGuess::kLago, false).landmarks, 1u);
  const auto pose = graph.ValueOf(2), landmark = graph.ValueOf(4);
  EXPECT_NEAR(landmark[0], pose[0] + std::cos(pose[2]), 1e-14);
  EXPECT_NEAR(landmark[1], pose[1] + std::sin(pose[2]), 1e-14);
}

}  // namespace
}  // namespace graticule
