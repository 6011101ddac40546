#include "python_factor.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "graticule/solver/rotation.hpp"

namespace graticule::python {
namespace {

// Central differences lose least with a step of about the cube root of double precision.
constexpr double kStep = 6e-6;

struct PythonFactorType {
  PythonFactorSpec spec;
  FactorSchema schema;
  std::vector<VariableType> blocks;  // of the schema, the last one for those that repeat
  graticule_factor_type_v1 table = {};

  const VariableType& BlockType(std::size_t i) const {
    return blocks[std::min(i, blocks.size() - 1)];
  }
};

// Never freed: graphs keep pointers to the tables.
std::unique_ptr<PythonFactorType>* Slots() {
  static auto* slots = new std::unique_ptr<PythonFactorType>[kMostPythonFactors];
  return slots;
}
std::size_t used_slots = 0;

void Say(graticule_error* error, const std::string& what) {
  if (error) std::snprintf(error->message, sizeof(error->message), "%s", what.c_str());
}

struct PythonFactor {
  const PythonFactorType* type;
  py::array_t<double> measurement;
  std::size_t block_count;

  int Size(std::size_t block) const { return type->BlockType(block).Size(); }
  int TangentSize(std::size_t block) const { return type->BlockType(block).TangentSize(); }
  py::ssize_t Residuals() const { return static_cast<py::ssize_t>(type->schema.residual.size()); }

  // Blocks are copied: what the solver lends is gone after the call.
  py::tuple Arguments(const double* const* blocks) const {
    py::tuple arguments(block_count + 1);
    for (std::size_t b = 0; b < block_count; ++b)
      arguments[b] = py::array_t<double>(Size(b), blocks[b]);
    arguments[block_count] = measurement;
    return arguments;
  }

  void Residual(const double* const* blocks, double* residual) const {
    const py::object result = type->spec.residual(*Arguments(blocks));
    const auto numbers = Dense<double>::ensure(result);
    if (!numbers) throw py::error_already_set();
    ExpectShape(numbers, {Residuals()}, "the residual");
    std::copy(numbers.data(), numbers.data() + numbers.size(), residual);
  }

  void GivenJacobians(const double* const* blocks, double** jacobians) const {
    const py::sequence result = type->spec.jacobians(*Arguments(blocks));
    if (result.size() != block_count)
      throw Error("the Jacobians: expected " + std::to_string(block_count) + " matrices, found " +
                  std::to_string(result.size()));
    for (std::size_t b = 0; b < block_count; ++b) {
      if (!jacobians[b]) continue;
      const auto matrix = Dense<double>::ensure(py::object(result[b]));
      if (!matrix) throw py::error_already_set();
      ExpectShape(matrix,
                  {Residuals(), type->spec.has_tangent_jacobians ? TangentSize(b) : Size(b)},
                  "a Jacobian");
      std::copy(matrix.data(), matrix.data() + matrix.size(), jacobians[b]);
    }
  }

  void NumericJacobians(const double* const* blocks, double** jacobians) const {
    std::vector<const double*> at(blocks, blocks + block_count);
    const auto rows = static_cast<std::size_t>(Residuals());
    std::vector<double> moved, delta, ahead(rows), behind(rows);
    for (std::size_t b = 0; b < block_count; ++b) {
      if (!jacobians[b]) continue;
      const auto columns = static_cast<std::size_t>(TangentSize(b));
      moved.resize(static_cast<std::size_t>(Size(b)));
      delta.assign(columns, 0);
      at[b] = moved.data();
      for (std::size_t c = 0; c < columns; ++c) {
        const double step = kStep * std::max(1.0, LargestOf(b, blocks));
        for (const int sign : {1, -1}) {
          delta[c] = sign * step;
          type->BlockType(b).Plus(blocks[b], delta.data(), moved.data());
          Residual(at.data(), sign > 0 ? ahead.data() : behind.data());
        }
        delta[c] = 0;
        for (std::size_t r = 0; r < rows; ++r) {
          double change = ahead[r] - behind[r];
          // An angle may wrap between the two.
          if (type->schema.residual[r].unit == "rad") change = WrapAngle(change);
          jacobians[b][r * columns + c] = change / (2 * step);
        }
      }
      at[b] = blocks[b];
    }
  }

  // Steps in vectors grow with what they are added to; manifolds have units.
  double LargestOf(std::size_t block, const double* const* blocks) const {
    if (type->BlockType(block).manifold) return 1;
    double largest = 0;
    for (int i = 0; i < Size(block); ++i) largest = std::max(largest, std::abs(blocks[block][i]));
    return largest;
  }
};

// Runs what calls Python.  Nothing is thrown: a failure has its text in `error`.
template <class Work>
bool Guarded(graticule_error* error, const Work& work) {
  const py::gil_scoped_acquire acquired;
  try {
    work();
    return true;
  } catch (py::error_already_set& thrown) {
    Say(error, thrown.what());
    // Ctrl-C in the middle of a function is the solve's to answer.  Last: any Python that runs
    // after this would be interrupted instead.
    if (thrown.matches(PyExc_KeyboardInterrupt)) PyErr_SetInterrupt();
  } catch (const std::exception& exception) {
    Say(error, exception.what());
  }
  return false;
}

void* Create(const PythonFactorType& type, const graticule_measurement* measurement,
             int32_t block_count, int32_t* residual_count, graticule_error* error) {
  PythonFactor* made = nullptr;
  Guarded(error, [&] {
    made = new PythonFactor{&type, Frozen(measurement->values, {measurement->value_count}),
                            static_cast<std::size_t>(block_count)};
    *residual_count = static_cast<int32_t>(made->Residuals());
  });
  return made;
}

int32_t Evaluate(const void* self, const double* const* blocks, double* residual,
                 double** jacobians, graticule_error* error) {
  return Guarded(error, [&] {
    const auto& factor = *static_cast<const PythonFactor*>(self);
    factor.Residual(blocks, residual);
    if (!jacobians) return;
    if (factor.type->spec.jacobians.is_none()) {
      factor.NumericJacobians(blocks, jacobians);
    } else {
      factor.GivenJacobians(blocks, jacobians);
    }
  });
}

void Destroy(void* self) {
  const py::gil_scoped_acquire acquired;
  delete static_cast<PythonFactor*>(self);
}

// A table's functions are told nothing but the measurement: of each slot one that knows which it
// is.
template <std::size_t kSlot>
void* CreateOfSlot(const graticule_measurement* measurement, int32_t block_count,
                   int32_t* residual_count, graticule_error* error) {
  return Create(*Slots()[kSlot], measurement, block_count, residual_count, error);
}

using CreateFunction = decltype(&CreateOfSlot<0>);

template <std::size_t... kSlots>
CreateFunction CreateOf(std::size_t slot, std::index_sequence<kSlots...>) {
  static constexpr CreateFunction kFunctions[] = {&CreateOfSlot<kSlots>...};
  return kFunctions[slot];
}

}  // namespace

void AddPythonFactor(PythonFactorSpec spec, Registry* types) {
  if (used_slots == kMostPythonFactors)
    throw Error("there are " + std::to_string(kMostPythonFactors) +
                    " Python factors in this process, and no room for another: make the next "
                    "one with functions that look up what they do",
                ErrorKind::kUsage);
  auto type = std::make_unique<PythonFactorType>();
  type->schema = ParseFactorSchema(spec.schema);
  if (type->schema.repeats_last_residual || type->schema.blocks.empty() ||
      (type->schema.residual.empty()))
    throw Error(
        "schema of " + spec.name + ": a Python factor has blocks, and a residual of a known size",
        ErrorKind::kUsage);
  for (const Block& block : type->schema.blocks) {
    auto found = types->FindVariableType(block.variable_type);
    if (!found || !found->known)
      throw Error("schema of " + spec.name + ": there is no variable type " + block.variable_type,
                  ErrorKind::kMissingType);
    type->blocks.push_back(std::move(*found));
  }
  // Differences are taken along the tangent.
  if (spec.jacobians.is_none()) spec.has_tangent_jacobians = true;
  type->spec = std::move(spec);
  type->table = {sizeof(graticule_factor_type_v1),
                 (type->spec.is_relative ? GRATICULE_FACTOR_RELATIVE : 0u) |
                     (type->spec.has_tangent_jacobians ? GRATICULE_FACTOR_TANGENT_JACOBIANS : 0u),
                 type->spec.name.c_str(),
                 type->spec.schema.c_str(),
                 type->spec.summary.c_str(),
                 CreateOf(used_slots, std::make_index_sequence<kMostPythonFactors>()),
                 Evaluate,
                 Destroy};
  types->Add(MakeFactorType(type->table, "python"));
  Slots()[used_slots++] = std::move(type);
}

}  // namespace graticule::python
