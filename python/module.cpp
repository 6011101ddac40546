#include "bind.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"

namespace graticule::python {
namespace {

// The exception classes, by kind.  They live as long as the process.
PyObject* exceptions[5] = {};

void BindErrors(py::module_& module) {
  py::enum_<ErrorKind>(module, "ErrorKind", "What kind of thing went wrong.")
      .value("OTHER", ErrorKind::kOther, "None of the others, e.g. a full disk.")
      .value("USAGE", ErrorKind::kUsage, "An argument or option that does not exist or fit.")
      .value("INPUT", ErrorKind::kInput, "An input was refused.")
      .value("ILL_POSED", ErrorKind::kIllPosed, "The question has no single answer.")
      .value("MISSING_TYPE", ErrorKind::kMissingType, "A type or plug-in is missing or refused.");

  const auto define = [&](ErrorKind kind, const char* name, const char* doc, PyObject* base) {
    py::dict members;
    members["kind"] = py::cast(kind);
    PyObject* made = PyErr_NewExceptionWithDoc((std::string("graticule.") + name).c_str(), doc,
                                               base, members.ptr());
    if (!made) throw py::error_already_set();
    module.add_object(name, made);
    exceptions[static_cast<int>(kind)] = made;
    return made;
  };
  PyObject* base =
      define(ErrorKind::kOther, "Error",
             "A wrong input: file, key, option, plug-in.  One line that says where, what was "
             "found, what was expected.  `kind` says what kind; each kind but OTHER has a class.",
             PyExc_Exception);
  define(ErrorKind::kUsage, "UsageError", "An argument or option that does not exist or fit.",
         base);
  define(ErrorKind::kInput, "InputError", "An input was refused.", base);
  define(ErrorKind::kIllPosed, "IllPosedError",
         "The question has no single answer: loose variables, several pieces.", base);
  define(ErrorKind::kMissingType, "MissingTypeError",
         "A factor type, variable type or plug-in is missing or refused.", base);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      PyErr_SetString(exceptions[static_cast<int>(error.Kind())], error.what());
    }
  });
}

}  // namespace
}  // namespace graticule::python

PYBIND11_MODULE(_graticule, module) {
  using namespace graticule::python;
  module.doc() = "Factor graphs as data, solved by Ceres: what is compiled.";
  module.attr("__version__") = graticule::Version();
  module.def(
      "provenance",
      [] {
        py::dict versions;
        for (const auto& [name, version] : graticule::Provenance())
          versions[py::str(name)] = version;
        return versions;
      },
      "Versions of what a result depends on: Graticule, Ceres, Eigen, CHOLMOD, the BLAS.");
  BindErrors(module);
  BindTypes(module);
  BindGraph(module);
  BindSolver(module);
  BindMarginals(module);
  BindOnline(module);
  BindPythonFactors(module);
  BindProblemFiles(module);
  BindReports(module);
  BindLaser(module);
  BindClouds(module);
  BindCameras(module);
  BindSignals(module);
  BindPoseGraph(module);
  BindOutliers(module);
  BindGeography(module);
  BindMapping(module);
  BindLiveMap(module);
  BindGnss(module);
  BindAttenuation(module);
  BindSignalTuning(module);
  BindSignalSimulation(module);
  BindSegmentation(module);
  BindCoregistration(module);
  BindTargets(module);
  BindCalibration(module);
  BindUncertainty(module);
}
