#pragma once

// Many variables and factors at once: arrays in, arrays out, no loop in Python.

#include "arrays.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule::python {

using Ids = py::array_t<std::uint32_t>;

Ids AddVariables(Graph& graph, const std::string& family, const std::string& type,
                 const Dense<double>& values, const std::optional<Integers>& numbers,
                 const std::optional<Dense<bool>>& fixed);
/// `noise`: None, a Noise or what stands for one, or an array with a row a factor.
Ids AddFactors(Graph& graph, const std::string& type, const Integers& variables,
               const Dense<double>& measurements, const py::object& noise, const Loss& loss,
               const std::string& source);

std::vector<Key> KeysOf(const Values& values);
py::array_t<double> ArrayOfFamily(const Values& values, const std::string& family);
py::array_t<std::uint64_t> NumbersOfFamily(const Values& values, const std::string& family);

Ids IdsOf(const Graph& graph, const std::string& family, const Integers& numbers);
Ids FactorIds(const Graph& graph, const std::optional<std::string>& type,
              const std::optional<std::string>& source);
Ids VariablesOfFactors(const Graph& graph, const Integers& factors);
py::array_t<double> MeasurementsOfFactors(const Graph& graph, const Integers& factors);

}  // namespace graticule::python
