#include "graticule/solver/check.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/evaluation.hpp"

namespace graticule {
namespace {

struct Work {
  std::vector<const double*> blocks;
  std::vector<std::vector<double>> analytic;
  std::vector<double*> jacobians;
  std::vector<double> residual, plus, minus, moved, delta;
};

// (r(x + h) - r(x - h)) / 2h along one tangent direction of block b.
bool Difference(const Evaluation& evaluation, FactorId id, const VariableType& type, std::size_t b,
                int direction, double h, Work* w, std::vector<double>* out) {
  const double* original = w->blocks[b];
  w->delta.assign(static_cast<std::size_t>(type.TangentSize()), 0.0);
  w->moved.resize(static_cast<std::size_t>(type.Size()));
  bool good = true;
  for (const double sign : {1.0, -1.0}) {
    w->delta[static_cast<std::size_t>(direction)] = sign * h;
    type.Plus(original, w->delta.data(), w->moved.data());
    w->blocks[b] = w->moved.data();
    good = good &&
           evaluation.Raw(id, w->blocks.data(), (sign > 0 ? w->plus : w->minus).data(), nullptr);
  }
  w->blocks[b] = original;
  for (std::size_t r = 0; good && r < out->size(); ++r)
    (*out)[r] = (w->plus[r] - w->minus[r]) / (2 * h);
  return good;
}

bool CheckFactor(const Evaluation& evaluation, FactorId id, const double* data, double tolerance,
                 Work* w, JacobianCheck* check) {
  const Graph& graph = evaluation.TheGraph();
  const FactorView factor = graph.FactorAt(id);
  const auto rows = static_cast<std::size_t>(graph.ResidualSize(id));
  evaluation.Blocks(id, data, &w->blocks);
  w->analytic.resize(factor.variables.size());
  w->jacobians.clear();
  for (std::size_t b = 0; b < factor.variables.size(); ++b) {
    w->analytic[b].resize(
        rows * static_cast<std::size_t>(graph.TypeOf(factor.variables[b]).TangentSize()));
    w->jacobians.push_back(w->analytic[b].data());
  }
  for (auto* vector : {&w->residual, &w->plus, &w->minus}) vector->resize(rows);
  if (!evaluation.Raw(id, w->blocks.data(), w->residual.data(), w->jacobians.data())) return false;

  bool right = true;
  std::vector<double> coarse(rows), fine(rows);
  for (std::size_t b = 0; b < factor.variables.size(); ++b) {
    const VariableType& type = graph.TypeOf(factor.variables[b]);
    const auto columns = static_cast<std::size_t>(type.TangentSize());
    double largest = 0;
    for (const double value : w->analytic[b]) largest = std::max(largest, std::abs(value));
    for (std::size_t c = 0; c < columns; ++c) {
      // Truncation h^4 after extrapolation against rounding eps/h: both near 1e-12 at 1e-3..1e-4.
      constexpr double kStep = 2e-4;
      if (!Difference(evaluation, id, type, b, static_cast<int>(c), kStep, w, &coarse) ||
          !Difference(evaluation, id, type, b, static_cast<int>(c), kStep / 2, w, &fine))
        return false;
      for (std::size_t r = 0; r < rows; ++r) {
        const double analytic = w->analytic[b][r * columns + c];
        const double extrapolated = (4 * fine[r] - coarse[r]) / 3;
        double numeric = extrapolated;
        double wrong = std::abs(analytic - numeric) / (1 + largest);
        if (wrong > tolerance && std::abs(analytic - fine[r]) / (1 + largest) < tolerance) {
          numeric = fine[r];
          wrong = std::abs(analytic - numeric) / (1 + largest);
        }
        if (!(wrong <= tolerance)) right = false;
        if (wrong > check->worst || std::isnan(wrong)) {
          check->worst = wrong;
          check->worst_factor = id;
          check->worst_row = static_cast<int>(r);
          const auto& roles = factor.type->schema.blocks;
          check->worst_block = roles[std::min(b, roles.size() - 1)].role;
          check->worst_field = type.tangent[c].name;
          check->analytic = analytic;
          check->numeric = numeric;
        }
      }
    }
  }
  if (!right) ++check->wrong;
  return true;
}

}  // namespace

std::vector<JacobianCheck> CheckJacobians(const Graph& graph, const Values& values,
                                          double tolerance) {
  graph.CheckLayout(values);
  const Evaluation evaluation(graph);
  std::vector<JacobianCheck> checks(graph.UsedFactorTypes().size());
  for (std::size_t t = 0; t < checks.size(); ++t) checks[t].type = graph.UsedFactorTypes()[t].name;
  Work work;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    JacobianCheck& check = checks[graph.FactorTypeIndex(id)];
    ++check.checked;
    if (CheckFactor(evaluation, id, values.Data().data(), tolerance, &work, &check)) continue;
    const std::string failure = evaluation.TakeFailure();
    if (check.failed++ == 0) check.failure = failure;
  }
  checks.erase(
      std::remove_if(checks.begin(), checks.end(), [](const auto& c) { return c.checked == 0; }),
      checks.end());
  return checks;
}

}  // namespace graticule
