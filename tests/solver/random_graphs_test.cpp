// Ten thousand random graphs, most of them unreasonable: whatever they are, Solve ends, and what it
// says of success is finite; covariances are symmetric and positive definite, or there are none.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "graticule/factors/builtins.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/graph.hpp"
#include "graticule/solver/marginals.hpp"
#include "graticule/solver/solve.hpp"

namespace graticule {
namespace {

struct Kind {
  const char* type;
  std::vector<const char*> variables;
  int measurement, residual;
  int rotation_at;  // in the measurement: a quaternion; -1: none
};
const std::vector<Kind> kFactors[] = {{{"prior_se2/1", {"se2/1"}, 3, 3, -1},
                                       {"between_se2/1", {"se2/1", "se2/1"}, 3, 3, -1},
                                       {"between_se2/1", {"se2/1", "se2/1"}, 3, 3, -1},
                                       {"position_se2/1", {"se2/1"}, 2, 2, -1},
                                       {"landmark_se2/1", {"se2/1", "point2/1"}, 2, 2, -1},
                                       {"bearing_range_se2/1", {"se2/1", "point2/1"}, 2, 2, -1},
                                       {"range_se2/1", {"se2/1", "point2/1"}, 1, 1, -1}},
                                      {{"prior_se3/1", {"se3/1"}, 7, 6, 3},
                                       {"between_se3/1", {"se3/1", "se3/1"}, 7, 6, 3},
                                       {"between_se3/1", {"se3/1", "se3/1"}, 7, 6, 3},
                                       {"position_se3/1", {"se3/1"}, 6, 3, -1},
                                       {"landmark_se3/1", {"se3/1", "point3/1"}, 3, 3, -1}}};

class World {
 public:
  explicit World(unsigned seed) : random_(seed) {}

  bool Chance(double share) { return Uniform() < share; }
  int Whole(int end) { return static_cast<int>(Uniform() * end); }
  double Uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double Normal() { return std::normal_distribution<double>()(random_); }
  /// From far too small to far too large, now and then.
  double Scale() {
    const double kScales[] = {1e-300, 1e-100, 1e-12, 1e-6, 1e6, 1e12, 1e100, 1e300};
    return Chance(0.9) ? 1 : kScales[Whole(8)];
  }

  std::vector<double> Numbers(int count, int rotation_at, double scale) {
    std::vector<double> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(scale * Normal());
    if (rotation_at < 0) return numbers;
    Eigen::Vector4d rotation(Normal(), Normal(), Normal(), Normal());
    rotation.normalize();
    for (int i = 0; i < 4; ++i) numbers[static_cast<std::size_t>(rotation_at + i)] = rotation[i];
    return numbers;
  }

  Noise RandomNoise(int size) {
    if (Chance(0.3)) return Noise::Unit();
    if (Chance(0.5)) return Noise::Sigma(Scale() * std::exp(Normal()));
    Eigen::MatrixXd root(size, size);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) root(i, j) = Normal();
    Eigen::MatrixXd information = Scale() * root.transpose() * root;
    if (Chance(0.1)) information(0, 0) = -1;
    std::vector<double> upper;
    for (int i = 0; i < size; ++i)
      for (int j = i; j < size; ++j) upper.push_back(information(i, j));
    return Noise::Information(std::move(upper));
  }

  Graph RandomGraph() {
    Graph graph(Builtins());
    const std::vector<Kind>& kinds = kFactors[Chance(0.6) ? 0 : 1];
    const bool is_plane = &kinds == &kFactors[0];
    const int poses = 1 + Whole(8), points = Whole(4);
    const double scale = Scale();
    for (int i = 0; i < poses; ++i)
      graph.Add(Key("pose", static_cast<std::uint64_t>(i)), is_plane ? "se2/1" : "se3/1",
                is_plane ? Numbers(3, -1, scale) : Numbers(7, 3, scale), Chance(0.1));
    for (int i = 0; i < points; ++i)
      graph.Add(Key("point", static_cast<std::uint64_t>(i)), is_plane ? "point2/1" : "point3/1",
                Numbers(is_plane ? 2 : 3, -1, scale), Chance(0.1));
    const int factors = Whole(4 * (poses + points));
    for (int i = 0; i < factors; ++i) {
      const Kind& kind = kinds[static_cast<std::size_t>(Whole(static_cast<int>(kinds.size())))];
      Factor factor;
      factor.type = kind.type;
      for (const char* variable : kind.variables) {
        const bool is_point = std::string(variable).substr(0, 5) == "point";
        factor.keys.emplace_back(is_point ? "point" : "pose",
                                 static_cast<std::uint64_t>(Whole(is_point ? points + 1 : poses)));
      }
      factor.measurement = Numbers(kind.measurement, kind.rotation_at, Scale());
      factor.noise = RandomNoise(kind.residual);
      if (Chance(0.3))
        factor.loss = {static_cast<LossKind>(Whole(7)), Scale() * std::exp(Normal())};
      try {
        graph.Add(factor);
      } catch (const Error&) {  // a key twice or not there, a noise that is none: refused, as it
                                // should be
      }
    }
    return graph;
  }

  SolveOptions RandomOptions() {
    SolveOptions options;
    options.engine = static_cast<Engine>(Whole(3));
    if (options.engine == Engine::kCeres) {
      options.method = static_cast<Method>(Whole(4));
      options.linear_algebra = static_cast<LinearAlgebra>(Whole(2));
    }
    options.max_iterations = Chance(0.1) ? 0 : 30;
    options.nonmonotonic_steps = options.engine == Engine::kCeres && Chance(0.1);
    options.allow_pieces = Chance(0.5);
    if (Chance(0.1)) options.anchor = Anchoring::kNone;
    return options;
  }

 private:
  std::mt19937 random_;
};

struct Counts {
  int solved = 0, converged = 0, refused = 0, covariances = 0, diagnosed = 0;
};

void ExpectCovariances(const Graph& graph, const Values& values, Counts* counts) {
  std::vector<Key> keys;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) keys.push_back(graph.KeyOf(id));
  const std::variant<Marginals, Diagnosis> found = ComputeMarginals(graph, values, keys);
  if (std::holds_alternative<Diagnosis>(found)) {
    ++counts->diagnosed;
    return;
  }
  ++counts->covariances;
  for (const Key& key : keys) {
    const std::vector<double>& block = std::get<Marginals>(found).Covariance(key);
    const int size = static_cast<int>(std::lround(std::sqrt(static_cast<double>(block.size()))));
    const Eigen::MatrixXd covariance =
        Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(block.data(), size, size);
    ASSERT_TRUE(covariance.allFinite()) << key.ToString();
    EXPECT_EQ(covariance, covariance.transpose()) << key.ToString();
    if (covariance.isZero(0)) continue;  // held
    // Of correlations: units may be 1e12 apart.
    const Eigen::VectorXd deviations = covariance.diagonal().cwiseSqrt();
    ASSERT_GT(covariance.diagonal().minCoeff(), 0) << key.ToString() << "\n" << covariance;
    const Eigen::MatrixXd correlations = deviations.cwiseInverse().asDiagonal() * covariance *
                                         deviations.cwiseInverse().asDiagonal();
    const double least =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations).eigenvalues().minCoeff();
    EXPECT_GT(least, -1e-12) << key.ToString() << "\n" << covariance;
  }
}

void Try(unsigned seed, Counts* counts) {
  World world(seed);
  const Graph graph = world.RandomGraph();
  const SolveOptions options = world.RandomOptions();
  try {
    const Solution solution = Solve(graph, options);
    ++counts->solved;
    const Report& report = solution.report;
    if (report.termination == Termination::kFailed) return;
    if (report.termination == Termination::kConverged) ++counts->converged;
    EXPECT_TRUE(std::isfinite(report.final_objective)) << ToString(report.termination);
    EXPECT_TRUE(std::isfinite(report.final_cost));
    EXPECT_LE(report.final_objective, report.initial_objective * (1 + 1e-9));
    for (VariableId id = 0; id < graph.VariableCount(); ++id)
      for (const double number : solution.values.At(graph.KeyOf(id)))
        EXPECT_TRUE(std::isfinite(number)) << graph.KeyOf(id).ToString();
    ExpectCovariances(graph, solution.values, counts);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()), "");
    EXPECT_NE(error.Kind(), ErrorKind::kMissingType) << error.what();
    ++counts->refused;
  }
}

TEST(RandomGraphs, AreSolvedOrRefused) {
  Counts counts;
  for (unsigned seed = 1; seed <= 10000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Try(seed, &counts);
    if (HasFailure()) return;
  }
  // The test would say nothing if all were refused.
  EXPECT_GT(counts.solved, 3000);
  EXPECT_GT(counts.converged, 2000);
  EXPECT_GT(counts.refused, 500);
  EXPECT_GT(counts.covariances, 1000);
  EXPECT_GT(counts.diagnosed, 100);
  RecordProperty("solved", counts.solved);
  RecordProperty("converged", counts.converged);
  RecordProperty("covariances", counts.covariances);
}

}  // namespace
}  // namespace graticule
