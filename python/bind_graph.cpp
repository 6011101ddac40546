#include "bind.hpp"
#include "bulk.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

VariableId Checked(const Graph& graph, VariableId id) {
  if (id >= graph.VariableCount())
    throw Error("there is no variable " + std::to_string(id) + ": the graph has " +
                    std::to_string(graph.VariableCount()),
                ErrorKind::kUsage);
  return id;
}

FactorId CheckedFactor(const Graph& graph, FactorId id) {
  if (id >= graph.FactorCount())
    throw Error("there is no factor " + std::to_string(id) + ": the graph has " +
                    std::to_string(graph.FactorCount()),
                ErrorKind::kUsage);
  return id;
}

void BindValues(py::module_& m) {
  py::class_<Values, std::shared_ptr<Values>>(
      m, "Values",
      "A number for every field of every variable of a graph, in one buffer.  `values[\"pose:3\"]` "
      "and `values.data` are arrays of that very buffer: writing to them changes the values.")
      .def_property_readonly(
          "data",
          [](py::object self) {
            auto& values = self.cast<Values&>();
            return View(values.MutableData().data(),
                        {static_cast<py::ssize_t>(values.Data().size())}, self, true);
          },
          "All numbers, in the graph's order: variables as they were added.  Not a copy.")
      .def("__len__", &Values::Count)
      .def("__contains__", &Values::Has, "key"_a)
      .def(
          "__getitem__",
          [](py::object self, const Key& key) {
            const Span<const double> fields = self.cast<Values&>().At(key);
            return View(fields.data(), {static_cast<py::ssize_t>(fields.size())}, self, true);
          },
          "key"_a, "The fields of one variable.  Not a copy.")
      .def("keys", &KeysOf, "Of all variables, in the graph's order.")
      .def("array", &ArrayOfFamily, "family"_a,
           "(n, size) fields of a family's variables, in the order of their numbers.  A copy.")
      .def("numbers", &NumbersOfFamily, "family"_a,
           "(n,) the numbers of a family's keys, rising: what the rows of `array` are.")
      .def("__copy__", [](const Values& values) { return Values(values); })
      .def(
          "__deepcopy__", [](const Values& values, const py::dict&) { return Values(values); },
          "memo"_a)
      .def("__repr__", [](const Values& values) {
        return "Values(of " + std::to_string(values.Count()) + " variables, " +
               std::to_string(values.Data().size()) + " numbers)";
      });
}

void BindBuilding(py::class_<Graph, std::shared_ptr<Graph>>& graph) {
  graph
      .def(py::init([](const Registry* types) { return Graph(types ? *types : Builtins()); }),
           "types"_a = nullptr, "An empty graph over these types; None: the built-in ones.")
      .def(
          "add",
          [](Graph& self, const Key& key, std::string_view type, const std::vector<double>& value,
             bool fixed) { return self.Add(key, type, value, fixed); },
          "key"_a, "type"_a, "value"_a, "fixed"_a = false,
          "A variable with its initial value, laid out as its type says.  A fixed one is held "
          "there.  Returns its id.")
      .def(
          "add", [](Graph& self, const Factor& factor) { return self.Add(factor); }, "factor"_a,
          "A factor.  Returns its id.")
      .def("add_variables", &AddVariables, "family"_a, "type"_a, "values"_a,
           "numbers"_a = py::none(), "fixed"_a = py::none(),
           "Many variables of one family.  values: (n, size), a row a variable, as the type lays "
           "it out.  numbers: (n,) of the keys; None: counted on from the family's last.  fixed: "
           "None, or (n,) truth values.  Returns (n,) ids.  Where a row is refused those before "
           "it have been added.")
      .def("add_factors", &AddFactors, "type"_a, "variables"_a, "measurements"_a,
           "noise"_a = py::none(), "loss"_a = Loss(), "source"_a = "",
           "Many factors of one type.  variables: (n, blocks) ids, as `add_variables` and `ids` "
           "return them.  measurements: (n, size) as the schema lays them out.  noise: one for "
           "all, or an array with a row a factor: (n, r) standard deviations, or (n, r, r) "
           "information matrices; None: unit.  Returns (n,) ids.  Where a row is refused those "
           "before it have been added.")
      .def("reserve", &Graph::Reserve, "variables"_a, "factors"_a, "Memory for so many.")
      .def("set_values", &Graph::SetValues, "values"_a,
           "Replaces the graph's own values by those of any of its keys.")
      .def(
          "set_value",
          [](Graph& self, const Key& key, const std::vector<double>& value) {
            self.SetValue(self.IdOf(key), value);
          },
          "key"_a, "value"_a, "Replaces one variable's own value.")
      .def(
          "set_fixed",
          [](Graph& self, const Key& key, bool fixed) { self.SetFixed(self.IdOf(key), fixed); },
          "key"_a, "fixed"_a, "Whether a variable is held at its value.")
      .def(
          "set_loss",
          [](Graph& self, FactorId id, const Loss& loss) {
            self.SetLoss(CheckedFactor(self, id), loss);
          },
          "factor"_a, "loss"_a, "Replaces one factor's loss.")
      .def("set_losses", &Graph::SetLosses, "loss"_a, "Replaces every factor's loss.")
      .def(
          "set_source",
          [](Graph& self, FactorId id, std::string_view source) {
            self.SetSource(CheckedFactor(self, id), source);
          },
          "factor"_a, "source"_a, "Replaces one factor's source.");
}

void BindLooking(py::class_<Graph, std::shared_ptr<Graph>>& graph) {
  graph.def_property_readonly("variable_count", &Graph::VariableCount, "Variables.")
      .def_property_readonly("factor_count", &Graph::FactorCount, "Factors.")
      .def_property_readonly(
          "types", [](const Graph& self) { return Registry(self.Types()); },
          "The registry that it was made with: a copy.")
      .def(
          "keys", [](const Graph& self) { return KeysOf(self.InitialValues()); },
          "Of all variables, by id.")
      .def(
          "key_of", [](const Graph& self, VariableId id) { return self.KeyOf(Checked(self, id)); },
          "variable"_a, "The key of an id.")
      .def("id_of", &Graph::IdOf, "key"_a, "The id of a key: its position, from 0.")
      .def("ids", &IdsOf, "family"_a, "numbers"_a,
           "Ids of a family's variables: an array like `numbers`.")
      .def(
          "__contains__",
          [](const Graph& self, const Key& key) { return self.Find(key) != Layout::kNone; },
          "key"_a)
      .def(
          "type_of", [](const Graph& self, const Key& key) { return self.TypeOf(self.IdOf(key)); },
          "key"_a, "A variable's type.")
      .def(
          "is_fixed",
          [](const Graph& self, const Key& key) { return self.IsFixed(self.IdOf(key)); }, "key"_a,
          "Whether a variable is held at its value.")
      .def(
          "value_of",
          [](const Graph& self, const Key& key) {
            const Span<const double> value = self.ValueOf(self.IdOf(key));
            return std::vector<double>(value.begin(), value.end());
          },
          "key"_a, "(size,) a variable's own value.  A copy.")
      .def("initial_values", &Graph::InitialValues, "The graph's own values.  A copy.")
      .def(
          "factor",
          [](const Graph& self, FactorId id) { return self.FactorRecord(CheckedFactor(self, id)); },
          "id"_a, "A copy of a factor.")
      .def("factors", &FactorIds, "type"_a = py::none(), "source"_a = py::none(),
           "(n,) ids of the factors of a type, a source, or both.")
      .def("variables_of", &VariablesOfFactors, "factors"_a,
           "(n, blocks) ids of the variables of factors of one type.")
      .def("measurements_of", &MeasurementsOfFactors, "factors"_a,
           "(n, size) what factors of one type measured.")
      .def(
          "slice",
          [](const Graph& self, const std::vector<Key>& keep) {
            return self.Slice(std::set<Key>(keep.begin(), keep.end()));
          },
          "keep"_a, "The variables in `keep`, and every factor that touches no other.")
      .def("__copy__", [](const Graph& self) { return Graph(self); })
      .def(
          "__deepcopy__", [](const Graph& self, const py::dict&) { return Graph(self); }, "memo"_a)
      .def("__repr__", [](const Graph& self) {
        return "Graph(" + std::to_string(self.VariableCount()) + " variables, " +
               std::to_string(self.FactorCount()) + " factors)";
      });
}

}  // namespace

void BindGraph(py::module_& module) {
  BindValues(module);
  py::class_<Graph, std::shared_ptr<Graph>> graph(
      module, "Graph",
      "A factor graph: variables with a value each, and factors between them.  Data, not code.  "
      "Every add checks what it is given, and throws without having changed the graph.");
  BindBuilding(graph);
  BindLooking(graph);
}

}  // namespace graticule::python
