#include "graticule/solver/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "graticule/solver/error.hpp"
#include "graticule/solver/gaussian.hpp"
#include "graticule/solver/guarded.hpp"
#include "graticule/solver/plugin.hpp"

namespace graticule {

std::string Describe(const Graph& graph, FactorId id) {
  const FactorView factor = graph.FactorAt(id);
  std::string text = "factor " + std::to_string(id) + " " + factor.type->name + " (";
  for (std::size_t i = 0; i < std::min<std::size_t>(factor.variables.size(), 4); ++i)
    text += (i ? " " : "") + graph.KeyOf(factor.variables[i]).ToString();
  return text + (factor.variables.size() > 4 ? " ...)" : ")");
}

namespace {

void RefuseUnknownTypes(const Graph& graph, FactorId first_factor, VariableId first_variable) {
  std::map<std::string, std::size_t> missing;
  for (FactorId id = first_factor; id < graph.FactorCount(); ++id) {
    const FactorType* type = graph.FactorAt(id).type;
    if (!type->Known()) ++missing[type->name];
  }
  if (!missing.empty()) {
    std::string text, folders;
    for (const std::string& folder : PluginPath())
      folders += (folders.empty() ? "" : ", ") + folder;
    for (const auto& [name, count] : missing)
      text += (text.empty() ? "" : "; ") + ("factor type " + name + " is not loaded; ") +
              std::to_string(count) + (count == 1 ? " factor needs it" : " factors need it");
    throw Error(text + " (plug-ins are looked for in " + folders + ")", ErrorKind::kMissingType);
  }
  for (VariableId id = first_variable; id < graph.VariableCount(); ++id)
    if (!graph.TypeOf(id).known)
      throw Error("variable type " + graph.TypeOf(id).name + " is not loaded; " +
                      graph.KeyOf(id).ToString() + " is one",
                  ErrorKind::kMissingType);
}

// Memory for one evaluation: on the stack while it is small, which it nearly always is.
template <class T, std::size_t kSmall>
class Scratch {
 public:
  explicit Scratch(std::size_t size) {
    if (size > kSmall) large_.resize(size);
    data_ = size > kSmall ? large_.data() : small_.data();
  }
  T* data() { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }

 private:
  std::array<T, kSmall> small_;
  std::vector<T> large_;
  T* data_;
};

bool AllFinite(const double* values, int count) {
  // x * 0 is 0 for finite x, nan otherwise: one test for all.
  double sums[4] = {};
  int i = 0;
  for (; i + 4 <= count; i += 4)
    for (int k = 0; k < 4; ++k) sums[k] += values[i + k] * 0.0;
  for (; i < count; ++i) sums[0] += values[i] * 0.0;
  return sums[0] + sums[1] + sums[2] + sums[3] == 0;
}

}  // namespace

Evaluation::Evaluation(const Graph& graph) : graph_(graph) { Grow(); }

void Evaluation::Grow(const std::vector<char>& left_out) {
  const Graph& graph = graph_;
  const std::size_t known = instances_.size();
  RefuseUnknownTypes(graph, static_cast<FactorId>(known), variables_);
  instances_.resize(graph.FactorCount());
  const std::size_t known_noises = whiteners_.size();
  std::vector<bool> whitened(graph.NoiseCount() - known_noises, false);
  whiteners_.resize(graph.NoiseCount());
  std::string why;
  for (auto id = static_cast<FactorId>(known); id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const graticule_measurement measurement = {sizeof(graticule_measurement),
                                               static_cast<std::int32_t>(factor.measurement.size()),
                                               factor.measurement.data()};
    std::int32_t residual_size = graph.ResidualSize(id);
    // Also for what is left out: a factor that comes later may share the noise.
    if (factor.noise_id >= known_noises && !whitened[factor.noise_id - known_noises]) {
      whiteners_[factor.noise_id] = Whitener(factor.noise, residual_size);
      whitened[factor.noise_id - known_noises] = true;
    }
    if (id < left_out.size() && left_out[id]) continue;
    Instance& instance = instances_[id];
    instance.table = factor.type->table;
    instance.self =
        CreateFactor(*factor.type->table, measurement,
                     static_cast<std::int32_t>(factor.variables.size()), &residual_size, &why);
    instance.noise = factor.noise_id;
    instance.is_gaussian = IsGaussian(instance.table);
    instance.is_plain = factor.type->HasTangentJacobians() ||
                        std::none_of(factor.variables.begin(), factor.variables.end(),
                                     [&](VariableId v) { return graph.TypeOf(v).manifold; });
    if (!instance.self || residual_size != graph.ResidualSize(id)) {
      if (why.empty()) why = "it changed its number of residuals";
      Destroy(known);
      whiteners_.resize(known_noises);
      throw Error(Describe(graph, id) + ": " + why);
    }
  }
  variables_ = static_cast<VariableId>(graph.VariableCount());
}

Evaluation::~Evaluation() { Destroy(0); }

void Evaluation::Destroy(std::size_t from) {
  for (std::size_t id = from; id < instances_.size(); ++id)
    if (instances_[id].self) instances_[id].table->destroy(instances_[id].self);
  instances_.resize(from);
}

bool Evaluation::Fail(FactorId id, const std::string& why) const {
  const std::lock_guard<std::mutex> lock(failure_mutex_);
  if (id < failed_) {  // the first of the graph, whichever thread meets it first
    failed_ = id;
    failure_ = Describe(graph_, id) + ": " + why;
  }
  return false;
}

std::string Evaluation::FirstFailure() const {
  const std::lock_guard<std::mutex> lock(failure_mutex_);
  return failure_;
}

std::string Evaluation::TakeFailure() const {
  const std::lock_guard<std::mutex> lock(failure_mutex_);
  failed_ = kNone;
  return std::exchange(failure_, "");
}

bool Evaluation::Whitened(FactorId id, const double* const* blocks, double* residual,
                          double** jacobians, const int* strides) const {
  return Evaluate(id, blocks, residual, jacobians, strides, true);
}

bool Evaluation::Raw(FactorId id, const double* const* blocks, double* residual,
                     double** jacobians) const {
  return Evaluate(id, blocks, residual, jacobians, nullptr, false);
}

bool Evaluation::EvaluateGaussian(FactorId id, const double* const* blocks, double* residual,
                                  double** jacobians, const int* strides, bool whiten) const {
  const Instance& instance = instances_[id];
  const FactorView factor = graph_.FactorAt(id);
  const std::size_t count = factor.variables.size();
  const int rows = graph_.ResidualSize(id);
  Scratch<int, 64> packed(count);
  for (std::size_t i = 0; i < count; ++i)
    packed[i] = strides ? strides[i] : graph_.TypeOf(factor.variables[i]).TangentSize();
  static_cast<const Gaussian*>(instance.self)
      ->Evaluate(graph_, factor.variables, blocks, residual, jacobians, packed.data());
  if (!AllFinite(residual, rows)) return Fail(id, "returned a residual that is not finite");
  const Whitener& whitener = whiteners_[instance.noise];
  if (whiten) whitener.Apply(residual, rows, 1, 1);
  for (std::size_t i = 0; jacobians && i < count; ++i) {
    if (!jacobians[i]) continue;
    const int size = graph_.TypeOf(factor.variables[i]).TangentSize();
    if (whiten) whitener.Apply(jacobians[i], rows, size, packed[i]);
    for (int r = 0; r < rows; ++r)
      std::fill(jacobians[i] + r * packed[i] + size, jacobians[i] + (r + 1) * packed[i], 0.0);
  }
  return true;
}

bool Evaluation::EvaluatePlain(FactorId id, const double* const* blocks, double* residual,
                               double** jacobians, bool whiten) const {
  const Instance& instance = instances_[id];
  const Whitener& whitener = whiteners_[instance.noise];
  const int rows = graph_.ResidualSize(id);
  graticule_error error;
  error.message[0] = 0;
  if (!instance.table->evaluate(instance.self, blocks, residual, jacobians, &error))
    return Fail(id, Reason(&error, "could not be evaluated"));
  if (!AllFinite(residual, rows)) return Fail(id, "returned a residual that is not finite");
  if (whiten) whitener.Apply(residual, rows, 1, 1);
  if (!jacobians) return true;
  for (const VariableId variable : graph_.VariablesOf(id)) {
    double* jacobian = *jacobians++;
    if (!jacobian) continue;
    const int size = graph_.TypeOf(variable).TangentSize();
    if (!AllFinite(jacobian, rows * size))
      return Fail(id, "returned a Jacobian that is not finite");
    if (whiten) whitener.Apply(jacobian, rows, size, size);
  }
  return true;
}

bool Evaluation::Evaluate(FactorId id, const double* const* blocks, double* residual,
                          double** jacobians, const int* strides, bool whiten) const try {
  const Instance& instance = instances_[id];
  if (instance.is_gaussian)
    return EvaluateGaussian(id, blocks, residual, jacobians, strides, whiten);
  if (!jacobians || (instance.is_plain && !strides))
    return EvaluatePlain(id, blocks, residual, jacobians, whiten);
  const FactorView factor = graph_.FactorAt(id);
  const int rows = graph_.ResidualSize(id);
  const std::size_t count = factor.variables.size();
  graticule_error error;
  error.message[0] = 0;

  // Where the factor's own matrix has the wanted shape it writes straight to its place.
  const bool in_tangent = factor.type->HasTangentJacobians();
  const auto is_direct = [&](std::size_t i, const VariableType& type) {
    return (in_tangent || !type.manifold) && (!strides || strides[i] == type.TangentSize());
  };
  Scratch<double*, 8> targets(count);
  std::size_t scratch_size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const VariableType& type = graph_.TypeOf(factor.variables[i]);
    targets[i] = jacobians[i];
    if (jacobians[i] && !is_direct(i, type))
      scratch_size += static_cast<std::size_t>(rows * type.Size());
  }
  Scratch<double, 256> scratch(scratch_size);
  std::size_t used = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const VariableType& type = graph_.TypeOf(factor.variables[i]);
    if (!jacobians[i] || is_direct(i, type)) continue;
    targets[i] = scratch.data() + used;
    used += static_cast<std::size_t>(rows * type.Size());
  }

  if (!instance.table->evaluate(instance.self, blocks, residual, targets.data(), &error))
    return Fail(id, Reason(&error, "could not be evaluated"));
  if (!AllFinite(residual, rows)) return Fail(id, "returned a residual that is not finite");

  const Whitener& whitener = whiteners_[factor.noise_id];
  for (std::size_t i = 0; i < count; ++i) {
    if (!jacobians[i]) continue;
    const VariableType& type = graph_.TypeOf(factor.variables[i]);
    const int tangent = type.TangentSize();
    const int size = in_tangent ? tangent : type.Size();
    const int stride = strides ? strides[i] : tangent;
    if (!AllFinite(targets[i], rows * size))
      return Fail(id, "returned a Jacobian that is not finite");
    if (targets[i] != jacobians[i] && (in_tangent || !type.manifold)) {
      for (int r = 0; r < rows; ++r)
        std::copy(targets[i] + r * size, targets[i] + (r + 1) * size, jacobians[i] + r * stride);
    } else if (targets[i] != jacobians[i]) {
      Scratch<double, 64> plus(static_cast<std::size_t>(size * tangent));
      type.PlusJacobian(blocks[i], plus.data());
      for (int r = 0; r < rows; ++r) {
        double* out = jacobians[i] + r * stride;
        std::fill(out, out + tangent, 0.0);
        for (int k = 0; k < size; ++k)
          for (int c = 0; c < tangent; ++c)
            out[c] += targets[i][r * size + k] * plus.data()[k * tangent + c];
      }
    }
    if (whiten) whitener.Apply(jacobians[i], rows, tangent, stride);
    for (int r = 0; r < rows; ++r)
      std::fill(jacobians[i] + r * stride + tangent, jacobians[i] + (r + 1) * stride, 0.0);
  }
  if (whiten) whitener.Apply(residual, rows, 1, 1);
  return true;
} catch (...) {
  return Fail(id, ThrownReason());
}

void Evaluation::Blocks(FactorId id, const double* data, std::vector<const double*>* blocks) const {
  blocks->clear();
  for (const VariableId variable : graph_.VariablesOf(id))
    blocks->push_back(data + graph_.Offset(variable));
}

double Evaluation::Chi2(FactorId id, const double* data) const {
  const Span<const VariableId> variables = graph_.VariablesOf(id);
  Scratch<const double*, 8> blocks(variables.size());
  for (std::size_t i = 0; i < variables.size(); ++i) blocks[i] = data + graph_.Offset(variables[i]);
  const int rows = graph_.ResidualSize(id);
  Scratch<double, 16> residual(static_cast<std::size_t>(rows));
  if (!Whitened(id, blocks.data(), residual.data(), nullptr, nullptr))
    return std::numeric_limits<double>::quiet_NaN();
  double chi2 = 0;
  for (int r = 0; r < rows; ++r)
    chi2 += residual[static_cast<std::size_t>(r)] * residual[static_cast<std::size_t>(r)];
  return chi2;
}

}  // namespace graticule
