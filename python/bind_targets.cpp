#include "bind.hpp"
#include "corners.hpp"
#include "graticule/problems/calibration/detect.hpp"
#include "graticule/problems/calibration/detect_all.hpp"
#include "graticule/problems/calibration/guess_target.hpp"
#include "graticule/problems/calibration/placement.hpp"
#include "graticule/problems/calibration/print_target.hpp"
#include "graticule/problems/calibration/render.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "images.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

void BindTarget(py::module_& m) {
  py::enum_<TargetKind>(m, "TargetKind", "What is printed.")
      .value("TAG_MOSAIC", TargetKind::kTagMosaic, "AprilCal's: rows of tags.")
      .value("APRIL_GRID", TargetKind::kAprilGrid, "Kalibr's: tags with small black squares.")
      .value("CHARUCO", TargetKind::kCharuco, "A chessboard with markers.")
      .value("CHESSBOARD", TargetKind::kChessboard, "A plain one.");
  Record<Target>(m, "Target", "A flat calibration target, as it is printed.")
      .Field("kind", &Target::kind, "What is printed.")
      .Field("columns", &Target::columns, "Chessboard: inner corners; ChArUco: squares; or tags.")
      .Field("rows", &Target::rows, "The same.")
      .Field("pitch_m", &Target::pitch_m, "A square's or tag's side, or tag to tag [m].")
      .Field("family", &Target::family, "Of its markers; not of a chessboard.")
      .Field("marker_m", &Target::marker_m, "ChArUco: a marker's side [m].")
      .Field("spacing", &Target::spacing, "Grid: from tag to tag, over a tag's side.")
      .Field("border_cells", &Target::border_cells, "Of the markers' black border.")
      .Field("is_legacy", &Target::is_legacy, "ChArUco: as OpenCV before 4.6.")
      .Field("first_id", &Target::first_id, "Of the markers.")
      .Field("stride", &Target::stride, "Mosaic: from a tag's id to the one below.")
      .Class()
      .def("__str__", &Described);
  m.def("read_target", &ReadTarget, "path"_a, "YAML; Kalibr's, too.");
  m.def("write_target", &WriteTarget, "path"_a, "target"_a, "YAML.");
  m.def(
      "print_target",
      [](const std::string& path, const Target& target, const std::string& paper) {
        return PrintTarget(path, target, PaperSizeOf(paper));
      },
      "path"_a, "target"_a, "paper"_a = "A4",
      "Draws the page at exact scale (.svg, .pdf, .png), and beside it its description, whose "
      "path is returned.");
}

void BindDetection(py::module_& m) {
  py::class_<TargetDetector>(m, "TargetDetector",
                             "Finds a target's corners in images.  Several threads may share it.")
      .def(py::init([](const Target& target, double decimate) {
             return std::make_unique<TargetDetector>(target, DetectOptions{decimate});
           }),
           "target"_a, "decimate"_a = 1.0,
           "decimate: tags are looked for in a picture that is smaller by this factor.")
      .def(
          "detect",
          [](const TargetDetector& self, const Dense<std::uint8_t>& pixels,
             const std::string& image) {
            TargetView view;
            view.image = image;
            const GreyImage grey = GreyOf(pixels);
            const py::gil_scoped_release released;
            view.corners = self.Detect(grey);
            return view;
          },
          "pixels"_a, "image"_a = "",
          "What is seen in (height, width) shades; without corners where there is no target.  "
          "`image` is its name.");
  m.def(
      "guess_target",
      [](const std::vector<Dense<std::uint8_t>>& images) {
        std::vector<GreyImage> greys;
        for (const Dense<std::uint8_t>& image : images) greys.push_back(GreyOf(image));
        const py::gil_scoped_release released;
        return GuessTarget(greys);
      },
      "images"_a,
      "What target (height, width) pictures show, of a nominal size; None: nothing fits.");
  m.def("expand_images", &ExpandImages, "words"_a,
        "Files, the pictures of folders, and patterns with * and ?.");
  py::class_<FoundDetections>(m, "FoundDetections", "What was found in images.")
      .def_readonly("detections", &FoundDetections::detections, "Corners by view.")
      .def_readonly("files", &FoundDetections::files, "By view, the image that it is of.")
      .def_readonly("target", &FoundDetections::target, "What was looked for.")
      .def_readonly("is_guessed", &FoundDetections::is_guessed, "Its size is nominal then.")
      .def_property_readonly(
          "skipped",
          [](const FoundDetections& self) {
            std::vector<std::pair<std::string, std::string>> skipped;
            for (const SkippedImage& image : self.skipped)
              skipped.emplace_back(image.image, image.reason);
            return skipped;
          },
          "Images without corners, and why.");
  m.def(
      "detect_all",
      [](const std::vector<std::string>& images, const std::optional<Target>& target,
         const std::string& camera, std::size_t threads) {
        DetectAllOptions options;
        options.target = target;
        options.camera = camera;
        options.threads = threads;
        const py::gil_scoped_release released;
        return DetectAll(images, options);
      },
      "images"_a, "target"_a = py::none(), "camera"_a = "cam0", "threads"_a = 0,
      "Finds the target in images, or in a video.  target: None: it is guessed.  threads: 0: as "
      "many as there are cores.");
}

void BindSimulation(py::module_& m) {
  py::class_<TargetLayout>(m, "TargetLayout", "A target as guidance and simulation see it.")
      .def("__len__", [](const TargetLayout& self) { return self.corners.size(); })
      .def_property_readonly(
          "corners",
          [](const TargetLayout& self) {
            std::vector<double> rows;
            for (const TargetCorner& corner : self.corners)
              rows.insert(rows.end(), corner.in_target.begin(), corner.in_target.end());
            return Owned(std::move(rows), {static_cast<py::ssize_t>(self.corners.size()), 3});
          },
          "(n, 3) in the target's frame [m].")
      .def_property_readonly(
          "ids",
          [](const TargetLayout& self) {
            std::vector<int> ids;
            for (const TargetCorner& corner : self.corners) ids.push_back(corner.id);
            return Owned(std::move(ids));
          },
          "(n,)");
  m.def("layout_of", &LayoutOf, "target"_a, "A target as its description has it.");
  m.def("aprilcal_mosaic", &AprilCalMosaic, "columns"_a = 8, "rows"_a = 6, "pitch_m"_a = 0.0381,
        "A mosaic of tag36h11, pitch_m from a tag to the next; by default AprilCal's.");
  m.def(
      "study_lenses",
      [] {
        std::vector<std::pair<std::string, CameraIntrinsics>> lenses;
        for (const StudyLens& lens : StudyLenses()) lenses.emplace_back(lens.name, lens.camera);
        return lenses;
      },
      "Six cameras like those of thesis Figure 5.8.");
  py::enum_<Person>(m, "Person", "Who chooses where the target goes.")
      .value("NOVICE", Person::kNovice, "Whole, near the middle, hardly tilted.")
      .value("ROS_RULES", Person::kRosRules, "As the ROS tutorial says.");
  m.def(
      "simulate_detections",
      [](const CameraIntrinsics& camera, const TargetLayout& target, Person person,
         std::size_t frames, double sigma_px, std::uint64_t seed) {
        CalibrationSimulation simulation;
        simulation.camera = camera;
        simulation.target = target;
        simulation.sigma_px = sigma_px;
        simulation.seed = seed;
        return SimulateDetections(simulation, person, frames).detections;
      },
      "camera"_a, "target"_a, py::arg_v("person", Person::kRosRules, "Person.ROS_RULES"),
      "frames"_a = 20, "sigma_px"_a = 0.1, "seed"_a = 1,
      "What a camera sees of a target that a person holds.  Same arguments, same digits.");
  m.def(
      "render_target",
      [](const Target& target, const Camera& camera,
         const std::optional<std::array<double, 7>>& camera_from_target, double blur_px,
         double noise, std::uint64_t seed) {
        RenderOptions options;
        options.blur_px = blur_px;
        options.noise = noise;
        RandomNumbers random(seed);
        return ArrayOf(TargetRenderer(target, camera, options).Render(camera_from_target, &random));
      },
      "target"_a, "camera"_a, "camera_from_target"_a = py::none(), "blur_px"_a = 0.5,
      "noise"_a = 2.0, "seed"_a = 1,
      "(height, width) shades: a picture of the target at a pose, (7,) x y z [m] qx qy qz qw; "
      "None: of the room alone.");
}

}  // namespace

void BindTargets(py::module_& module) {
  BindTarget(module);
  BindDetection(module);
  BindSimulation(module);
}

}  // namespace graticule::python
