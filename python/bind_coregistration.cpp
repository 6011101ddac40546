#include "bind.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/problems/segmentation/coregister.hpp"
#include "graticule/problems/segmentation/coregister_error.hpp"
#include "graticule/problems/segmentation/coregister_evaluate.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

CoregisterData DataOf(std::vector<Correspondence> points, std::vector<BoardSighting> boards) {
  return {std::move(points), std::move(boards)};
}

void BindResult(py::module_& m) {
  Record<BoardSighting>(m, "BoardSighting",
                        "A board whose plane a LIDAR measured and whose pose a camera saw.")
      .Field("name", &BoardSighting::name, "Of its picture.")
      .Field("camera_from_board", &BoardSighting::camera_from_board, "(7,); its plane is z = 0.")
      .Field("normal_in_lidar", &BoardSighting::normal_in_lidar, "(3,) unit.")
      .Field("offset_m", &BoardSighting::offset_m, "normal . p [m].");
  Record<CoregisterOptions>(m, "CoregisterOptions", "How extrinsics are found.")
      .Field("sigma_px", &CoregisterOptions::sigma_px, "Of a pixel, on either axis [px].")
      .Field("sigma_m", &CoregisterOptions::sigma_m, "Of a LIDAR's point, on any axis [m].")
      .Field("sigmas_are_known", &CoregisterOptions::sigmas_are_known,
             "Else only their ratio is used.")
      .Field("sigma_tilt_rad", &CoregisterOptions::sigma_tilt_rad, "Of a board's plane [rad].")
      .Field("outlier_share", &CoregisterOptions::outlier_share, "Of right ones named outliers.")
      .Field("free_parameters", &CoregisterOptions::free_parameters,
             "(parameters,) 1: estimated; empty: none.")
      .Field("seed", &CoregisterOptions::seed, "Of the start's samples.")
      .Field("solve", &CoregisterOptions::solve, "Of the solver.");
  py::class_<Coregistration>(m, "Coregistration", "A solved co-registration.")
      .def_property_readonly(
          "camera", [](const Coregistration& self) { return self.state.camera; },
          "Its parameters; those that were free as estimated.")
      .def_property_readonly(
          "camera_from_lidar",
          [](const Coregistration& self) { return self.state.camera_from_lidar; },
          "(7,) x y z [m] qx qy qz qw.")
      .def_readonly("use", &Coregistration::use, "(points + boards,) 0: an outlier.")
      .def_readonly("outliers", &Coregistration::outliers, "(n,) into points, then boards.")
      .def_property_readonly(
          "covariance",
          [](const Coregistration& self) {
            return Frozen(self.covariance.data(), {6, 6});
          },
          "(6, 6) of the tangent: translation [m], rotation [rad], in the LIDAR's frame.")
      .def_readonly("region_95", &Coregistration::region_95, "e' covariance^-1 e up to this.")
      .def_readonly("freedoms", &Coregistration::freedoms, "Estimated numbers.")
      .def_readonly("scale", &Coregistration::scale,
                    "The options' deviations times this are the residuals'.")
      .def_readonly("rms_px", &Coregistration::rms_px, "Of the points that count [px].")
      .def_readonly("report", &Coregistration::report, "Of the last solve.")
      .def(
          "rig",
          [](const Coregistration& self) {
            LidarRig rig{self.state.camera, self.state.camera_from_lidar, {}, {}};
            rig.covariance.assign(self.covariance.data(), self.covariance.data() + 36);
            return rig;
          },
          "As `write_rig` writes it.")
      .def("__repr__", [](const Coregistration& self) {
        return "Coregistration(rms " + Shown(self.rms_px) + " px, " +
               std::to_string(self.outliers.size()) + " outliers)";
      });
}

}  // namespace

void BindCoregistration(py::module_& module) {
  BindResult(module);
  module.def(
      "coregister",
      [](std::vector<Correspondence> points, const CameraIntrinsics& camera,
         std::vector<BoardSighting> boards, const CoregisterOptions* options,
         const py::kwargs& keywords) {
        const CoregisterOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return Coregister(Builtins(), DataOf(std::move(points), std::move(boards)), camera, chosen);
      },
      "points"_a, "camera"_a, "boards"_a = std::vector<BoardSighting>(), "options"_a = nullptr,
      "Extrinsics of a camera and a LIDAR from correspondences and boards, without a start "
      "(docs/coregistration.md).  Options also as keywords.");
  module.def(
      "build_coregistration",
      [](std::vector<Correspondence> points, const Coregistration& solved,
         std::vector<BoardSighting> boards, const CoregisterOptions* options) {
        return BuildCoregistration(Builtins(), DataOf(std::move(points), std::move(boards)),
                                   solved.state, solved.use,
                                   options ? *options : CoregisterOptions(), solved.scale);
      },
      "points"_a, "solved"_a, "boards"_a = std::vector<BoardSighting>(), "options"_a = nullptr,
      "The graph of what counts, at a solution: camera:0 and camera_from_lidar:0.");
  module.def(
      "point_residuals",
      [](const Coregistration& solved, const std::vector<Correspondence>& points) {
        const std::vector<Eigen::Vector2d> residuals = PointResiduals(solved.state, points);
        const auto count = static_cast<py::ssize_t>(residuals.size());
        std::vector<double> rows;
        for (const Eigen::Vector2d& residual : residuals)
          rows.insert(rows.end(), {residual.x(), residual.y()});
        return Owned(std::move(rows), {count, 2});
      },
      "solved"_a, "points"_a, "(n, 2) predicted - seen [px]; nan: the camera has no image of it.");
  Record<HeldOut>(module, "HeldOut", "Errors of correspondences that the estimate has not seen.")
      .Result("distances_px", &HeldOut::distances_px, "(n,) [px]; infinite: not determined.")
      .Result("rms_px", &HeldOut::rms_px, "Of all.")
      .Result("rms_counted_px", &HeldOut::rms_counted_px, "Of those that were no outliers.")
      .Result("median_px", &HeldOut::median_px, "Of all.");
  module.def(
      "leave_one_out",
      [](std::vector<Correspondence> points, const Coregistration& solved,
         std::vector<BoardSighting> boards, const CoregisterOptions* options) {
        const py::gil_scoped_release released;
        return LeaveOneOut(Builtins(), DataOf(std::move(points), std::move(boards)), solved,
                           options ? *options : CoregisterOptions());
      },
      "points"_a, "solved"_a, "boards"_a = std::vector<BoardSighting>(), "options"_a = nullptr,
      "Leaves each point out in turn, and co-registers from the whole one's answer.");
}

}  // namespace graticule::python
