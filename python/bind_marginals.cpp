#include "bind.hpp"
#include "graticule/solver/check.hpp"
#include "graticule/solver/diagnose.hpp"
#include "graticule/solver/marginals.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

// Marginals, and what says how large their blocks are.
struct SizedMarginals {
  Marginals marginals;
  std::map<Key, py::ssize_t> sizes;

  py::array_t<double> Covariance(const Key& a, const Key& b) const {
    const std::vector<double>& block = marginals.Covariance(a, b);
    return Frozen(block.data(), {sizes.at(a), sizes.at(b)});
  }
};

std::variant<SizedMarginals, Diagnosis> Compute(const Graph& graph, const Values* values,
                                                const std::vector<Key>& keys, bool joint) {
  auto result = [&] {
    const py::gil_scoped_release released;
    return ComputeMarginals(graph, values ? *values : graph.InitialValues(), keys, joint);
  }();
  if (auto* diagnosis = std::get_if<Diagnosis>(&result)) return std::move(*diagnosis);
  SizedMarginals sized{std::get<Marginals>(std::move(result)), {}};
  for (const Key& key : keys) sized.sizes[key] = graph.TypeOf(graph.IdOf(key)).TangentSize();
  return sized;
}

void BindDiagnosis(py::module_& m) {
  Record<Diagnosis::Loose>(m, "LooseVariable", "A variable that may move.")
      .Field("key", &Diagnosis::Loose::key, "Whose.")
      .Field("fields", &Diagnosis::Loose::fields, "Of its tangent: \"x\", \"yaw\".")
      .Field("share", &Diagnosis::Loose::share, "Of the free directions' squared length; all: 1.");
  Record<Diagnosis>(m, "Diagnosis",
                    "Why a problem has no single answer: which keys may move, along which "
                    "fields, without any factor minding.")
      .Result("free_directions", &Diagnosis::free_directions, "Independent ones.")
      .Result("at_least", &Diagnosis::at_least, "There may be more.")
      .Result("loose", &Diagnosis::loose, "Largest share first.")
      .Result("summary", &Diagnosis::summary, "One line.");
  m.def(
      "diagnose",
      [](const Graph& graph, const Values* values, const std::vector<Key>& anchors) {
        std::vector<VariableId> held;
        for (const Key& key : anchors) held.push_back(graph.IdOf(key));
        const py::gil_scoped_release released;
        return Diagnose(graph, values ? *values : graph.InitialValues(), held);
      },
      "graph"_a, "values"_a = nullptr, "anchors"_a = std::vector<Key>(),
      "Looks for directions that no factor minds, at these values (None: the graph's own), with "
      "`anchors` held.  free_directions 0: the problem is well posed.");
  Record<Structure::Piece>(m, "Piece", "Variables that factors connect.")
      .Result("variables", &Structure::Piece::variables, "How many.")
      .Result("factors", &Structure::Piece::factors, "How many.")
      .Result("first", &Structure::Piece::first, "Id of its smallest key.")
      .Result("anchor", &Structure::Piece::anchor, "Id of what an anchor would hold.")
      .Result("has_fixed", &Structure::Piece::has_fixed, "A variable is fixed.")
      .Result("has_absolute", &Structure::Piece::has_absolute,
              "A factor depends on more than relative placement.");
  Record<Structure>(m, "Structure", "How a graph hangs together, from its shape alone.")
      .Result("pieces", &Structure::pieces, "In the order of their first keys.")
      .Result("isolated", &Structure::isolated, "Ids of free variables without a factor.")
      .Result("starved", &Structure::starved,
              "Ids of free variables with fewer residuals than degrees of freedom.");
  m.def("analyse_structure", &AnalyseStructure, "graph"_a, Released(),
        "How a graph hangs together.  Takes time in proportion to the graph.");
}

}  // namespace

void BindMarginals(py::module_& module) {
  py::class_<SizedMarginals>(
      module, "Marginals",
      "Covariance blocks of some variables, in their tangent spaces: in the units of the "
      "tangent's fields, on the body side.")
      .def(
          "covariance",
          [](const SizedMarginals& self, const Key& a, const std::optional<Key>& b) {
            return self.Covariance(a, b ? *b : a);
          },
          "a"_a, "b"_a = py::none(),
          "(tangent size of a, of b); of a key with itself it is symmetric.  Zero where a "
          "variable is held.")
      .def_property_readonly(
          "anchors", [](const SizedMarginals& self) { return self.marginals.Anchors(); },
          "Keys that were held to remove the gauge: covariances are relative to these.")
      .def("__repr__", [](const SizedMarginals& self) {
        return "Marginals(of " + std::to_string(self.sizes.size()) + " variables)";
      });
  BindDiagnosis(module);
  module.def(
      "compute_marginals", &Compute, "graph"_a, "values"_a = nullptr, "keys"_a = std::vector<Key>(),
      "joint"_a = false,
      "Marginal covariances of `keys` at `values` (None: the graph's own); with `joint` "
      "also between the keys.  The losses are the graph's own: after a solve with the option "
      "`loss`, `Graph.set_losses` puts that one in their place.  Where the problem is "
      "ill-posed, a Diagnosis instead.");

  Record<JacobianCheck>(module, "JacobianCheck", "What was found for one factor type.")
      .Result("type", &JacobianCheck::type, "The factor type.")
      .Result("checked", &JacobianCheck::checked, "Factors.")
      .Result("wrong", &JacobianCheck::wrong, "Of these, those beyond the tolerance.")
      .Result("failed", &JacobianCheck::failed, "Of these, those that cannot be evaluated.")
      .Result("worst", &JacobianCheck::worst, "Largest relative disagreement.")
      .Result("worst_factor", &JacobianCheck::worst_factor, "Its id.")
      .Result("worst_row", &JacobianCheck::worst_row, "Component of the residual.")
      .Result("worst_block", &JacobianCheck::worst_block, "Role in the schema.")
      .Result("worst_field", &JacobianCheck::worst_field, "Of the block's tangent.")
      .Result("analytic", &JacobianCheck::analytic, "The factor's number there.")
      .Result("numeric", &JacobianCheck::numeric, "That of the differences.")
      .Result("failure", &JacobianCheck::failure, "Reason of the first failure.");
  module.def(
      "check_jacobians",
      [](const Graph& graph, const Values* values, double tolerance) {
        const py::gil_scoped_release released;
        return CheckJacobians(graph, values ? *values : graph.InitialValues(), tolerance);
      },
      "graph"_a, "values"_a = nullptr, "tolerance"_a = 1e-5,
      "Compares every factor's Jacobian with central differences at `values` (None: the graph's "
      "own).");
}

}  // namespace graticule::python
