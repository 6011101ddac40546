#include "bind.hpp"
#include "corners.hpp"
#include "graticule/factors/camera_model.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/io/correspondences.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/problems/calibration/camera.hpp"

namespace graticule::python {

using namespace py::literals;

std::vector<DetectedCorner> CornersOf(const Dense<std::int64_t>& ids,
                                      const Dense<double>& in_target, const Dense<double>& pixels) {
  ExpectShape(ids, {-1}, "ids");
  ExpectShape(in_target, {ids.shape(0), 3}, "in_target");
  ExpectShape(pixels, {ids.shape(0), 2}, "pixels");
  std::vector<DetectedCorner> corners(static_cast<std::size_t>(ids.shape(0)));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    corners[i].id = static_cast<int>(ids.at(row));
    std::copy(in_target.data(row), in_target.data(row) + 3, corners[i].in_target.begin());
    std::copy(pixels.data(row), pixels.data(row) + 2, corners[i].pixel.begin());
  }
  return corners;
}

CornerArrays ArraysOf(const std::vector<DetectedCorner>& corners) {
  const auto count = static_cast<py::ssize_t>(corners.size());
  CornerArrays arrays{py::array_t<int>(count), py::array_t<double>(Shape{count, 3}),
                      py::array_t<double>(Shape{count, 2})};
  auto& [ids, in_target, pixels] = arrays;
  for (py::ssize_t i = 0; i < count; ++i) {
    const DetectedCorner& corner = corners[static_cast<std::size_t>(i)];
    ids.mutable_at(i) = corner.id;
    std::copy(corner.in_target.begin(), corner.in_target.end(), in_target.mutable_data(i));
    std::copy(corner.pixel.begin(), corner.pixel.end(), pixels.mutable_data(i));
  }
  return arrays;
}

namespace {

py::array_t<double> Project(const Camera& camera, const Dense<double>& points) {
  ExpectShape(points, {-1, 3}, "points");
  std::vector<double> pixels;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    const auto pixel = camera.Project(Eigen::Vector3d(points.data(i)));
    for (const int axis : {0, 1}) pixels.push_back(pixel ? (*pixel)[axis] : std::nan(""));
  }
  return Owned(std::move(pixels), {points.shape(0), 2});
}

py::array_t<double> Unproject(const Camera& camera, const Dense<double>& pixels) {
  ExpectShape(pixels, {-1, 2}, "pixels");
  std::vector<double> rays;
  for (py::ssize_t i = 0; i < pixels.shape(0); ++i) {
    const auto ray = camera.Unproject(Eigen::Vector2d(pixels.data(i)));
    for (const int axis : {0, 1, 2}) rays.push_back(ray ? (*ray)[axis] : std::nan(""));
  }
  return Owned(std::move(rays), {pixels.shape(0), 3});
}

std::optional<CameraFormat> FormatOf(const std::optional<std::string>& word) {
  if (!word) return std::nullopt;
  return CameraFormatFromWord(*word);
}

void BindCamera(py::module_& m) {
  Record<CameraIntrinsics>(m, "CameraIntrinsics", "A camera's intrinsic parameters.")
      .Field("name", &CameraIntrinsics::name, "\"cam0\", \"\" where a file has none.")
      .Field("model", &CameraIntrinsics::model, "\"angular4\": `camera_models()`.")
      .Field("width", &CameraIntrinsics::width, "Of the images [px].")
      .Field("height", &CameraIntrinsics::height, "Of the images [px].")
      .Field("parameters", &CameraIntrinsics::parameters,
             "fx fy cx cy [px], then the model's terms.");
  py::class_<Camera>(m, "Camera",
                     "A calibrated camera: rays to pixels and back.  Rays are in the camera's "
                     "frame: x right, y down, z forward; pixel (0, 0) is the centre of the "
                     "upper left one.")
      .def(py::init<CameraIntrinsics>(), "intrinsics"_a)
      .def_property_readonly("intrinsics", &Camera::Intrinsics, "Its parameters.")
      .def_property_readonly("max_angle", &Camera::MaxAngle,
                             "Farthest from the optical axis that it sees [rad].")
      .def("project", &Project, "points"_a,
           "(n, 2) pixels of points (n, 3) in its frame; nan: no image.")
      .def("unproject", &Unproject, "pixels"_a, "(n, 3) unit rays of pixels (n, 2); nan: no ray.");
  m.def(
      "camera_models",
      [] {
        py::dict models;
        for (const CameraModel& model : CameraModels()) models[model.name] = model.fields;
        return models;
      },
      "The built-in models, with the names and units of their parameters.");
  Record<RigCamera>(m, "RigCamera", "A camera of a rig.")
      .Field("intrinsics", &RigCamera::intrinsics, "Its parameters.")
      .Field("camera_from_rig", &RigCamera::camera_from_rig, "(7,) x y z [m] qx qy qz qw.")
      .Field("covariance", &RigCamera::covariance,
             "(n * n,) of the parameters, row by row; empty: not known.");
  Record<CameraRig>(m, "CameraRig", "One camera, or several that are fixed to each other.")
      .Field("cameras", &CameraRig::cameras, "In their order.")
      .Field("meta", &CameraRig::meta, "What else is said.  Our own format keeps it.");
  m.def("read_cameras", &ReadCameras, "path"_a,
        "Reads our own YAML, OpenCV's, ROS', Kalibr's and mrcal's files, told by contents.");
  m.def("read_camera", &ReadCamera, "path"_a, "A file's only camera.");
  m.def(
      "write_cameras",
      [](const std::string& path, const CameraRig& rig, const std::optional<std::string>& format) {
        WriteCameras(path, rig, FormatOf(format));
      },
      "path"_a, "rig"_a, "format"_a = py::none(),
      "format: graticule, opencv, ros, kalibr, mrcal; None: by the name's ending.");
  m.def(
      "write_camera",
      [](const std::string& path, const CameraIntrinsics& camera,
         const std::optional<std::string>& format) { WriteCamera(path, camera, FormatOf(format)); },
      "path"_a, "camera"_a, "format"_a = py::none(), "The same of one camera.");
}

void BindRig(py::module_& m) {
  Record<LidarRig>(m, "LidarRig", "A camera that is fixed to a LIDAR.")
      .Field("camera", &LidarRig::camera, "Its parameters.")
      .Field("camera_from_lidar", &LidarRig::camera_from_lidar, "(7,) x y z [m] qx qy qz qw.")
      .Field("covariance", &LidarRig::covariance,
             "(36,) of the tangent, row by row: translation [m], rotation [rad], in the LIDAR's "
             "frame; empty: not known.")
      .Field("meta", &LidarRig::meta, "How it was found, with what error.");
  m.def("read_rig", &ReadRig, "path"_a, "Our own YAML; .txt: KITTI's calibration.");
  m.def("write_rig", &WriteRig, "path"_a, "rig"_a, "All numbers come back to the last bit.");
  Record<Correspondence>(m, "Correspondence", "A point that a LIDAR measured and a camera saw.")
      .Field("in_lidar", &Correspondence::in_lidar, "(3,) [m].")
      .Field("pixel", &Correspondence::pixel, "(2,) [px].")
      .Field("name", &Correspondence::name, "Its own, or its number in the file.");
  m.def("read_correspondences", &ReadCorrespondences, "path"_a,
        "Lines `x,y,z,u,v[,name]` (m, px).");
  m.def(
      "write_correspondences",
      [](const std::string& path, const std::vector<Correspondence>& points) {
        WriteFile(path, FormatCorrespondences(points));
      },
      "path"_a, "points"_a, "The same file again, to the bit.");
  Record<MeasuredPlane>(m, "MeasuredPlane", "The plane of a board, as a LIDAR measured it.")
      .Field("image", &MeasuredPlane::image, "Of the view of the board that it belongs to.")
      .Field("normal", &MeasuredPlane::normal, "(3,) unit, in the LIDAR's frame.")
      .Field("offset_m", &MeasuredPlane::offset_m, "normal . p [m].");
  m.def(
      "read_planes", [](const std::string& path) { return ParsePlanes(ReadFile(path), path); },
      "path"_a, "Lines `image,nx,ny,nz,offset`.");
}

void BindDetections(py::module_& m) {
  py::class_<TargetView>(m, "TargetView", "What one camera saw of the target at one time.")
      .def(py::init([](const Dense<std::int64_t>& ids, const Dense<double>& in_target,
                       const Dense<double>& pixels, const std::string& image, std::size_t camera,
                       std::size_t exposure) {
             return TargetView{image, camera, exposure, CornersOf(ids, in_target, pixels)};
           }),
           "ids"_a, "in_target"_a, "pixels"_a, "image"_a = "", "camera"_a = 0, "exposure"_a = 0,
           "ids: (n,); in_target: (n, 3) [m]; pixels: (n, 2).")
      .def_readwrite("image", &TargetView::image, "Its name.")
      .def_readwrite("camera", &TargetView::camera, "Into Detections.cameras.")
      .def_readwrite("exposure", &TargetView::exposure,
                     "Views of one exposure saw the target at one place.")
      .def(py::pickle(
          [](const TargetView& view) {
            const CornerArrays corners = ArraysOf(view.corners);
            return py::make_tuple(view.image, view.camera, view.exposure, corners.ids,
                                  corners.in_target, corners.pixels);
          },
          [](const py::tuple& t) {
            return TargetView{t[0].cast<std::string>(), t[1].cast<std::size_t>(),
                              t[2].cast<std::size_t>(),
                              CornersOf(t[3].cast<Dense<std::int64_t>>(),
                                        t[4].cast<Dense<double>>(), t[5].cast<Dense<double>>())};
          }))
      .def("__repr__",
           [](const TargetView& view) {
             return "TargetView('" + view.image + "', " + std::to_string(view.corners.size()) +
                    " corners)";
           })
      .def("__len__", [](const TargetView& view) { return view.corners.size(); })
      .def_property_readonly(
          "ids", [](const TargetView& view) { return ArraysOf(view.corners).ids; },
          "(n,) a corner's id is the same in every view.")
      .def_property_readonly(
          "in_target", [](const TargetView& view) { return ArraysOf(view.corners).in_target; },
          "(n, 3) corners in the target's frame [m].")
      .def_property_readonly(
          "pixels", [](const TargetView& view) { return ArraysOf(view.corners).pixels; },
          "(n, 2) where they were seen; (0, 0) is the centre of the upper left pixel.");
  Record<ImageSize>(m, "ImageSize", "Size of a camera's images.")
      .Field("camera", &ImageSize::camera, "Its name, \"cam0\".")
      .Field("width", &ImageSize::width, "[px]")
      .Field("height", &ImageSize::height, "[px]");
  Record<Detections>(m, "Detections",
                     "Everything that calibration looks at: the corners of one rigid target, "
                     "seen by one or several cameras.")
      .Field("cameras", &Detections::cameras, "Sizes of their images.")
      .Field("views", &Detections::views, "Of a camera at a time.")
      .Field("exposures", &Detections::exposures, "How many there are.");
  m.def(
      "read_detections",
      [](const std::vector<std::string>& paths, int columns, int rows, double spacing_m, int width,
         int height) {
        return ReadDetections(paths, {columns, rows, spacing_m, width, height});
      },
      "paths"_a, py::kw_only(), "columns"_a = 0, "rows"_a = 0, "spacing_m"_a = 0.0, "width"_a = 0,
      "height"_a = 0,
      "Reads .json, .vnl (mrcal; needs the board's corners, their spacing, the images' size) or "
      ".orpc (BabelCalib) files; several are the cameras of a rig.");
  m.def("write_detections", &WriteDetections, "path"_a, "detections"_a,
        "JSON that reads back to the last bit.");
}

}  // namespace

void BindCameras(py::module_& module) {
  BindCamera(module);
  BindRig(module);
  BindDetections(module);
}

}  // namespace graticule::python
