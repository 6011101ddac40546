#pragma once

#include <string>

#include "arrays.hpp"
#include "graticule/solver/registry.hpp"

namespace graticule::python {

/// A factor whose residual is a Python function: for trying things out.
struct PythonFactorSpec {
  std::string name, schema, summary;
  py::function residual;
  py::object jacobians;  ///< a function, or None: central differences along the tangent
  bool is_relative = false;
  bool has_tangent_jacobians = false;
};

/// How many kinds of such factors a process may have: a type's table has no place for a function
/// but its own, and tables live as long as the process.
constexpr std::size_t kMostPythonFactors = 256;

/// Adds the factor type to the registry.  Throws Error: a schema that is wrong or names types that
/// are not there, a residual that repeats, a name already taken, too many.
void AddPythonFactor(PythonFactorSpec spec, Registry* types);

}  // namespace graticule::python
