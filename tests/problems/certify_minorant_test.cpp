// The pieces of the certificate, each against a slow and independent check.  The minorants are held
// against the factors themselves, the sparse matrix against dense eigenvalues.

#include "graticule/problems/pose_graph/certify_minorant.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "certify_graphs.hpp"
#include "graticule/problems/pose_graph/certify_descent.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

using test::Cost;
using test::Reading;

template <int kDim>
double ValueOf(const Quadratic<kDim>& quadratic, const Poses<kDim>& poses) {
  return 0.5 * poses.cwiseProduct(quadratic.Times(poses)).sum();
}

// What differs from factor to factor is all there is to it: two poses and one factor.
Graph Pair(Reading reading, bool coupled, double spread, RandomNumbers* random) {
  Graph graph(Builtins());
  for (std::uint64_t i = 0; i < 2; ++i)
    graph.Add(Key("pose", i), test::PoseType(reading), test::AnyPose(reading, 3, random));
  const int size = test::ResidualSize(reading);
  graph.Add(Factor{test::BetweenType(reading),
                   {Key("pose:0"), Key("pose:1")},
                   test::AnyPose(reading, 3, random),
                   Noise::Information(test::AnyInformation(size, size == 3 ? 2 : 3, coupled ? 1 : 0,
                                                           spread, random)),
                   Loss{},
                   ""});
  return graph;
}

template <int kDim>
void ExpectNowhereAbove(Reading reading, bool coupled, double spread, bool expect_exact) {
  RandomNumbers random(5 + static_cast<std::uint64_t>(reading) + (coupled ? 10 : 0));
  int touched = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Graph graph = Pair(reading, coupled, spread, &random);
    // The reference: close to what was measured, as solutions are, or anywhere.
    const FactorView factor = graph.FactorAt(0);
    if (trial % 2) {
      Values values = graph.InitialValues();
      const std::vector<double> zero = reading == Reading::kPlane
                                           ? std::vector<double>{0, 0, 0}
                                           : std::vector<double>{0, 0, 0, 0, 0, 0, 1};
      std::copy(zero.begin(), zero.end(), values.Mutable(0));
      std::copy(factor.measurement.begin(), factor.measurement.end(), values.Mutable(1));
      for (int i = 0; i < 3; ++i) values.Mutable(1)[i] += 0.2 * random.Normal();
      graph.SetValues(values);
    }
    std::vector<std::string> reasons;
    const Program<kDim> program = ReadProgram<kDim>(graph, &reasons);
    ASSERT_TRUE(reasons.empty());
    const Values at = graph.InitialValues();
    const Poses<kDim> reference = program.Read(at);
    const StandInResult<kDim> minorant = MakeStandIn(program, reference, StandIn::kMinorant);
    const double cost = Cost(graph, at);
    ASSERT_NEAR(minorant.cost, cost, 1e-10 * (1 + cost));
    EXPECT_GE(minorant.shortfall, -1e-12 * (1 + cost));
    if (minorant.exact) {
      EXPECT_EQ(minorant.shortfall, 0);
      ++touched;
    }
    const double there = cost - minorant.shortfall;
    const double value_there = ValueOf(minorant.quadratic, reference);
    for (int sample = 0; sample < 200; ++sample) {
      Values values = at;
      // From all scales: near the reference the two touch, and rounding is all that is between.
      const double scale = std::pow(10.0, random.Uniform(-4, 1));
      for (VariableId id = 0; id < 2; ++id) {
        const std::vector<double> any = test::AnyPose(reading, 3, &random);
        double* value = values.Mutable(id);
        for (std::size_t i = 0; i < any.size(); ++i)
          value[i] = sample % 3 ? value[i] + scale * random.Normal() : any[i];
        if (reading == Reading::kPlane)
          value[2] = std::remainder(value[2], 2 * M_PI);
        else
          Eigen::Map<Eigen::Vector4d>(value + 3).normalize();
      }
      const double said = there + ValueOf(minorant.quadratic, program.Read(values)) - value_there;
      const double true_cost = Cost(graph, values);
      ASSERT_LE(said, true_cost + 1e-9 * (1 + true_cost + cost)) << "trial " << trial;
    }
  }
  EXPECT_EQ(touched > 0, expect_exact);
}

TEST(Minorant, IsNowhereAboveTheCostInThePlane) {
  ExpectNowhereAbove<2>(Reading::kPlane, false, 1, true);
  ExpectNowhereAbove<2>(Reading::kPlane, false, 30, true);
  ExpectNowhereAbove<2>(Reading::kPlane, true, 3, true);
}

TEST(Minorant, IsNowhereAboveTheCostOfQuaternions) {
  ExpectNowhereAbove<3>(Reading::kQuaternion, false, 10, true);
  ExpectNowhereAbove<3>(Reading::kQuaternion, true, 3, true);
}

TEST(Minorant, IsNowhereAboveTheCostOfRotationVectors) {
  ExpectNowhereAbove<3>(Reading::kAngle, false, 10, false);
  ExpectNowhereAbove<3>(Reading::kAngle, true, 3, false);
}

// Where it is exact, solutions are stationary points of it too: the gradients agree.
template <int kDim>
void ExpectSameGradient(Reading reading, bool coupled) {
  RandomNumbers random(77);
  for (int trial = 0; trial < 20; ++trial) {
    const Graph graph = Pair(reading, coupled, 5, &random);
    std::vector<std::string> reasons;
    const Program<kDim> program = ReadProgram<kDim>(graph, &reasons);
    const Values at = graph.InitialValues();
    const StandInResult<kDim> minorant = MakeStandIn(program, program.Read(at), StandIn::kMinorant);
    if (!minorant.exact) continue;
    const auto slope = [&](std::size_t number, auto&& of) {
      const double step = 1e-5;
      Values ahead = at, behind = at;
      ahead.MutableData()[number] += step;
      behind.MutableData()[number] -= step;
      if (reading != Reading::kPlane)
        for (Values* values : {&ahead, &behind})
          for (VariableId id = 0; id < 2; ++id)
            Eigen::Map<Eigen::Vector4d>(values->Mutable(id) + 3).normalize();
      return (of(ahead) - of(behind)) / (2 * step);
    };
    for (std::size_t number = 0; number < at.Data().size(); ++number) {
      const double of_cost = slope(number, [&](const Values& v) { return Cost(graph, v); });
      const double of_minorant = slope(
          number, [&](const Values& v) { return ValueOf(minorant.quadratic, program.Read(v)); });
      EXPECT_NEAR(of_cost, of_minorant, 1e-5 * (1 + minorant.cost)) << "trial " << trial;
    }
  }
}

TEST(Minorant, HasTheGradientOfTheCostWhereItIsExact) {
  ExpectSameGradient<2>(Reading::kPlane, false);
  ExpectSameGradient<2>(Reading::kPlane, true);
  ExpectSameGradient<3>(Reading::kQuaternion, false);
  ExpectSameGradient<3>(Reading::kQuaternion, true);
}

// --- the matrix

// Eight poses in a ring with chords, solved from a good start and from a bad one.
Graph Chorded(Reading reading, RandomNumbers* random) {
  Graph graph(Builtins());
  const std::uint64_t count = 8;
  for (std::uint64_t i = 0; i < count; ++i)
    graph.Add(Key("pose", i), test::PoseType(reading), test::AnyPose(reading, 3, random));
  const int size = test::ResidualSize(reading);
  for (std::uint64_t i = 0; i < count; ++i)
    for (const std::uint64_t hop : {1, 3})
      graph.Add(
          Factor{test::BetweenType(reading),
                 {Key("pose", i), Key("pose", (i + hop) % count)},
                 test::AnyPose(reading, 1, random),
                 Noise::Information(test::AnyInformation(size, size == 3 ? 2 : 3, 0, 3, random)),
                 Loss{},
                 ""});
  return graph;
}

template <int kDim>
void ExpectDenseEigenvalue(Reading reading) {
  RandomNumbers random(3);
  const Graph graph = Chorded(reading, &random);
  std::vector<std::string> reasons;
  const Program<kDim> program = ReadProgram<kDim>(graph, &reasons);
  const Poses<kDim> poses = program.Read(Solve(graph).values);
  const StandInResult<kDim> minorant = MakeStandIn(program, poses, StandIn::kMinorant);
  const Dual<kDim> dual = DualAt(program, minorant.quadratic, poses);

  constexpr int kBlock = kDim + 1;
  const int nodes = program.NodeCount();
  Eigen::MatrixXd s = Eigen::MatrixXd::Zero(kBlock * nodes, kBlock * nodes);
  for (int i = 0; i < nodes; ++i)
    s.block<kBlock, kBlock>(kBlock * i, kBlock * i) = dual.diagonal[static_cast<std::size_t>(i)];
  for (const auto& term : minorant.quadratic.terms) {
    s.block<kBlock, kBlock>(kBlock * term.a, kBlock * term.b) += term.ab;
    s.block<kBlock, kBlock>(kBlock * term.b, kBlock * term.a) += term.ab.transpose();
  }
  // It is what the gradient is made of, and X is in its kernel but for that.
  EXPECT_LT((poses * s - dual.gradient).norm(), 1e-9 * s.norm() * poses.norm());
  // The translations eliminated, but for the first, which the gauge gives away.
  std::vector<int> t, r;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < kBlock; ++j)
      if (j)
        r.push_back(kBlock * i + j);
      else if (i)
        t.push_back(kBlock * i);
  const Eigen::MatrixXd tt = s(t, t), tr = s(t, r);
  Eigen::MatrixXd reduced = s(r, r) - tr.transpose() * tt.ldlt().solve(tr);
  Eigen::VectorXd weights(r.size());
  for (int i = 0; i < nodes; ++i)
    weights.segment<kDim>(kDim * i).setConstant(
        s.block<kDim, kDim>(kBlock * i + 1, kBlock * i + 1).diagonal().cwiseAbs().maxCoeff());
  const Eigen::VectorXd root = weights.cwiseSqrt().cwiseInverse();
  reduced = root.asDiagonal() * reduced * root.asDiagonal();
  const double smallest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(reduced).eigenvalues()[0];

  CertificateMatrix<kDim> matrix(program);
  matrix.Load(minorant.quadratic, dual);
  EXPECT_NEAR(matrix.Allowance(), 0.5 * weights.sum(), 1e-9 * weights.sum());
  ASSERT_LT(smallest, -1e-3);  // random measurements have bad minima
  EXPECT_TRUE(matrix.IsPositive(-smallest * (1 + 1e-6)));
  EXPECT_FALSE(matrix.IsPositive(-smallest * (1 - 1e-6)));
  const auto direction = matrix.SmallestEigenvalue(1e3);
  ASSERT_TRUE(direction.has_value());
  EXPECT_NEAR(direction->eigenvalue, smallest, 1e-6 * std::abs(smallest));
  const Eigen::RowVectorXd& row = direction->row;
  EXPECT_NEAR((row * s).dot(row), smallest, 1e-4 * std::abs(smallest));
}

TEST(CertificateMatrix, HasTheEigenvalueOfTheDenseOne) {
  ExpectDenseEigenvalue<2>(Reading::kPlane);
  ExpectDenseEigenvalue<3>(Reading::kQuaternion);
  ExpectDenseEigenvalue<3>(Reading::kAngle);
}

// At any rank.  With rows to spare the minimum is not isolated, and steps get shorter only slowly.
template <int kDim>
void ExpectDescent(Reading reading) {
  RandomNumbers random(9);
  const Graph graph = Chorded(reading, &random);
  std::vector<std::string> reasons;
  const Program<kDim> program = ReadProgram<kDim>(graph, &reasons);
  const Poses<kDim> flat = program.Read(graph.InitialValues());
  const auto chordal = MakeStandIn(program, flat, StandIn::kChordal);
  for (const int more : {0, 1, 2}) {
    Poses<kDim> poses = Poses<kDim>::Zero(kDim + more, flat.cols());
    poses.topRows(kDim) = flat;
    const double before = ValueOf(chordal.quadratic, poses);
    EXPECT_GT(before, 0);
    DescentOptions options;
    options.damping = 1e-3;
    options.tolerance = (more ? 1e-7 : 1e-14) * before;
    const Descent descent = Descend(program, chordal.quadratic, options, &poses);
    EXPECT_TRUE(descent.converged);
    EXPECT_LT(descent.steps, 60);
    EXPECT_NEAR(before - ValueOf(chordal.quadratic, poses), descent.drop, 1e-9 * before);
    EXPECT_LT(DualAt(program, chordal.quadratic, poses).gradient.norm(),
              (more ? 1e-2 : 1e-5) * before);
    for (int node = 0; node < program.NodeCount(); ++node) {
      const auto rotation = poses.template middleCols<kDim>((kDim + 1) * node + 1);
      EXPECT_TRUE((rotation.transpose() * rotation).isIdentity(1e-12));
    }
  }
}

TEST(Descent, EndsWhereTheGradientIsZero) {
  ExpectDescent<2>(Reading::kPlane);
  ExpectDescent<3>(Reading::kQuaternion);
}

}  // namespace
}  // namespace graticule
