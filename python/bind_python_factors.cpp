#include "bind.hpp"
#include "python_factor.hpp"

namespace graticule::python {

void BindPythonFactors(py::module_& module) {
  using namespace py::literals;
  module.def(
      "add_python_factor",
      [](Registry& types, const std::string& name, const std::string& schema,
         const py::function& residual, const py::object& jacobians, const std::string& summary,
         bool relative, bool tangent_jacobians) {
        AddPythonFactor({name, schema, summary, residual, jacobians, relative, tangent_jacobians},
                        &types);
      },
      "types"_a, "name"_a, "schema"_a, "residual"_a, "jacobians"_a = py::none(), "summary"_a = "",
      "relative"_a = false, "tangent_jacobians"_a = false,
      "Adds a factor type whose residual is a Python function: for trying things out.  It is "
      "slow, some microseconds a call, and one call runs at a time, whatever `threads` is.\n\n"
      "schema: as in C++, \"a:se2/1 b:se2/1 | x:m y:m yaw:rad\".  `residual(*blocks, "
      "measurement)` gets an array a block, laid out as its type says, and the measurement, and "
      "returns the raw residual, (residuals,), in the schema's units.  `jacobians`, with the same "
      "arguments, returns a matrix a block: (residuals, size), or with `tangent_jacobians` "
      "(residuals, tangent size); None: central differences along the tangent.  `relative`: the "
      "residual depends on relative placement only.\n\n"
      "What a function throws ends the solve as a factor that cannot be evaluated.  256 such types "
      "a process.");
}

}  // namespace graticule::python
