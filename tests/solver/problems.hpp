#pragma once

// Small problems with known answers, and factors that only tests need.

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/make.hpp"
#include "graticule/factors/sdk.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule::testing {

using Numbers = std::vector<double>;

/// Residual A a + B b - z, of 2 numbers, for a in R^2 and b in R^3.
struct LinearFactor {
  static constexpr const char* kName = "linear/1";
  static constexpr const char* kSchema =
      "a:vector2/1 b:vector3/1 | a00 a01 a10 a11 b00 b01 b02 b10 b11 b12 z0 z1 | r0 r1";
  static constexpr const char* kSummary = "linear in its variables";
  double m[12];
  explicit LinearFactor(Measurement measured) {
    for (int i = 0; i < 12; ++i) m[i] = measured[i];
  }
  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    for (int r = 0; r < 2; ++r)
      residual[r] = m[2 * r] * a[0] + m[2 * r + 1] * a[1] + m[4 + 3 * r] * b[0] +
                    m[5 + 3 * r] * b[1] + m[6 + 3 * r] * b[2] - m[10 + r];
    return true;
  }
};

/// Residual x - measured, cannot be evaluated where x < limit.
struct LimitedFactor {
  static constexpr const char* kName = "limited/1";
  static constexpr const char* kSchema = "x:vector1/1 | x limit | r";
  static constexpr const char* kSummary = "x, where it is not too small";
  double x, limit;
  explicit LimitedFactor(Measurement m) : x(m[0]), limit(m[1]) {}
  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = value[0] - x;
    return !(value[0] < limit);
  }
};

/// Residual log(x) - measured.
struct LogFactor {
  static constexpr const char* kName = "log/1";
  static constexpr const char* kSchema = "x:vector1/1 | y | r";
  static constexpr const char* kSummary = "logarithm of x";
  double y;
  explicit LogFactor(Measurement m) : y(m[0]) {}
  template <class T>
  bool operator()(const T* x, T* residual) const {
    using std::log;
    residual[0] = log(x[0]) - y;
    return true;
  }
};

/// Residual y - (line0 + line1 x).
struct LineFactor {
  static constexpr const char* kName = "line/1";
  static constexpr const char* kSchema = "line:vector2/1 | x y | r";
  static constexpr const char* kSummary = "a point on a line";
  double x, y;
  explicit LineFactor(Measurement m) : x(m[0]), y(m[1]) {}
  template <class T>
  bool operator()(const T* line, T* residual) const {
    residual[0] = y - (line[0] + line[1] * x);
    return true;
  }
};

/// The built-in types and those above.
inline Registry TestTypes() {
  Registry types = Builtins();
  for (const graticule_factor_type_v1* table :
       {&sdk::Table<LinearFactor>::kTable, &sdk::Table<LimitedFactor>::kTable,
        &sdk::Table<LogFactor>::kTable, &sdk::Table<LineFactor>::kTable})
    types.Add(MakeFactorType(*table, "test"));
  return types;
}

using Random = std::mt19937_64;

inline double Gauss(Random* random, double sigma) {
  return std::normal_distribution<double>(0, sigma)(*random);
}

inline std::array<double, 3> Relative(const Numbers& a, const Numbers& b) {
  const double c = std::cos(a[2]), s = std::sin(a[2]), dx = b[0] - a[0], dy = b[1] - a[1];
  return {c * dx + s * dy, c * dy - s * dx, b[2] - a[2]};
}

/// The poses of a closed walk around a circle of this many poses, 1 m apart.
inline std::vector<Numbers> Circle(unsigned count) {
  std::vector<Numbers> poses;
  const double radius = count / (2 * M_PI);
  for (unsigned i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    poses.push_back({radius * std::sin(angle), radius * (1 - std::cos(angle)),
                     angle > M_PI ? angle - 2 * M_PI : angle});
  }
  return poses;
}

/// A loop of se2 poses, measured with noise (0: exactly), started beside the answer by `off`.
/// Nothing is fixed.
inline Graph Se2Loop(unsigned count, double noise, double off, std::uint64_t seed = 3) {
  Random random(seed);
  const std::vector<Numbers> truth = Circle(count);
  Graph graph(TestTypes());
  for (unsigned i = 0; i < count; ++i) {
    Numbers value = truth[i];
    if (i > 0)
      for (double& x : value) x += Gauss(&random, off);
    graph.Add(Key("pose", i), "se2/1", value);
  }
  for (unsigned i = 0; i < count; ++i) {
    std::array<double, 3> measured = Relative(truth[i], truth[(i + 1) % count]);
    for (double& x : measured) x += Gauss(&random, noise);
    graph.Add(BetweenSe2Factor(Key("pose", i), Key("pose", (i + 1) % count), measured,
                               Noise::Sigmas({0.1, 0.1, 0.05}),
                               i + 1 < count ? "odometry" : "loop"));
  }
  return graph;
}

inline Numbers Se3(const Eigen::Vector3d& t, const Eigen::Quaterniond& q) {
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

/// A loop of se3 poses on a tilted, climbing circle.
inline Graph Se3Loop(unsigned count, double noise, double off, std::uint64_t seed = 4) {
  Random random(seed);
  std::vector<Eigen::Isometry3d> truth;
  for (unsigned i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(Eigen::Vector3d(5 * std::cos(angle), 5 * std::sin(angle), std::sin(2 * angle)));
    pose.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d(0.1, 0.2, 1).normalized()));
    truth.push_back(pose);
  }
  const auto disturbed = [&](Eigen::Isometry3d pose, double sigma) {
    const Eigen::Vector3d turn(Gauss(&random, sigma), Gauss(&random, sigma), Gauss(&random, sigma));
    const Eigen::Vector3d move(Gauss(&random, sigma), Gauss(&random, sigma), Gauss(&random, sigma));
    pose.translate(move);
    if (turn.norm() > 0) pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    return Se3(pose.translation(), Eigen::Quaterniond(pose.rotation()).normalized());
  };
  Graph graph(TestTypes());
  for (unsigned i = 0; i < count; ++i)
    graph.Add(Key("body", i), "se3/1", disturbed(truth[i], i ? off : 0));
  for (unsigned i = 0; i < count; ++i) {
    const Numbers measured = disturbed(truth[i].inverse() * truth[(i + 1) % count], noise);
    Se3Array array{};
    std::copy(measured.begin(), measured.end(), array.begin());
    graph.Add(BetweenSe3Factor(Key("body", i), Key("body", (i + 1) % count), array,
                               Noise::Sigmas({0.1, 0.1, 0.1, 0.02, 0.02, 0.02}), "odometry"));
  }
  return graph;
}

/// The whitened Jacobian (free variables in key order, tangents) and residual, by central
/// differences of factors evaluated through their tables, whitened with Eigen: nothing of the
/// solver's own linear algebra.
struct Dense {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
  std::vector<int> first;  ///< column by VariableId; -1 where held
};

inline Dense Linearise(const Graph& graph, const Values& values, const std::vector<Key>& anchors) {
  Dense dense;
  dense.first.assign(graph.VariableCount(), -1);
  int columns = 0, rows = 0;
  for (const VariableId id : graph.KeyOrder()) {
    bool held = graph.IsFixed(id);
    for (const Key& anchor : anchors) held |= graph.KeyOf(id) == anchor;
    if (held) continue;
    dense.first[id] = columns;
    columns += graph.TypeOf(id).TangentSize();
  }
  for (FactorId id = 0; id < graph.FactorCount(); ++id) rows += graph.ResidualSize(id);
  dense.jacobian = Eigen::MatrixXd::Zero(rows, columns);
  dense.residual = Eigen::VectorXd::Zero(rows);

  int row = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const int n = graph.ResidualSize(id);
    const graticule_measurement measurement = {sizeof(graticule_measurement),
                                               static_cast<std::int32_t>(factor.measurement.size()),
                                               factor.measurement.data()};
    std::int32_t size = 0;
    graticule_error error;
    void* self = factor.type->table->create(
        &measurement, static_cast<std::int32_t>(factor.variables.size()), &size, &error);
    std::vector<Numbers> blocks;
    for (const VariableId v : factor.variables)
      blocks.emplace_back(values[v].begin(), values[v].end());
    const auto evaluate = [&] {
      std::vector<const double*> pointers;
      for (const Numbers& block : blocks) pointers.push_back(block.data());
      Eigen::VectorXd r(n);
      factor.type->table->evaluate(self, pointers.data(), r.data(), nullptr, &error);
      return r;
    };
    Eigen::MatrixXd information = Eigen::MatrixXd::Identity(n, n);
    const auto& noise = factor.noise.values;
    if (factor.noise.kind == NoiseKind::kSigma)
      for (int i = 0; i < n; ++i)
        information(i, i) =
            std::pow(noise[noise.size() == 1 ? 0 : static_cast<std::size_t>(i)], -2);
    if (factor.noise.kind == NoiseKind::kInformation)
      for (int i = 0, k = 0; i < n; ++i)
        for (int j = i; j < n; ++j, ++k)
          information(i, j) = information(j, i) = noise[static_cast<std::size_t>(k)];
    Eigen::MatrixXd s = information.llt().matrixU();
    const Eigen::VectorXd r = evaluate();
    double rho[3];
    EvaluateLoss(factor.loss, r.dot(information * r), rho);
    s *= std::sqrt(rho[1]);
    dense.residual.segment(row, n) = s * r;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const VariableId v = factor.variables[b];
      const VariableType& type = graph.TypeOf(v);
      if (dense.first[v] < 0) continue;
      for (int c = 0; c < type.TangentSize(); ++c) {
        constexpr double kStep = 1e-5;
        const Numbers original = blocks[b];
        Numbers delta(static_cast<std::size_t>(type.TangentSize()), 0.0);
        delta[static_cast<std::size_t>(c)] = kStep;
        type.Plus(original.data(), delta.data(), blocks[b].data());
        const Eigen::VectorXd plus = evaluate();
        delta[static_cast<std::size_t>(c)] = -kStep;
        type.Plus(original.data(), delta.data(), blocks[b].data());
        const Eigen::VectorXd minus = evaluate();
        blocks[b] = original;
        dense.jacobian.block(row, dense.first[v] + c, n, 1) = s * (plus - minus) / (2 * kStep);
      }
    }
    factor.type->table->destroy(self);
    row += n;
  }
  return dense;
}

}  // namespace graticule::testing
