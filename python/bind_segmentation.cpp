#include <algorithm>

#include "bind.hpp"
#include "graticule/problems/segmentation/colour_cloud.hpp"
#include "graticule/problems/segmentation/segment_score.hpp"
#include "graticule/problems/segmentation/segment_statistics.hpp"
#include "graticule/problems/segmentation/segmenter.hpp"
#include "graticule/problems/segmentation/simulate_scene.hpp"
#include "images.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

using Labels = Dense<std::uint32_t>;

std::vector<std::uint32_t> ListOf(const Labels& labels) {
  return {labels.data(), labels.data() + labels.size()};
}

SegmentOptions Chosen(const std::string& method, const SegmentOptions* options) {
  return options ? *options : DefaultsOf(SegmentMethodOf(method));
}

// Labels in the cloud's shape.
py::array_t<std::uint32_t> Shaped(const PointCloud& cloud, std::vector<std::uint32_t> labels) {
  return Owned(std::move(labels),
               {static_cast<py::ssize_t>(cloud.height), static_cast<py::ssize_t>(cloud.width)});
}

void BindOptions(py::module_& m) {
  py::enum_<SegmentMethod>(m, "SegmentMethod", "What parts one segment from the next.")
      .value("CONVEX", SegmentMethod::kConvex, "Concave edges of the surface.")
      .value("JOINT", SegmentMethod::kJoint, "Colour and normals: Algorithm 4.1.")
      .value("COLOUR", SegmentMethod::kColour, "Algorithm 4.1 with colour alone.")
      .value("NORMALS", SegmentMethod::kNormals, "Algorithm 4.1 with normals alone.")
      .value("IMAGE", SegmentMethod::kImage, "Colour alone, without geometry.");
  Record<MeshOptions>(m, "MeshOptions", "Which neighbours are linked.")
      .Field("edge_cut_m", &MeshOptions::edge_cut_m, "Longer edges are cut [m].")
      .Field("grazing_rad", &MeshOptions::grazing_rad, "Flatter edges are cut [rad]; 0: none.")
      .Field("is_closed", &MeshOptions::is_closed, "The last column neighbours the first.");
  Record<GraphSegmentationOptions>(m, "GraphSegmentationOptions", "Of Algorithm 4.1.")
      .Field("k_colour", &GraphSegmentationOptions::k_colour, "Of Equation 4.3.")
      .Field("k_normal", &GraphSegmentationOptions::k_normal, "Of Equation 4.3.")
      .Field("min_size", &GraphSegmentationOptions::min_size, "Smaller ones are joined [points].");
  Record<ConvexMergeOptions>(m, "ConvexMergeOptions", "Of the convex method.")
      .Field("block", &ConvexMergeOptions::block, "A patch is within so many rows and columns.")
      .Field("patch_angle_rad", &ConvexMergeOptions::patch_angle_rad, "Of a patch's normals.")
      .Field("patch_points", &ConvexMergeOptions::patch_points, "Smaller ones are shared out.")
      .Field("concave_angle_rad", &ConvexMergeOptions::concave_angle_rad, "That still joins.")
      .Field("min_links", &ConvexMergeOptions::min_links, "Between patches that are neighbours.")
      .Field("min_size", &ConvexMergeOptions::min_size, "Smaller ones are joined [points].");
  Record<SegmentOptions>(m, "SegmentOptions", "All that the methods ask for.")
      .Field("method", &SegmentOptions::method, "Which.")
      .Field("mesh", &SegmentOptions::mesh, "Which neighbours are linked.")
      .Field("normal_radius", &SegmentOptions::normal_radius, "Of the window of normals.")
      .Field("graph", &SegmentOptions::graph, "Of Algorithm 4.1.")
      .Field("convex", &SegmentOptions::convex, "Of the convex method.");
  m.def(
      "segment_defaults",
      [](const std::string& method) { return DefaultsOf(SegmentMethodOf(method)); }, "method"_a,
      "What suits a method: convex, joint, colour, normals, image.");
}

void BindSegmenter(py::module_& m) {
  py::class_<Segmenter>(m, "Segmenter",
                        "Segments organised clouds, frame after frame: nothing is allocated "
                        "after the first of a size.  One a thread.")
      .def(py::init([](const std::string& method, const SegmentOptions* options) {
             return Segmenter(Chosen(method, options));
           }),
           "method"_a = "convex", "options"_a = nullptr,
           "method: convex, joint, colour, normals, image, with its defaults; or options.")
      .def(
          "segment",
          [](Segmenter& self, const PointCloud& cloud) {
            // Kept by the segmenter: what is returned is a copy.
            std::vector<std::uint32_t> labels;
            {
              const py::gil_scoped_release released;
              labels = self.Segment(cloud);
            }
            return Shaped(cloud, std::move(labels));
          },
          "cloud"_a,
          "(height, width) of each point its segment, from 1 in the order of their first points; "
          "0: none.")
      .def_property_readonly("segment_count", &Segmenter::SegmentCount, "Of the last frame.");
  m.def(
      "segment",
      [](const PointCloud& cloud, const std::string& method, const SegmentOptions* options) {
        Segmenter segmenter(Chosen(method, options));
        std::vector<std::uint32_t> labels;
        {
          const py::gil_scoped_release released;
          labels = segmenter.Segment(cloud);
        }
        return Shaped(cloud, std::move(labels));
      },
      "cloud"_a, "method"_a = "convex", "options"_a = nullptr,
      "(height, width) of each point its segment; 0: none.  One frame; for many, a Segmenter.");
}

void BindResults(py::module_& m) {
  Record<SegmentScore>(m, "SegmentScore", "How well a segmentation finds labelled objects.")
      .Result("weighted_overlap", &SegmentScore::weighted_overlap, "0 to 1.")
      .Result("achievable", &SegmentScore::achievable, "0 to 1.")
      .Result("under_segmentation", &SegmentScore::under_segmentation, "0 to 1.")
      .Result("boundary_recall", &SegmentScore::boundary_recall, "0 to 1.")
      .Result("mean_f", &SegmentScore::mean_f, "Of objects, each by its best segment.")
      .Result("found", &SegmentScore::found, "Share of objects with an overlap above a half.")
      .Result("objects", &SegmentScore::objects, "Labelled things that count.")
      .Result("segments", &SegmentScore::segments, "That labelled points are in.");
  m.def(
      "score_of",
      [](const Labels& labels, const Labels& segments, std::uint32_t least_object) {
        ScoreOptions options;
        options.least_object = least_object;
        if (labels.ndim() == 2) options.width = static_cast<std::size_t>(labels.shape(1));
        return ScoreOf(ListOf(labels), ListOf(segments), options);
      },
      "labels"_a, "segments"_a, "least_object"_a = 1,
      "Holds segments against labels, both (height, width) or (n,); smaller labels than "
      "`least_object` are background.");
  Record<SegmentStatistics>(m, "SegmentStatistics", "What a segment is like.")
      .Result("label", &SegmentStatistics::label, "Its number.")
      .Result("points", &SegmentStatistics::points, "How many.")
      .Result("centre", &SegmentStatistics::centre, "(3,) mean, in the sensor's frame [m].")
      .Result("least", &SegmentStatistics::least, "(3,) corner of its box [m].")
      .Result("most", &SegmentStatistics::most, "(3,) corner of its box [m].")
      .Result("spread", &SegmentStatistics::spread, "(3,) deviations, largest first [m].")
      .Result("normal", &SegmentStatistics::normal, "(3,) direction of least spread.")
      .Result("offset_m", &SegmentStatistics::offset_m, "Of that plane from the sensor [m].")
      .Result("has_colour", &SegmentStatistics::has_colour, "There were colours.")
      .Result("mean_colour", &SegmentStatistics::mean_colour, "(3,) of 0 to 255.");
  m.def(
      "statistics_of",
      [](const PointCloud& cloud, const Labels& labels) {
        const std::vector<std::uint32_t> list = ListOf(labels);
        const std::uint32_t most = list.empty() ? 0 : *std::max_element(list.begin(), list.end());
        return StatisticsOf(cloud, list, most);
      },
      "cloud"_a, "labels"_a, "One entry a segment.");
  m.def(
      "false_colours",
      [](const Labels& labels) {
        const std::vector<Rgb> colours = FalseColours(ListOf(labels));
        Shape shape(labels.shape(), labels.shape() + labels.ndim());
        shape.push_back(3);
        return py::array_t<std::uint8_t>(shape, colours.data()->data());
      },
      "labels"_a, "(..., 3) a colour each segment, far in hue from the next ones; 0: black.");
}

void BindScenes(py::module_& m) {
  m.def(
      "colour_cloud",
      [](const PointCloud& cloud, const Dense<std::uint8_t>& image, const Camera& camera,
         const std::array<double, 7>& camera_from_lidar, bool keep_unseen) {
        const CloudColours colours = ColoursOf(cloud, ColourOf(image), camera, camera_from_lidar);
        return Coloured(cloud, colours, keep_unseen);
      },
      "cloud"_a, "image"_a, "camera"_a, "camera_from_lidar"_a, "keep_unseen"_a = false,
      "The cloud in the colours of a picture (height, width, 3): thesis Equation 4.1.  "
      "camera_from_lidar: (7,) x y z [m] qx qy qz qw.  Points that the camera does not see have "
      "no return then, or with `keep_unseen` are black.");
  Record<SceneOptions>(m, "SceneOptions", "A scene as a swept LIDAR sees it.")
      .Field("scans", &SceneOptions::scans, "Rows of the cloud.")
      .Field("bearings", &SceneOptions::bearings, "Columns.")
      .Field("bearing_step_rad", &SceneOptions::bearing_step_rad, "[rad]")
      .Field("sweep_rad", &SceneOptions::sweep_rad, "Of the servo [rad].")
      .Field("range_sigma_m", &SceneOptions::range_sigma_m, "[m]")
      .Field("max_range_m", &SceneOptions::max_range_m, "[m]")
      .Field("colour_sigma", &SceneOptions::colour_sigma, "Of 0 to 255.")
      .Field("seed", &SceneOptions::seed, "Same options, same digits.");
  py::class_<SimulatedScene>(m, "SimulatedScene", "A scene with labels that are known.")
      .def_readonly("cloud", &SimulatedScene::cloud,
                    "Labels: 1 ground, 2 to 9 other background, from 20 objects.")
      .def_property_readonly(
          "image", [](const SimulatedScene& self) { return ArrayOf(ColourImage(self.image)); },
          "(height, width, 3) what the camera sees.")
      .def_readonly("camera", &SimulatedScene::camera, "Its parameters.")
      .def_readonly("camera_from_lidar", &SimulatedScene::camera_from_lidar,
                    "(7,) x y z [m] qx qy qz qw.");
  m.def(
      "simulate_scene",
      [](const std::string& name, const SceneOptions* options, const py::kwargs& keywords) {
        return SimulateScene(name, OptionsFrom(options, keywords));
      },
      "name"_a = "hallway", "options"_a = nullptr,
      "\"hallway\" or \"hill\".  Options also as keywords.");
}

}  // namespace

void BindSegmentation(py::module_& module) {
  BindOptions(module);
  BindSegmenter(module);
  BindResults(module);
  BindScenes(module);
}

}  // namespace graticule::python
