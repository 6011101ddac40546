#include <algorithm>

#include "bind.hpp"
#include "corners.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/evaluate.hpp"
#include "graticule/problems/calibration/select_model.hpp"
#include "graticule/problems/calibration/session.hpp"
#include "graticule/problems/calibration/undistort.hpp"
#include "images.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

void BindState(py::module_& m) {
  py::enum_<BoardShape>(m, "BoardShape", "How the target's shape is treated.")
      .value("FLAT", BoardShape::kFlat, "As its description says.")
      .value("WARPED", BoardShape::kWarped, "Bent by a quadratic height.")
      .value("FREE", BoardShape::kFree, "Every corner has a place of its own.");
  Record<CalibrationOptions>(m, "CalibrationOptions", "How cameras are calibrated.")
      .Field("model", &CalibrationOptions::model, "Of the lens: `camera_models()`.")
      .Field("board", &CalibrationOptions::board, "The target's shape.")
      .Field("corner_sigma_m", &CalibrationOptions::corner_sigma_m, "FREE only [m]; 0: chosen.")
      .Field("outlier_sigmas", &CalibrationOptions::outlier_sigmas,
             "Farther corners are set aside.")
      .Field("sigma_px", &CalibrationOptions::sigma_px, "Of a corner [px]; 0: from the residuals.")
      .Field("solve", &CalibrationOptions::solve, "Of the solver.");
  Record<CalibrationState>(m, "CalibrationState", "Everything that calibration estimates.")
      .Field("cameras", &CalibrationState::cameras, "Their parameters.")
      .Field("camera_from_rig", &CalibrationState::camera_from_rig,
             "(7,) each, x y z [m] qx qy qz qw; the first is the identity.")
      .Field("rig_from_target", &CalibrationState::rig_from_target,
             "(7,) an exposure, or None: not known.")
      .Field("warp", &CalibrationState::warp, "(3,) xx yy xy [1/m].")
      .Field("corners", &CalibrationState::corners, "By id, (3,) [m]; FREE only.");
  py::class_<Calibration, std::shared_ptr<Calibration>>(m, "Calibration", "A solved calibration.")
      .def_readonly("state", &Calibration::state, "Everything that was estimated.")
      .def_readonly("use", &Calibration::use, "A row a view: 0 a corner that was set aside.")
      .def_property_readonly(
          "outliers",
          [](const Calibration& self) {
            std::vector<std::tuple<std::size_t, std::size_t, double>> outliers;
            for (const Outlier& outlier : self.outliers)
              outliers.emplace_back(outlier.view, outlier.corner, outlier.error_px);
            return outliers;
          },
          "(view, corner, error [px]), worst first.")
      .def_readonly("left_out", &Calibration::left_out, "(n,) views without a pose.")
      .def_readonly("corners", &Calibration::corners, "That count.")
      .def_readonly("freedoms", &Calibration::freedoms, "Estimated numbers.")
      .def_readonly("rms_px", &Calibration::rms_px, "Of a corner's distance [px].")
      .def_readonly("worst_px", &Calibration::worst_px, "Of a corner's distance [px].")
      .def_readonly("sigma_px", &Calibration::sigma_px, "Of either coordinate [px].")
      .def_readonly("report", &Calibration::report, "Of the last solve.")
      .def(
          "rig",
          [](const Calibration& self) {
            CameraRig rig;
            for (std::size_t c = 0; c < self.state.cameras.size(); ++c)
              rig.cameras.push_back({self.state.cameras[c], self.state.camera_from_rig[c], {}});
            return rig;
          },
          "As `write_cameras` writes it.")
      .def("__repr__", [](const Calibration& self) {
        return "Calibration(" + std::to_string(self.state.cameras.size()) + " cameras, rms " +
               Shown(self.rms_px) + " px)";
      });
}

void BindCalibrate(py::module_& m) {
  m.def(
      "calibrate",
      [](const Detections& detections, const CalibrationOptions* options,
         const py::kwargs& keywords) {
        const CalibrationOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return BootstrapCalibration(Builtins(), detections, chosen);
      },
      "detections"_a, "options"_a = nullptr,
      "A calibration from detections alone: no focal length, no start, no order of frames "
      "(BootstrapCalibration).  Options also as keywords.");
  m.def(
      "refine_calibration",
      [](const Detections& detections, const CalibrationState& start,
         const CalibrationOptions* options, const py::kwargs& keywords) {
        const CalibrationOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return RefineCalibration(Builtins(), detections, start, chosen);
      },
      "detections"_a, "start"_a, "options"_a = nullptr,
      "Solves from a start.  Options also as keywords.");
  m.def(
      "build_calibration",
      [](const Detections& detections, const Calibration& solved, double sigma_px,
         const CalibrationOptions* options) {
        return BuildCalibration(Builtins(), detections, solved.state, solved.use,
                                options ? *options : CalibrationOptions(), sigma_px);
      },
      "detections"_a, "solved"_a, "sigma_px"_a, "options"_a = nullptr,
      "The factor graph of a calibration, at a solution: camera:c, camera_from_rig:c, "
      "target:exposure, warp:0.");
  m.def("read_back_calibration", &ReadBackCalibration, "graph"_a, "values"_a, "state"_a,
        "The state that the graph's values say; what they do not say as in `state`.");

  Record<ReprojectionError>(m, "ReprojectionError", "Distances of corners [px].")
      .Result("views", &ReprojectionError::views, "How many.")
      .Result("corners", &ReprojectionError::corners, "How many.")
      .Result("unseen", &ReprojectionError::unseen, "That the model has no image of.")
      .Result("mean_px", &ReprojectionError::mean_px, "[px]")
      .Result("rms_px", &ReprojectionError::rms_px, "[px]")
      .Result("median_px", &ReprojectionError::median_px, "[px]")
      .Result("percentile_995_px", &ReprojectionError::percentile_995_px, "[px]")
      .Result("max_px", &ReprojectionError::max_px, "[px]");
  m.def(
      "evaluate_on",
      [](const CalibrationState& calibration, const Detections& test) {
        const py::gil_scoped_release released;
        return EvaluateOn(calibration, test);
      },
      "calibration"_a, "test"_a, "A calibration on views that it was not made from.");
  Record<ModelTrial>(m, "ModelTrial", "One model on the data.")
      .Result("model", &ModelTrial::model, "Of the lens.")
      .Result("board", &ModelTrial::board, "The target's shape.")
      .Result("parameters", &ModelTrial::parameters, "Of each camera.")
      .Result("rms_px", &ModelTrial::rms_px, "On what it was made from [px].")
      .Result("held_out", &ModelTrial::held_out, "Cross-validated.")
      .Result("bic", &ModelTrial::bic, "Less the best one's.")
      .Result("failure", &ModelTrial::failure, "Why there is no error, or \"\".");
  py::class_<ModelSelection>(m, "ModelSelection", "Models that were tried, and the one chosen.")
      .def_readonly("trials", &ModelSelection::trials, "Least held-out error first.")
      .def_readonly("chosen", &ModelSelection::chosen, "Into trials.")
      .def_readonly("calibration", &ModelSelection::calibration, "Of the chosen one.")
      .def_readonly("options", &ModelSelection::options, "That it was made with.");
  m.def(
      "select_model",
      [](const Detections& detections, const std::vector<std::string>& models,
         const std::vector<BoardShape>& boards, const CalibrationOptions* options) {
        const CalibrationOptions chosen = options ? *options : CalibrationOptions();
        const py::gil_scoped_release released;
        return SelectModel(Builtins(), detections, chosen, models, boards);
      },
      "detections"_a, "models"_a = std::vector<std::string>(),
      py::arg_v("boards", std::vector<BoardShape>{BoardShape::kFlat}, "[BoardShape.FLAT]"),
      "options"_a = nullptr,
      "Shapes of the target and models, judged by cross-validation over exposures.  models: "
      "empty: all built-in ones.");
}

void BindUndistortion(py::module_& m) {
  m.def(
      "rectified_view",
      [](const Camera& camera, bool keep_all, int width, int height) {
        RectifyOptions options;
        options.keep = keep_all ? RectifyKeep::kAll : RectifyKeep::kValid;
        options.width = width;
        options.height = height;
        return RectifiedView(camera, options);
      },
      "camera"_a, "keep_all"_a = false, "width"_a = 0, "height"_a = 0,
      "A pinhole camera that looks where the camera looks.");
  py::class_<Rectifier>(m, "Rectifier",
                        "Turns images of one camera into those of another at the same place.")
      .def(py::init<const Camera&, const Camera&>(), "from_camera"_a, "to_camera"_a)
      .def_property_readonly("filled", &Rectifier::Filled,
                             "Share of pixels with something to show.")
      .def(
          "image",
          [](const Rectifier& self, const Dense<std::uint8_t>& pixels) {
            return ArrayOf(self.Image(GreyOf(pixels)));
          },
          "pixels"_a, "(height, width) shades of the other camera; black where there is nothing.");
}

}  // namespace

void BindCalibration(py::module_& module) {
  BindState(module);
  BindCalibrate(module);
  BindUndistortion(module);
}

}  // namespace graticule::python
