#include "bind.hpp"
#include "corners.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/difference.hpp"
#include "graticule/problems/calibration/jackknife.hpp"
#include "graticule/problems/calibration/session.hpp"

namespace graticule::python {
namespace {

using namespace py::literals;

py::array_t<double> SquareOf(const Eigen::MatrixXd& matrix) {
  // Symmetric: its columns are its rows.
  return py::array_t<double>(Shape{matrix.rows(), matrix.cols()}, matrix.data());
}

void BindPosterior(py::module_& m) {
  py::class_<Posterior>(m, "Posterior",
                        "What the views say of cameras, rig and board, the target's poses "
                        "marginalised (thesis, Equations 5.3 to 5.5).")
      .def_property_readonly(
          "blocks",
          [](const Posterior& self) {
            std::vector<std::pair<std::string, std::vector<std::string>>> blocks;
            for (const PosteriorBlock& block : self.blocks)
              blocks.emplace_back(block.key, block.fields);
            return blocks;
          },
          "Keys and fields, in the order of `covariance`.")
      .def_property_readonly(
          "covariance", [](const Posterior& self) { return SquareOf(self.covariance); },
          "(n, n) of all blocks.")
      .def_property_readonly(
          "information", [](const Posterior& self) { return SquareOf(self.information); },
          "(n, n) of all blocks.")
      .def_readonly("unconstrained", &Posterior::unconstrained,
                    "\"k4 of cam0\": what these views do not constrain.")
      .def(
          "of_camera",
          [](const Posterior& self, std::size_t camera) { return SquareOf(self.OfCamera(camera)); },
          "camera"_a = 0, "(parameters, parameters) covariance of a camera's parameters.")
      .def("deviations", &Posterior::Deviations, "key"_a,
           "Standard deviations of a block, in the order of its fields.")
      .def("__str__", &DescribeUnconstrained);
  m.def(
      "compute_posterior",
      [](const Detections& detections, const Calibration& solved, double sigma_px,
         const CalibrationOptions* options, bool raise_by_jackknife) {
        PosteriorOptions asked;
        asked.sigma_px = sigma_px > 0 ? sigma_px : solved.sigma_px;
        if (options) {
          asked.board = options->board;
          asked.corner_sigma_m = CornerSigma(detections, *options);
          asked.camera_priors = options->camera_priors;
        }
        const py::gil_scoped_release released;
        Posterior posterior = ComputePosterior(detections, solved.state, solved.use, asked);
        if (raise_by_jackknife)
          RaiseByJackknife(detections, solved.state, solved.use, asked, &posterior);
        return posterior;
      },
      "detections"_a, "solved"_a, "sigma_px"_a = 0.0, "options"_a = nullptr,
      "raise_by_jackknife"_a = false,
      "Of a calibration.  sigma_px: of a corner; 0: from the residuals.  raise_by_jackknife: to "
      "what the views say of each other, as `graticule calibrate` does.");
}

void BindMaxEre(py::module_& m) {
  py::class_<EreMap>(m, "EreMap", "Expected reprojection error over the image.")
      .def_property_readonly("max_px", &EreMap::MaxPx,
                             "The largest, Max ERE (thesis, section 5.2.1) [px].")
      .def_property_readonly(
          "worst",
          [](const EreMap& self) -> std::optional<Eigen::Vector2d> {
            const ErePoint* worst = self.Worst();
            return worst ? std::optional<Eigen::Vector2d>(worst->pixel) : std::nullopt;
          },
          "(2,) the pixel where it is; None: no pixel has a ray.")
      .def_property_readonly(
          "ere_px",
          [](const EreMap& self) {
            std::vector<double> values;
            for (const ErePoint& point : self.points)
              values.push_back(point.has_ray ? point.ere_px : std::nan(""));
            return Owned(std::move(values), {self.rows, self.columns});
          },
          "(rows, columns) [px]; nan: no ray.")
      .def_property_readonly(
          "pixels",
          [](const EreMap& self) {
            std::vector<double> values;
            for (const ErePoint& point : self.points)
              values.insert(values.end(), {point.pixel.x(), point.pixel.y()});
            return Owned(std::move(values), {self.rows, self.columns, 2});
          },
          "(rows, columns, 2) where.");
  m.def(
      "max_ere",
      [](const Camera& camera, const Dense<double>& covariance, int columns, int rows,
         const std::string& gauge, double range_m, const std::vector<Eigen::Vector2d>& seen) {
        const py::ssize_t size = camera.Model().parameters;
        ExpectShape(covariance, {size, size}, "covariance");
        EreOptions options;
        options.columns = columns;
        options.rows = rows;
        options.gauge = EreGaugeOf(gauge);
        options.range_m = range_m;
        options.gauge_pixels = seen;
        const Eigen::MatrixXd matrix =
            Eigen::Map<const Eigen::MatrixXd>(covariance.data(), size, size);
        return EreGrid(camera, options).Map(matrix);
      },
      "camera"_a, "covariance"_a, "columns"_a = 5, "rows"_a = 5, "gauge"_a = "rotation_compensated",
      "range_m"_a = std::numeric_limits<double>::infinity(),
      "seen"_a = std::vector<Eigen::Vector2d>(),
      "Expected reprojection error in closed form.  covariance: (parameters, parameters).  gauge: "
      "raw, rotation_compensated, motion_compensated (at range_m [m]).  seen: pixels over which "
      "the gauge's motion is fitted; empty: the whole image.");
  Record<DifferenceOptions>(m, "DifferenceOptions", "How two calibrations are compared.")
      .Field("nodes", &DifferenceOptions::nodes, "Along the longer side of the image.")
      .Field("range_m", &DifferenceOptions::range_m, "Of the points compared [m].");
  py::class_<CalibrationDifference>(m, "CalibrationDifference",
                                    "How far two calibrations of one camera are apart.")
      .def_readonly("mean_px", &CalibrationDifference::mean_px, "[px]")
      .def_readonly("rms_px", &CalibrationDifference::rms_px, "[px]")
      .def_readonly("max_px", &CalibrationDifference::max_px, "[px]")
      .def_readonly("max_at", &CalibrationDifference::max_at, "(2,) the pixel.")
      .def_property_readonly(
          "field_px",
          [](const CalibrationDifference& self) {
            return Frozen(self.field.values.data(), {static_cast<py::ssize_t>(self.field.rows),
                                                     static_cast<py::ssize_t>(self.field.columns)});
          },
          "(rows, columns) all over the image; nan: one has no ray there.");
  m.def(
      "difference",
      [](const Camera& first, const Camera& second, const DifferenceOptions* options) {
        return Difference(first, second, options ? *options : DifferenceOptions());
      },
      "first"_a, "second"_a, "options"_a = nullptr,
      "Pixels become rays by the first, the rays pixels by the second, after the turn that "
      "brings them nearest.");
}

void BindSuggest(py::module_& m) {
  py::class_<Suggestion>(m, "Suggestion", "A pose of the target that a person is asked to match.")
      .def_readonly("camera_from_target", &Suggestion::camera_from_target,
                    "(7,) x y z [m] qx qy qz qw.")
      .def_readonly("max_ere_px", &Suggestion::max_ere_px,
                    "That is expected with it [px]; 0: none is looked for yet.")
      .def_property_readonly(
          "ids", [](const Suggestion& self) { return ArraysOf(self.corners).ids; },
          "(n,) of the corners that would be seen.")
      .def_property_readonly(
          "pixels", [](const Suggestion& self) { return ArraysOf(self.corners).pixels; },
          "(n, 2) where its corners would appear.");
  m.def(
      "suggest_pose",
      [](const Detections& detections, const Calibration& solved, const Posterior& posterior,
         const TargetLayout& target, std::size_t camera) {
        if (camera >= solved.state.cameras.size())
          throw Error("there is no camera " + std::to_string(camera), ErrorKind::kUsage);
        const Camera model(solved.state.cameras[camera]);
        SuggestOptions options;
        options.sigma_px = solved.sigma_px;
        options.ere.gauge_pixels = SeenPixels(detections, camera, solved.use);
        const PosteriorBlock& block = posterior.Block("camera:" + std::to_string(camera));
        const py::gil_scoped_release released;
        return SuggestPose(model, target, InformationOfCamera(posterior, camera),
                           posterior.scales.segment(block.offset, model.Model().parameters),
                           options);
      },
      "detections"_a, "solved"_a, "posterior"_a, "target"_a, "camera"_a = 0,
      "Where the target should be held next, so that Max ERE falls most; None: it cannot be "
      "seen.");
  py::enum_<FrameVerdict>(m, "FrameVerdict", "What became of a frame.")
      .value("USED", FrameVerdict::kUsed, "It counts.")
      .value("TOO_FEW_CORNERS", FrameVerdict::kTooFewCorners, "Not kept.")
      .value("NOT_EXPLAINED", FrameVerdict::kNotExplained, "Kept; a later frame may explain it.");
  py::class_<CalibrationSession>(m, "CalibrationSession",
                                 "A guided calibration without a screen: frames go in, advice "
                                 "comes out (thesis, section 5.2).")
      .def(py::init([](const TargetLayout& target, const ImageSize& image,
                       const CalibrationOptions* options, double accuracy_px) {
             SessionOptions asked;
             if (options) asked.calibration = *options;
             asked.accuracy_px = accuracy_px;
             return std::make_unique<CalibrationSession>(Builtins(), target, image, asked);
           }),
           "target"_a, "image"_a, "options"_a = nullptr, "accuracy_px"_a = 1.0,
           "accuracy_px: Max ERE that is enough [px].")
      .def(
          "add_frame",
          [](CalibrationSession& self, const TargetView& view) {
            const py::gil_scoped_release released;
            return self.AddFrame(view.corners);
          },
          "view"_a, "Adds a frame and solves again.")
      .def_property_readonly("frame_count", &CalibrationSession::FrameCount, "That were kept.")
      .def_property_readonly("frames", &CalibrationSession::Frames, "What was seen.")
      .def_property_readonly("solved", &CalibrationSession::Solved,
                             "None before a frame was explained.")
      .def_property_readonly("uncertainty", &CalibrationSession::Uncertainty, "Of the same.")
      .def_property_readonly("is_bootstrapping", &CalibrationSession::IsBootstrapping,
                             "Parameters are held by what was known before.")
      .def_property_readonly("accuracy_met", &CalibrationSession::AccuracyMet,
                             "Every parameter is constrained, and Max ERE is small enough.")
      .def("max_ere", &CalibrationSession::MaxEre, "Over the image.")
      .def(
          "suggest",
          [](const CalibrationSession& self) {
            const py::gil_scoped_release released;
            return self.Suggest();
          },
          "What to show the camera next; None: the target cannot be seen at all.");
}

}  // namespace

void BindUncertainty(py::module_& module) {
  BindPosterior(module);
  BindMaxEre(module);
  BindSuggest(module);
}

}  // namespace graticule::python
