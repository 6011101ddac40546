#include "graticule/problems/pose_graph/certify.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "certify_graphs.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/problems/pose_graph/certify_escape.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/simulate.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {
namespace {

using test::Cost;
using test::Reading;

// Two poses that two factors join, turned apart by `apart` either way: the two angles between them
// that are stationary are 0, at a cost of apart^2, and pi, at a cost of (pi - apart)^2.
Graph Fork(Reading reading, double apart_rad) {
  Graph graph(Builtins());
  const auto turned = [&](double yaw_rad) {
    if (reading == Reading::kPlane) return std::vector<double>{0, 0, yaw_rad};
    return std::vector<double>{0, 0, 0, 0, 0, std::sin(yaw_rad / 2), std::cos(yaw_rad / 2)};
  };
  graph.Add(Key("pose:0"), test::PoseType(reading), turned(0), true);
  graph.Add(Key("pose:1"), test::PoseType(reading), turned(0));
  for (const double side : {1, -1})
    graph.Add(Factor{test::BetweenType(reading),
                     {Key("pose:0"), Key("pose:1")},
                     turned(side * apart_rad),
                     Noise::Unit(),
                     Loss{},
                     ""});
  return graph;
}

Values WithTurn(const Graph& graph, Reading reading, double yaw_rad) {
  Values values = graph.InitialValues();
  double* pose = values.Mutable(1);
  if (reading == Reading::kPlane)
    pose[2] = yaw_rad;
  else
    pose[5] = std::sin(yaw_rad / 2), pose[6] = std::cos(yaw_rad / 2);
  return values;
}

TEST(Certify, KnowsWhichOfTwoMinimaIsGlobal) {
  for (const Reading reading : {Reading::kPlane, Reading::kAngle})
    for (const double apart : {0.3, 1.0, 1.5, 1.65, 2.0, 2.8}) {
      const Graph graph = Fork(reading, apart);
      const double near = apart * apart, far = (M_PI - apart) * (M_PI - apart);
      const Certificate at_zero = Certify(graph, WithTurn(graph, reading, 0));
      const Certificate at_pi = Certify(graph, WithTurn(graph, reading, M_PI));
      EXPECT_NEAR(at_zero.cost, near, 1e-12);
      EXPECT_NEAR(at_pi.cost, far, 1e-12);
      EXPECT_EQ(at_zero.verdict, near < far ? Verdict::kOptimal : Verdict::kRefused) << apart;
      EXPECT_EQ(at_pi.verdict, near < far ? Verdict::kRefused : Verdict::kOptimal) << apart;
      EXPECT_LE(at_zero.lower_bound, std::min(near, far) + 1e-9);
      EXPECT_LE(at_pi.lower_bound, std::min(near, far) + 1e-9);
    }
}

// Of quaternions the vector part is what counts: sin^2(half the angle), summed over the two.
TEST(Certify, KnowsTheMinimumOfQuaternions) {
  for (const double apart : {0.3, 1.5, 1.65, 2.8}) {
    const Graph graph = Fork(Reading::kQuaternion, apart);
    const double near = std::pow(std::sin(apart / 2), 2);
    const double far = std::pow(std::cos(apart / 2), 2);
    const Certificate at_zero = Certify(graph, WithTurn(graph, Reading::kQuaternion, 0));
    const Certificate at_pi = Certify(graph, WithTurn(graph, Reading::kQuaternion, M_PI));
    EXPECT_NEAR(at_zero.cost, near, 1e-12);
    EXPECT_NEAR(at_pi.cost, far, 1e-12);
    EXPECT_EQ(at_zero.verdict, near < far ? Verdict::kOptimal : Verdict::kRefused) << apart;
    EXPECT_EQ(at_pi.verdict, near < far ? Verdict::kRefused : Verdict::kOptimal) << apart;
  }
}

// A ring whose measured turns add up to one revolution.  Wound twice it is a minimum as well: each
// factor is off by 2 pi / n.
Graph Ring(int count, int turns) {
  Graph graph(Builtins());
  const double step = 2 * M_PI / count;
  for (int i = 0; i < count; ++i)
    graph.Add(Key("pose", static_cast<std::uint64_t>(i)), "se2/1",
              {std::cos(i * step), std::sin(i * step), WrapAngle(i * step * turns)});
  for (int i = 0; i < count; ++i)
    graph.Add(Factor{"between_se2/1",
                     {Key("pose", static_cast<std::uint64_t>(i)),
                      Key("pose", static_cast<std::uint64_t>((i + 1) % count))},
                     {1, 0, step},
                     Noise::Sigmas({1, 1, 0.01}),
                     Loss{},
                     ""});
  return graph;
}

TEST(Certify, RefusesARingThatIsWoundTwice) {
  const Graph right = Ring(12, 1), twisted = Ring(12, 2);
  const Solution once = Solve(right), twice = Solve(twisted);
  EXPECT_LT(once.report.final_cost, 1e-9);
  EXPECT_GT(twice.report.final_cost, 1000);
  EXPECT_EQ(Certify(right, once.values).verdict, Verdict::kOptimal);
  const Certificate refused = Certify(twisted, twice.values);
  EXPECT_EQ(refused.verdict, Verdict::kRefused);
  EXPECT_LT(refused.eigenvalue, -1e-3);
  EXPECT_EQ(refused.lower_bound, 0);

  for (const bool by_chordal : {true, false}) {
    EscapeOptions options;
    options.chordal = by_chordal;
    options.staircase = !by_chordal;
    const Escape escape = EscapeMinimum(twisted, twice, refused, options);
    EXPECT_TRUE(escape.improved);
    ASSERT_EQ(escape.attempts.size(), 1u);
    EXPECT_EQ(escape.attempts[0].cost, escape.solution.report.final_cost);
    EXPECT_LT(escape.solution.report.final_cost, 1e-9) << escape.attempts[0].from;
    EXPECT_EQ(escape.certificate.verdict, Verdict::kOptimal);
  }
}

TEST(Certify, LeavesACertifiedSolutionAlone) {
  const Graph graph = Ring(12, 1);
  const Solution solution = Solve(graph);
  const Escape escape = EscapeMinimum(graph, solution, Certify(graph, solution.values));
  EXPECT_FALSE(escape.improved);
  EXPECT_TRUE(escape.attempts.empty());
  EXPECT_EQ(escape.solution.values.Data(), solution.values.Data());
}

// Poses, sensors, landmarks, places: everything that the certificate covers, in both spaces, with
// full information matrices.
Graph Everything(Reading reading, std::uint64_t seed, double coupling) {
  RandomNumbers random(seed);
  const bool plane = reading == Reading::kPlane;
  const int dim = plane ? 2 : 3, size = test::ResidualSize(reading);
  const std::uint64_t count = 10;
  Graph graph(Builtins());
  std::vector<Eigen::Isometry3d> truth;
  for (std::uint64_t i = 0; i < count; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(0.7 * static_cast<double>(i), Eigen::Vector3d::UnitZ()));
    pose.translation() << std::cos(0.6 * static_cast<double>(i)) * 5,
        std::sin(0.6 * static_cast<double>(i)) * 5, 0;
    if (!plane) {
      pose.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.6, 0.8, 0)));
      pose.translation()[2] = 0.3 * static_cast<double>(i);
    }
    truth.push_back(pose);
  }
  const auto stored = [&](const Eigen::Isometry3d& pose) {
    const Eigen::Quaterniond q(pose.linear());
    const auto& t = pose.translation();
    if (plane) return std::vector<double>{t[0], t[1], 2 * std::atan2(q.z(), q.w())};
    return std::vector<double>{t[0], t[1], t[2], q.x(), q.y(), q.z(), q.w()};
  };
  const auto noisy = [&](Eigen::Isometry3d pose) {
    const Eigen::Vector3d axis =
        plane ? Eigen::Vector3d(0, 0, 1)
              : Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    pose.rotate(Eigen::AngleAxisd(0.05 * random.Normal(), axis));
    for (int i = 0; i < dim; ++i) pose.translation()[i] += 0.1 * random.Normal();
    return pose;
  };
  const auto place = [&](const Eigen::Vector3d& point) {
    std::vector<double> numbers;
    for (int i = 0; i < dim; ++i) numbers.push_back(point[i] + 0.1 * random.Normal());
    return numbers;
  };
  // About as large as the noise is: 0.1 m, 0.05 rad.
  const auto information = [&](int of) {
    std::vector<double> upper = test::AnyInformation(of, dim, coupling, 2, &random);
    std::size_t at = 0;
    for (int i = 0; i < of; ++i)
      for (int j = i; j < of; ++j) upper[at++] /= (i < dim ? 0.1 : 0.05) * (j < dim ? 0.1 : 0.05);
    return Noise::Information(upper);
  };
  const auto add = [&](const std::string& type, std::vector<Key> keys, std::vector<double> numbers,
                       int of) {
    graph.Add(Factor{type, std::move(keys), std::move(numbers), information(of), Loss{}, ""});
  };
  const auto join = [](std::vector<double> a, const std::vector<double>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  for (std::uint64_t i = 0; i < count; ++i)
    graph.Add(Key("pose", i), test::PoseType(reading), stored(noisy(truth[i])), i == 2 || i == 6);
  const Eigen::Vector3d first(7, 1, plane ? 0 : 1), second(-3, 2, plane ? 0 : 2);
  graph.Add(Key("landmark:0"), plane ? "point2/1" : "point3/1", place(first));
  graph.Add(Key("landmark:1"), plane ? "point2/1" : "point3/1", place(second), true);
  for (std::uint64_t i = 0; i < count; ++i)
    for (const std::uint64_t hop : {1, 4}) {
      const std::uint64_t to = (i + hop) % count;
      add(test::BetweenType(reading), {Key("pose", i), Key("pose", to)},
          stored(noisy(truth[i].inverse() * truth[to])), size);
    }
  for (std::uint64_t i = 0; i < 5; ++i)
    for (std::uint64_t seen = 0; seen < 2; ++seen)
      add(plane ? "landmark_se2/1" : "landmark_se3/1", {Key("pose", i), Key("landmark", seen)},
          place(truth[i].inverse() * (seen ? second : first)), dim);
  add(plane ? "prior_point2/1" : "prior_point3/1", {Key("landmark:0")}, place(first), dim);
  const std::string ending = reading == Reading::kQuaternion ? "_quaternion/1" : "/1";
  add(plane ? "prior_se2/1" : "prior_se3" + ending, {Key("pose:3")}, stored(noisy(truth[3])), size);
  if (plane) {
    add("position_se2/1", {Key("pose:8")}, place(truth[8].translation()), dim);
    return graph;
  }
  Eigen::Isometry3d sensor = Eigen::Isometry3d::Identity();
  sensor.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(0, 0.6, 0.8)));
  sensor.translation() << 0.3, 0.2, 0.1;
  add("prior_offset_se3" + ending, {Key("pose:4")},
      join(stored(noisy(truth[4] * sensor)), stored(sensor)), size);
  add("landmark_offset_se3/1", {Key("pose:5"), Key("landmark:0")},
      join(place((truth[5] * sensor).inverse() * first), stored(sensor)), dim);
  add("position_se3/1", {Key("pose:8")},
      join(place(truth[8] * Eigen::Vector3d(1, 0, 2)), {1, 0, 2}), dim);
  return graph;
}

TEST(Certify, ProvesEveryKindOfFactorItCoversWithAnyNoise) {
  for (const Reading reading : {Reading::kPlane, Reading::kQuaternion, Reading::kAngle})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      // In space 0.8 is too much: the part that is not coupled gets too light.
      const Graph graph = Everything(reading, seed, reading == Reading::kPlane ? 1 : 0.5);
      const Solution solution = Solve(graph);
      const Certificate certificate = Certify(graph, solution.values);
      SCOPED_TRACE(certificate.summary);
      EXPECT_NEAR(certificate.cost, Cost(graph, solution.values), 1e-9 * certificate.cost);
      EXPECT_TRUE(certificate.reasons.empty());
      EXPECT_EQ(certificate.factors, graph.FactorCount());
      EXPECT_LE(certificate.lower_bound, certificate.cost);
      EXPECT_EQ(certificate.verdict, Verdict::kOptimal);
    }
}

// No values cost less than the bound, wherever one looks: also where solves end that begin
// anywhere.
TEST(Certify, HasABoundThatNothingIsBelow) {
  for (const Reading reading : {Reading::kPlane, Reading::kQuaternion, Reading::kAngle})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Graph graph = Everything(reading, seed, 0.2);
      RandomNumbers random(seed + 100);
      const Values start = graph.InitialValues();
      std::vector<double> bounds;
      std::vector<Values> visited;
      for (int trial = 0; trial < 20; ++trial) {
        Values values = start;
        for (VariableId id = 0; id < graph.VariableCount(); ++id) {
          if (graph.IsFixed(id) || values[id].size() <= 3 - (reading == Reading::kPlane)) continue;
          const std::vector<double> any = test::AnyPose(reading, 8, &random);
          std::copy(any.begin(), any.end(), values.Mutable(id));
        }
        graph.SetValues(values);
        bounds.push_back(Certify(graph, values).lower_bound);
        visited.push_back(values);
        visited.push_back(Solve(graph).values);
        bounds.push_back(Certify(graph, visited.back()).lower_bound);
      }
      const double bound = *std::max_element(bounds.begin(), bounds.end());
      EXPECT_GT(bound, 0);
      for (const Values& values : visited) EXPECT_GE(Cost(graph, values), bound * (1 - 1e-9));
    }
}

// Fixing a pose that a solution was held at changes nothing; moving everything far away neither.
TEST(Certify, DoesNotMindWhereTheWorldIs) {
  CityOptions city;
  city.robots = 1;
  city.poses_per_robot = 200;
  for (const int dimension : {2, 3}) {
    city.dimension = dimension;
    Graph graph = SimulateCity(Builtins(), city).graph;
    graph.SetFixed(0, false);
    const Solution solution = Solve(graph);
    EXPECT_EQ(Certify(graph, solution.values).verdict, Verdict::kOptimal);
    graph.SetFixed(0, true);
    EXPECT_EQ(Certify(graph, solution.values).verdict, Verdict::kOptimal);
    Values far = solution.values;
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      for (int i = 0; i < dimension; ++i) far.Mutable(id)[i] += 5e6;
    graph.SetValues(far);
    EXPECT_EQ(Certify(graph, far).verdict, Verdict::kOptimal);
    graph.SetFixed(0, false);
    EXPECT_EQ(Certify(graph, far).verdict, Verdict::kOptimal);
  }
}

TEST(Certify, ProvesPiecesTogether) {
  Graph graph(Builtins());
  for (std::uint64_t i = 0; i < 6; ++i) graph.Add(Key("pose", i), "se2/1", {double(i), 0, 0});
  for (const std::uint64_t first : {0, 3})
    for (std::uint64_t i = 0; i < 3; ++i)
      graph.Add(Factor{"between_se2/1",
                       {Key("pose", first + i), Key("pose", first + (i + 1) % 3)},
                       {1, 0.1, 2.1},
                       Noise::Sigma(0.1),
                       Loss{},
                       ""});
  Initialise(&graph, InitialGuess::kChordal, true);
  SolveOptions options;
  options.allow_pieces = true;
  const Solution solution = Solve(graph, options);
  EXPECT_EQ(Certify(graph, solution.values).verdict, Verdict::kOptimal);
}

TEST(Certify, SaysWhyItDoesNotApply) {
  const auto reason = [](const Graph& graph) {
    const Certificate certificate = Certify(graph, graph.InitialValues());
    EXPECT_EQ(certificate.verdict, Verdict::kNotApplicable);
    EXPECT_EQ(certificate.reasons.size(), 1u);
    EXPECT_EQ(certificate.summary.rfind("not applicable: ", 0), 0u);
    return certificate.reasons.empty() ? "" : certificate.reasons[0];
  };
  EXPECT_EQ(reason(Graph(Builtins())), "no poses (se2/1, se3/1)");
  Graph lossy = Ring(5, 1);
  lossy.SetLosses(MakeLoss("huber", 1));
  EXPECT_EQ(reason(lossy), "5 factors with loss huber");
  Graph seen = Ring(5, 1);
  seen.Add(Key("landmark:0"), "point2/1", {1, 1});
  seen.Add(
      Factor{"bearing_se2/1", {Key("pose:0"), Key("landmark:0")}, {1}, Noise::Unit(), Loss{}, ""});
  EXPECT_EQ(reason(seen), "1 factor of type bearing_se2/1: no quadratic statement");
  Graph partial = Ring(5, 1);
  partial.Add(PriorSe2Factor(Key("pose:0"), {1, 1, 1}, Noise::Information({1, 0, 0, 1, 0, 0})));
  EXPECT_EQ(reason(partial), "1 factor with a component that was not measured");
  Graph both = Ring(5, 1);
  both.Add(Key("other:0"), "se3/1", {0, 0, 0, 0, 0, 0, 1});
  EXPECT_EQ(reason(both), "1 variable is neither poses nor points of one space");
}

TEST(Certify, GivesTheSameDigitsTwice) {
  const Graph graph = Everything(Reading::kQuaternion, 3, 1);
  const Values values = Solve(graph).values;
  const Certificate a = Certify(graph, values), b = Certify(graph, values);
  EXPECT_EQ(a.lower_bound, b.lower_bound);
  EXPECT_EQ(a.eigenvalue, b.eigenvalue);
  EXPECT_EQ(a.summary, b.summary);
}

}  // namespace
}  // namespace graticule
