#pragma once

#include "record.hpp"

namespace graticule::python {

// A file a room or chapter; each is called once, in this order, so that what a signature names is
// known before it.
void BindTypes(py::module_& module);
void BindGraph(py::module_& module);
void BindSolver(py::module_& module);
void BindMarginals(py::module_& module);
void BindOnline(py::module_& module);
void BindPythonFactors(py::module_& module);
void BindProblemFiles(py::module_& module);
void BindReports(py::module_& module);
void BindLaser(py::module_& module);
void BindClouds(py::module_& module);
void BindCameras(py::module_& module);
void BindSignals(py::module_& module);
void BindPoseGraph(py::module_& module);
void BindOutliers(py::module_& module);
void BindGeography(py::module_& module);
void BindMapping(py::module_& module);
void BindLiveMap(py::module_& module);
void BindGnss(py::module_& module);
void BindAttenuation(py::module_& module);
void BindSignalTuning(py::module_& module);
void BindSignalSimulation(py::module_& module);
void BindSegmentation(py::module_& module);
void BindCoregistration(py::module_& module);
void BindTargets(py::module_& module);
void BindCalibration(py::module_& module);
void BindUncertainty(py::module_& module);

/// For calls that take long and touch nothing of Python's: others may run meanwhile.
using Released = py::call_guard<py::gil_scoped_release>;

}  // namespace graticule::python
