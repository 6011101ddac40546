#include "bind.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/sweep.hpp"
#include "images.hpp"

namespace graticule::python {

using namespace py::literals;

GreyImage GreyOf(const Dense<std::uint8_t>& pixels) {
  ExpectShape(pixels, {-1, -1}, "a grey image");
  GreyImage image;
  image.height = static_cast<std::size_t>(pixels.shape(0));
  image.width = static_cast<std::size_t>(pixels.shape(1));
  image.shades.assign(pixels.data(), pixels.data() + pixels.size());
  return image;
}

ColourImage ColourOf(const Dense<std::uint8_t>& pixels) {
  ExpectShape(pixels, {-1, -1, 3}, "a picture");
  ColourImage image;
  image.height = static_cast<std::size_t>(pixels.shape(0));
  image.width = static_cast<std::size_t>(pixels.shape(1));
  image.rgb.assign(pixels.data(), pixels.data() + pixels.size());
  return image;
}

py::array_t<std::uint8_t> ArrayOf(GreyImage&& image) {
  return Owned(std::move(image.shades),
               {static_cast<py::ssize_t>(image.height), static_cast<py::ssize_t>(image.width)});
}

py::array_t<std::uint8_t> ArrayOf(ColourImage&& image) {
  return Owned(std::move(image.rgb),
               {static_cast<py::ssize_t>(image.height), static_cast<py::ssize_t>(image.width), 3});
}

namespace {

// A list of a point's own numbers: as many as there are points, or none.
template <class T>
std::vector<T> ListOf(const std::optional<Dense<T>>& values, py::ssize_t points, const char* what) {
  if (!values) return {};
  if (values->size() != points)
    throw Error(std::string(what) + ": expected one for each of " + std::to_string(points) +
                    " points, found " + std::to_string(values->size()),
                ErrorKind::kUsage);
  return {values->data(), values->data() + values->size()};
}

PointCloud CloudOf(const Dense<float>& points, const std::optional<Dense<std::uint8_t>>& colours,
                   const std::optional<Dense<float>>& intensities,
                   const std::optional<Dense<std::uint32_t>>& labels) {
  const bool organised = points.ndim() == 3;
  ExpectShape(points, organised ? Shape{-1, -1, 3} : Shape{-1, 3}, "points");
  PointCloud cloud;
  cloud.height = organised ? static_cast<std::size_t>(points.shape(0)) : 1;
  const py::ssize_t count = points.size() / 3;
  cloud.width = static_cast<std::size_t>(organised ? points.shape(1) : count);
  cloud.in_sensor.resize(static_cast<std::size_t>(count));
  for (py::ssize_t i = 0; i < count; ++i) {
    const Eigen::Vector3f point(points.data() + 3 * i);
    cloud.in_sensor[static_cast<std::size_t>(i)] = point.allFinite() ? point : kNoReturn;
  }
  if (colours) {
    if (colours->size() != 3 * count)
      throw Error("colours: expected red, green, blue of each of " + std::to_string(count) +
                      " points, found an array of shape " + ShapeOf(*colours),
                  ErrorKind::kUsage);
    cloud.colours.resize(static_cast<std::size_t>(count));
    std::copy(colours->data(), colours->data() + colours->size(), cloud.colours.data()->data());
  }
  cloud.intensities = ListOf(intensities, count, "intensities");
  cloud.labels = ListOf(labels, count, "labels");
  return cloud;
}

// (height, width[, channels]) of an organised cloud, else (points[, channels]); None: there are
// none.
template <class T, class Element>
std::optional<py::array_t<T>> Channel(const py::object& self,
                                      const std::vector<Element> PointCloud::*member) {
  const auto& cloud = self.cast<const PointCloud&>();
  const std::vector<Element>& list = cloud.*member;
  if (list.empty() && cloud.Size()) return std::nullopt;
  Shape shape{static_cast<py::ssize_t>(list.size())};
  if (cloud.IsOrganised())
    shape = {static_cast<py::ssize_t>(cloud.height), static_cast<py::ssize_t>(cloud.width)};
  if (sizeof(Element) > sizeof(T)) shape.push_back(sizeof(Element) / sizeof(T));
  return View(reinterpret_cast<const T*>(list.data()), shape, self, false);
}

void BindCloud(py::module_& m) {
  py::class_<PointCloud, std::shared_ptr<PointCloud>>(
      m, "PointCloud",
      "Points of a scan, row by row, with colours, intensities and labels where there are some.  "
      "Organised where it has rows: neighbours in the grid are neighbours in direction.")
      .def(py::init(&CloudOf), "points"_a, "colours"_a = py::none(), "intensities"_a = py::none(),
           "labels"_a = py::none(),
           "points: (height, width, 3) organised, or (n, 3), in the sensor's frame [m]; nan: no "
           "return.  colours: the same shape, red green blue of 0 to 255.  intensities, labels "
           "(0: none): one a point.")
      .def_readonly("width", &PointCloud::width, "Points a row.")
      .def_readonly("height", &PointCloud::height, "Rows; 1: not organised.")
      .def("__len__", &PointCloud::Size)
      .def_property_readonly("is_organised", &PointCloud::IsOrganised, "More than one row.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            return *Channel<float, Eigen::Vector3f>(self, &PointCloud::in_sensor);
          },
          "(height, width, 3) or (n, 3) in the sensor's frame [m], float32; nan: no return.  Not "
          "a copy; it cannot be written to.")
      .def_property_readonly(
          "colours",
          [](const py::object& self) {
            return Channel<std::uint8_t, Rgb>(self, &PointCloud::colours);
          },
          "Red, green, blue, in the points' shape, or None.  Not a copy.")
      .def_property_readonly(
          "intensities",
          [](const py::object& self) {
            return Channel<float, float>(self, &PointCloud::intensities);
          },
          "(height, width) or (n,), or None.  Not a copy.")
      .def_property_readonly(
          "labels",
          [](const py::object& self) {
            return Channel<std::uint32_t, std::uint32_t>(self, &PointCloud::labels);
          },
          "(height, width) or (n,), 0: none; or None.  Not a copy.")
      .def("__repr__", [](const PointCloud& cloud) {
        return "PointCloud(" + std::to_string(cloud.width) + " x " + std::to_string(cloud.height) +
               " points)";
      });
  m.def("read_cloud", &ReadCloud, "path"_a, Released(),
        "Reads .pcd, .ply, .bin (KITTI) or .csv (a sweep of planar scans), each also .gz.");
  m.def("write_cloud", &WriteCloud, "path"_a, "cloud"_a, Released(),
        "Writes .pcd or .ply, in one step.");
  m.def(
      "organise_spinning",
      [](const PointCloud& cloud, std::size_t beams) {
        const py::gil_scoped_release released;
        return OrganiseSpinning(cloud, {beams});
      },
      "cloud"_a, "beams"_a = 64,
      "The scan of a rotating LIDAR, a beam a row and the azimuth a column.");
}

py::array_t<float> RangesOf(const Sweep& sweep) {
  std::vector<float> ranges;
  for (const SweptScan& scan : sweep.scans)
    ranges.insert(ranges.end(), scan.ranges_m.begin(), scan.ranges_m.end());
  const auto count = static_cast<py::ssize_t>(sweep.scans.size());
  const auto beams =
      count ? static_cast<py::ssize_t>(sweep.scans[0].ranges_m.size()) : py::ssize_t{0};
  return Owned(std::move(ranges), {count, beams});
}

void BindSweep(py::module_& m) {
  Record<SweptScan>(m, "SweptScan", "One turn of a planar laser.")
      .Field("stamp_s", &SweptScan::stamp_s, "When [s].")
      .Field("servo_rad", &SweptScan::servo_rad, "The servo's angle [rad].")
      .Field("first_bearing_rad", &SweptScan::first_bearing_rad, "Of the first range [rad].")
      .Field("bearing_step_rad", &SweptScan::bearing_step_rad, "To the next [rad].")
      .Field("ranges_m", &SweptScan::ranges_m, "(beams,) [m]; nan: no return.");
  Record<Sweep>(m, "Sweep", "Scans of a planar laser that a servo turns (thesis, Eq. 4.1).")
      .Field("axis", &Sweep::axis, "(3,) of the servo, unit.")
      .Field("servo_from_laser", &Sweep::servo_from_laser, "(7,) x y z [m] qx qy qz qw.")
      .Field("scans", &Sweep::scans, "In the order of their time.")
      .Class()
      .def_property_readonly("ranges", &RangesOf, "(scans, beams) [m].  A copy.")
      .def("to_cloud", &ToCloud, "The points in the sensor's frame, a scan a row.");
  m.def(
      "read_sweep", [](const std::string& path) { return ParseSweep(ReadFile(path), path); },
      "path"_a, "A line a scan: stamp_s, servo_rad, first_bearing_rad, bearing_step_rad, ranges.");
  m.def(
      "write_sweep",
      [](const std::string& path, const Sweep& sweep) { WriteFile(path, FormatSweep(sweep)); },
      "path"_a, "sweep"_a, "The same file again, to the bit.");
}

}  // namespace

void BindClouds(py::module_& module) {
  BindCloud(module);
  BindSweep(module);
  module.def(
      "read_grey_photo", [](const std::string& path) { return ArrayOf(ReadGreyPhoto(path)); },
      "path"_a, "(height, width) shades of 0 to 255, the top row first, as the sensor saw it.");
  module.def(
      "read_colour_photo", [](const std::string& path) { return ArrayOf(ReadColourPhoto(path)); },
      "path"_a, "(height, width, 3) red, green, blue of 0 to 255, the top row first.");
  module.def(
      "format_png",
      [](const Dense<std::uint8_t>& pixels) {
        return py::bytes(pixels.ndim() == 3 ? FormatPng(ColourOf(pixels))
                                            : FormatPng(GreyOf(pixels)));
      },
      "pixels"_a, "PNG bytes of (height, width) shades or (height, width, 3) colours.");
}

}  // namespace graticule::python
