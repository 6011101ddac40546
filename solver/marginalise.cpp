#include "graticule/solver/marginalise.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// A column that is less than this share of what it was is rounding: nothing determines it.
constexpr double kRounding = 1e-13;

// Some equations a d = c: rows of `columns` numbers, the last of which is c.
struct Equations {
  std::vector<VariableId> variables;  // sorted
  int columns = 1;
  std::vector<double> numbers;

  int Rows() const { return static_cast<int>(numbers.size()) / columns; }
};

class Elimination {
 public:
  Elimination(const Evaluation& evaluation, const double* data,
              const std::function<bool(VariableId)>& is_constant)
      : evaluation_(evaluation),
        graph_(evaluation.TheGraph()),
        data_(data),
        is_constant_(is_constant) {}

  void Add(FactorId id);
  void Add(const GaussianTerm& term);
  void Eliminate(const std::vector<VariableId>& leaving);
  std::vector<GaussianTerm> Take();

 private:
  int TangentSize(VariableId id) const { return graph_.TypeOf(id).TangentSize(); }
  void Keep(Equations&& equations);
  std::size_t CountNeighbours(VariableId id) const;
  Equations Combine(const std::vector<int>& which, const std::vector<VariableId>& order) const;

  const Evaluation& evaluation_;
  const Graph& graph_;
  const double* data_;
  const std::function<bool(VariableId)>& is_constant_;
  std::map<int, Equations> equations_;
  int next_ = 0;
  std::map<VariableId, std::set<int>> of_;  // which equations have it
};

void Elimination::Add(FactorId id) {
  const Span<const VariableId> variables = graph_.VariablesOf(id);
  const int rows = graph_.ResidualSize(id);
  std::size_t needed = 0;
  for (const VariableId v : variables) needed += static_cast<std::size_t>(rows * TangentSize(v));
  std::vector<double> jacobian(needed), residual(static_cast<std::size_t>(rows));
  std::vector<double*> jacobians;
  std::vector<std::size_t> order;  // of the blocks that are not constant
  double* next = jacobian.data();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const bool is_constant = is_constant_(variables[i]);
    if (!is_constant) order.push_back(i);
    jacobians.push_back(is_constant ? nullptr : next);
    next += rows * TangentSize(variables[i]);
  }
  std::vector<const double*> blocks;
  evaluation_.Blocks(id, data_, &blocks);
  if (!evaluation_.Whitened(id, blocks.data(), residual.data(), jacobians.data(), nullptr))
    throw Error(evaluation_.TakeFailure(), ErrorKind::kOther);
  double chi2 = 0, rho[3];
  for (const double r : residual) chi2 += r * r;
  EvaluateLoss(graph_.LossOf(id), chi2, rho);
  const double weight = std::sqrt(std::max(rho[1], 0.0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return variables[a] < variables[b]; });
  Equations equations;
  for (const std::size_t i : order) {
    equations.variables.push_back(variables[i]);
    equations.columns += TangentSize(variables[i]);
  }
  for (int row = 0; row < rows; ++row) {
    for (const std::size_t i : order) {
      const int size = TangentSize(variables[i]);
      for (int k = 0; k < size; ++k)
        equations.numbers.push_back(weight * jacobians[i][row * size + k]);
    }
    equations.numbers.push_back(-weight * residual[static_cast<std::size_t>(row)]);
  }
  Keep(std::move(equations));
}

void Elimination::Add(const GaussianTerm& term) {
  Equations equations;
  for (const VariableId v : term.variables)
    if (!is_constant_(v)) {
      equations.variables.push_back(v);
      equations.columns += TangentSize(v);
    }
  const int rows = term.gaussian.rows, columns = equations.columns;
  equations.numbers.resize(static_cast<std::size_t>(rows * columns));
  std::vector<const double*> blocks;
  std::vector<double*> jacobians;
  double* next = equations.numbers.data();
  for (const VariableId v : term.variables) {
    blocks.push_back(data_ + graph_.Offset(v));
    jacobians.push_back(is_constant_(v) ? nullptr : next);
    if (jacobians.back()) next += TangentSize(v);
  }
  std::vector<double> residual(static_cast<std::size_t>(rows));
  const std::vector<int> strides(term.variables.size(), columns);
  term.gaussian.Evaluate(graph_, term.variables, blocks.data(), residual.data(), jacobians.data(),
                         strides.data());
  for (int row = 0; row < rows; ++row)
    equations.numbers[static_cast<std::size_t>((row + 1) * columns - 1)] =
        -residual[static_cast<std::size_t>(row)];
  Keep(std::move(equations));
}

void Elimination::Keep(Equations&& equations) {
  if (equations.variables.empty() || equations.numbers.empty()) return;
  for (const VariableId v : equations.variables) of_[v].insert(next_);
  equations_.emplace(next_++, std::move(equations));
}

std::size_t Elimination::CountNeighbours(VariableId id) const {
  std::set<VariableId> neighbours;
  const auto of = of_.find(id);
  if (of == of_.end()) return 0;
  for (const int which : of->second) {
    const Equations& equations = equations_.at(which);
    neighbours.insert(equations.variables.begin(), equations.variables.end());
  }
  return neighbours.size();
}

// All rows of some equations, with columns in this order.
Equations Elimination::Combine(const std::vector<int>& which,
                               const std::vector<VariableId>& order) const {
  Equations all;
  all.variables = order;
  std::map<VariableId, int> first;
  all.columns = 0;
  for (const VariableId v : order) {
    first[v] = all.columns;
    all.columns += TangentSize(v);
  }
  ++all.columns;
  for (const int i : which) {
    const Equations& from = equations_.at(i);
    const std::size_t begin = all.numbers.size();
    all.numbers.resize(begin + static_cast<std::size_t>(from.Rows() * all.columns), 0.0);
    for (int row = 0; row < from.Rows(); ++row) {
      const double* source = from.numbers.data() + row * from.columns;
      double* target = all.numbers.data() + begin + row * all.columns;
      for (const VariableId v : from.variables) {
        std::copy_n(source, TangentSize(v), target + first[v]);
        source += TangentSize(v);
      }
      target[all.columns - 1] = *source;
    }
  }
  return all;
}

// A row of equations in echelon form.
struct Step {
  int row, begin;  // where it stands, and its first column that is not zero
};

// Brings equations to echelon form, in place; the steps come in order.  Rows that say nothing about
// any variable are not among them.
std::vector<Step> Triangularise(Equations* equations) {
  const int columns = equations->columns, unknowns = columns - 1;
  double* numbers = equations->numbers.data();
  std::vector<double> norm(static_cast<std::size_t>(unknowns), 0.0);
  for (int row = 0; row < equations->Rows(); ++row)
    for (int c = 0; c < unknowns; ++c)
      norm[static_cast<std::size_t>(c)] += numbers[row * columns + c] * numbers[row * columns + c];
  std::vector<std::vector<int>> waiting(static_cast<std::size_t>(columns));
  const auto wait = [&](int row, int from) {
    while (from < unknowns && numbers[row * columns + from] == 0) ++from;
    waiting[static_cast<std::size_t>(from)].push_back(row);
  };
  for (int row = 0; row < equations->Rows(); ++row) wait(row, 0);
  std::vector<Step> steps;
  std::vector<double> sum;
  for (int c = 0; c < unknowns; ++c) {
    const std::vector<int>& rows = waiting[static_cast<std::size_t>(c)];
    double squared = 0;
    for (const int row : rows) squared += numbers[row * columns + c] * numbers[row * columns + c];
    if (squared <= kRounding * kRounding * norm[static_cast<std::size_t>(c)]) {
      for (const int row : rows) {
        numbers[row * columns + c] = 0;
        wait(row, c + 1);
      }
      continue;
    }
    steps.push_back({rows[0], c});
    if (rows.size() == 1) continue;
    // A reflection that takes the column to its first row; v is what the column becomes there.
    double* head = numbers + rows[0] * columns;
    const double length = std::sqrt(squared), alpha = head[c] > 0 ? -length : length;
    head[c] -= alpha;
    const double scale = -1 / (alpha * head[c]);  // 2 / v'v
    sum.assign(static_cast<std::size_t>(columns - c - 1), 0.0);
    for (const int row : rows) {
      const double* values = numbers + row * columns;
      for (int k = c + 1; k < columns; ++k)
        sum[static_cast<std::size_t>(k - c - 1)] += values[c] * values[k];
    }
    for (const int row : rows) {
      double* values = numbers + row * columns;
      const double factor = scale * values[c];
      for (int k = c + 1; k < columns; ++k)
        values[k] -= factor * sum[static_cast<std::size_t>(k - c - 1)];
      values[c] = 0;
    }
    head[c] = alpha;
    for (std::size_t i = 1; i < rows.size(); ++i) wait(rows[i], c + 1);
  }
  return steps;
}

void Elimination::Eliminate(const std::vector<VariableId>& leaving) {
  std::set<std::pair<std::size_t, VariableId>> queue;
  std::map<VariableId, std::size_t> degree;
  for (const VariableId id : leaving) {
    degree[id] = CountNeighbours(id);
    queue.emplace(degree[id], id);
  }
  while (!queue.empty()) {
    const VariableId id = queue.begin()->second;
    queue.erase(queue.begin());
    degree.erase(id);
    const auto of = of_.find(id);
    if (of == of_.end()) continue;
    const std::vector<int> which(of->second.begin(), of->second.end());
    std::set<VariableId> neighbours;
    for (const int i : which) {
      const Equations& equations = equations_.at(i);
      neighbours.insert(equations.variables.begin(), equations.variables.end());
    }
    neighbours.erase(id);
    std::vector<VariableId> order = {id};
    order.insert(order.end(), neighbours.begin(), neighbours.end());
    Equations all = Combine(which, order);
    const std::vector<Step> steps = Triangularise(&all);
    for (const int i : which) {
      for (const VariableId v : equations_.at(i).variables) of_[v].erase(i);
      equations_.erase(i);
    }
    // Rows that begin with the leaving variable say where it is; the others are about the rest.
    const int size = TangentSize(id);
    Equations rest;
    rest.variables.assign(neighbours.begin(), neighbours.end());
    rest.columns = all.columns - size;
    rest.numbers.reserve(steps.size() * static_cast<std::size_t>(rest.columns));
    for (const Step& step : steps) {
      if (step.begin < size) continue;
      const double* from = all.numbers.data() + step.row * all.columns;
      rest.numbers.insert(rest.numbers.end(), from + size, from + all.columns);
    }
    Keep(std::move(rest));
    for (const VariableId v : neighbours) {
      const auto it = degree.find(v);
      if (it == degree.end()) continue;
      queue.erase({it->second, v});
      it->second = CountNeighbours(v);
      queue.emplace(it->second, v);
    }
  }
}

std::vector<GaussianTerm> Elimination::Take() {
  std::vector<GaussianTerm> terms;
  for (auto& [number, equations] : equations_) {
    const std::vector<Step> steps = Triangularise(&equations);
    if (steps.empty()) continue;
    GaussianTerm term;
    term.variables = equations.variables;
    term.gaussian.rows = static_cast<int>(steps.size());
    term.gaussian.columns = equations.columns - 1;
    for (const VariableId v : equations.variables)
      term.gaussian.point.insert(term.gaussian.point.end(), data_ + graph_.Offset(v),
                                 data_ + graph_.Offset(v) + graph_.TypeOf(v).Size());
    term.gaussian.r.reserve(steps.size() * static_cast<std::size_t>(term.gaussian.columns));
    for (const Step& step : steps) {
      const double* from = equations.numbers.data() + step.row * equations.columns;
      term.gaussian.r.insert(term.gaussian.r.end(), from, from + term.gaussian.columns);
      term.gaussian.b.push_back(from[term.gaussian.columns]);
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

}  // namespace

std::vector<GaussianTerm> MarginaliseOut(const std::vector<VariableId>& leaving,
                                         const std::vector<FactorId>& factors,
                                         const std::vector<const GaussianTerm*>& terms,
                                         const Evaluation& evaluation, const double* data,
                                         const std::function<bool(VariableId)>& is_constant) {
  Elimination elimination(evaluation, data, is_constant);
  for (const GaussianTerm* term : terms) elimination.Add(*term);
  for (const FactorId id : factors) elimination.Add(id);
  elimination.Eliminate(leaving);
  return elimination.Take();
}

}  // namespace graticule
