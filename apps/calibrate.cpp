#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "calibration_input.hpp"
#include "camera_output.hpp"
#include "commands.hpp"
#include "graticule/factors/camera_model.hpp"
#include "graticule/io/calibration_report.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/photo.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/jackknife.hpp"
#include "graticule/problems/calibration/picture_data.hpp"
#include "graticule/problems/calibration/suggest.hpp"
#include "graticule/solver/stopwatch.hpp"
#include "output_folder.hpp"
#include "outputs.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

BoardShape BoardOf(const std::string& word) {
  return word == "free"     ? BoardShape::kFree
         : word == "warped" ? BoardShape::kWarped
                            : BoardShape::kFlat;
}

// Ctrl-C came before there was a camera.
struct Stopped {};
void GoOnOrStop() {
  if (Interruptible::WasAsked()) throw Stopped();
}

constexpr double kSuspect = 1e-3;  // image diagonals: ten times what poor detectors leave

constexpr int kFewest = 4;  // views, of which one is left out

struct Answer {
  ModelSelection selection;
  Posterior posterior;
  CalibrationReport report;

  const Calibration& Solved() const { return selection.calibration; }
};

ModelSelection Select(const CalibrateCommand& command, const Registry& types,
                      const Detections& detections) {
  CalibrationOptions options;
  options.sigma_px = command.sigma_px;
  options.before_solve = GoOnOrStop;
  std::vector<std::string> models;
  if (command.model != "auto") models = {CameraModelOf(command.model).name};
  std::vector<BoardShape> boards = {BoardShape::kFlat, BoardShape::kWarped, BoardShape::kFree};
  if (command.board != "auto") boards = {BoardOf(command.board)};
  return SelectModel(types, detections, options, models, boards);
}

Posterior PosteriorOf(const CalibrateCommand& command, const Detections& detections,
                      const ModelSelection& selection, double* raised) {
  const Calibration& solved = selection.calibration;
  PosteriorOptions options;
  options.sigma_px = command.sigma_px > 0 ? command.sigma_px : solved.sigma_px;
  options.board = selection.options.board;
  options.corner_sigma_m = CornerSigma(detections, selection.options);
  Posterior posterior = ComputePosterior(detections, solved.state, solved.use, options);
  *raised = RaiseByJackknife(detections, solved.state, solved.use, options, &posterior);
  return posterior;
}

// The target as its corners say, seen from the side that was seen.
TargetLayout LayoutSeen(const Detections& detections, const CalibrationState& state) {
  TargetLayout layout;
  layout.corners_per_tag = 1;
  std::map<int, std::array<double, 3>> places;
  int votes = 0;
  for (const TargetView& view : detections.views) {
    for (const DetectedCorner& corner : view.corners) places.emplace(corner.id, corner.in_target);
    if (!state.rig_from_target[view.exposure]) continue;
    const Eigen::Isometry3d pose = IsometryOf(state.camera_from_rig[view.camera]) *
                                   IsometryOf(*state.rig_from_target[view.exposure]);
    votes += pose.linear().col(2).dot(pose.translation()) > 0 ? 1 : -1;
  }
  for (const auto& [id, place] : places) layout.corners.push_back({id, place});
  layout.printed_towards_z = votes < 0;
  return layout;
}

// Where the target should be held next, drawn into the report of each camera.
void AddSuggestions(const Detections& detections, const std::optional<Target>& target,
                    double raised, Answer* answer) {
  const Calibration& solved = answer->Solved();
  const TargetLayout layout = target ? LayoutOf(*target) : LayoutSeen(detections, solved.state);
  for (std::size_t c = 0; c < solved.state.cameras.size(); ++c) {
    const Camera camera(solved.state.cameras[c]);
    SuggestOptions options;
    options.sigma_px = solved.sigma_px * std::sqrt(raised);
    options.ere.gauge_pixels = SeenPixels(detections, c, solved.use);
    const PosteriorBlock& block = answer->posterior.Block("camera:" + std::to_string(c));
    const auto suggestion = SuggestPose(
        camera, layout, InformationOfCamera(answer->posterior, c) / raised,
        answer->posterior.scales.segment(block.offset, camera.Model().parameters), options);
    if (!suggestion) continue;
    SuggestionPicture picture;
    picture.width = camera.Width();
    picture.height = camera.Height();
    picture.quads = QuadsOf(layout, suggestion->corners, &picture.names);
    picture.max_px_after = suggestion->max_ere_px;
    answer->report.cameras[c].suggestion = std::move(picture);
  }
}

// Of each camera the image that shows its lens best, where there are images.
std::vector<std::optional<ShownImage>> ImagesToShow(const CalibrationInput& input,
                                                    const CalibrationState& state) {
  std::vector<std::optional<ShownImage>> images(state.cameras.size());
  for (std::size_t c = 0; c < images.size(); ++c) {
    const auto view = FarthestView(input.detections, c, Camera(state.cameras[c]));
    if (view && *view < input.files.size() && !input.files[*view].empty())
      images[c] = {ReadGreyPhoto(input.files[*view]), input.detections.views[*view].image};
  }
  return images;
}

Answer Solve(const CalibrateCommand& command, const Registry& types, const CalibrationInput& input,
             const Console& console) {
  const Detections& detections = input.detections;
  Answer answer;
  Stopwatch clock;
  console.Progress("looking for the camera");
  answer.selection = Select(command, types, detections);
  const double selected = clock.Elapsed().wall;
  clock = {};
  double raised = 1;
  answer.posterior = PosteriorOf(command, detections, answer.selection, &raised);
  graticule::DescribeOptions describe;
  describe.posterior = &answer.posterior;
  describe.accuracy_px = command.accuracy_px;
  // Finer than the thesis' 5 x 5, which misses the rim of circular images.
  describe.ere.columns = 33;
  describe.ere.rows = 25;
  if (command.range_m > 0) describe.ere.range_m = command.range_m;
  if (!command.report.empty() || !command.pictures.empty())
    describe.images = ImagesToShow(input, answer.Solved().state);
  answer.report = DescribeCalibration(detections, answer.selection, describe);
  const auto& poses = answer.Solved().state.rig_from_target;
  const auto exposures =
      std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); });
  if (answer.report.verdict == CalibrationVerdict::kMet && exposures < kFewest) {
    answer.report.verdict = CalibrationVerdict::kNotMet;
    answer.report.verdict_text = fmt::format(
        "{} views are too few to judge the model by views that it has not seen: take {} or more.",
        exposures, kFewest);
  }
  if (answer.report.verdict != CalibrationVerdict::kMet)
    AddSuggestions(detections, input.target, raised, &answer);
  if (raised > 1)
    answer.report.facts.emplace_back(
        "agreement", fmt::format("views disagree by more than their corners' noise: deviations are "
                                 "{:.1f} times as large as it alone would make them",
                                 std::sqrt(raised)));
  for (const CameraReport& camera : answer.report.cameras)
    if (camera.sigma_px > kSuspect * std::hypot(camera.camera.width, camera.camera.height))
      answer.report.warnings.push_back(fmt::format(
          "{}: residuals of {:.2g} px are far above a detector's: do the corners' places on the "
          "target, and their order, belong to it?",
          camera.camera.name, camera.sigma_px));
  answer.report.timings = {{"model and shape of the target", selected},
                           {"uncertainty and pictures", clock.Elapsed().wall}};
  console.Progress("");
  return answer;
}

void PrintSummary(const Detections& detections, const Answer& answer) {
  const Calibration& solved = answer.Solved();
  const ModelSelection& selection = answer.selection;
  fmt::print("{}\n", Described(detections));
  const ModelTrial& chosen = selection.trials[selection.chosen];
  fmt::print("  model         {}{}\n", chosen.model,
             selection.trials.size() > 1
                 ? fmt::format(", chosen of {} (held-out mean {:.4f} px)", selection.trials.size(),
                               chosen.held_out.mean_px)
                 : "");
  for (const auto& [what, text] : answer.report.facts)
    if (what == "agreement") fmt::print("  agreement     {}\n", text);
  fmt::print("  target        {}", BoardShapeName(selection.options.board));
  for (const ModelTrial& shape : selection.shapes)
    fmt::print("{} {} {:.4f} px", &shape == &selection.shapes.front() ? "; held-out mean:" : ",",
               BoardShapeName(shape.board), shape.held_out.mean_px);
  fmt::print("\n");
  for (const CameraReport& camera : answer.report.cameras) {
    if (answer.report.cameras.size() > 1) fmt::print("  camera        {}\n", camera.camera.name);
    for (const ReportedNumber& number : camera.numbers)
      fmt::print("  {:<13} {:>12.6g} ± {:.2g} {}{}\n", number.name, number.value, number.deviation,
                 number.unit, number.constrained ? "" : "  NOT CONSTRAINED");
    fmt::print("  Max ERE       {:.3g} px at ({:.0f}, {:.0f}), the frame's rotation taken out\n",
               camera.max_ere_px, camera.max_ere_at.x, camera.max_ere_at.y);
    for (const auto& [name, value] : camera.max_ere_variants)
      if (name.find(" over ") == std::string::npos)
        fmt::print("                {:.3g} px {}\n", value, name);
    fmt::print("  residuals     rms {:.4f} px, worst {:.3f} px, {:.4f} px on either axis\n",
               camera.rms_px, camera.worst_px, camera.sigma_px);
  }
  if (!solved.outliers.empty()) {
    fmt::print("  set aside     {} corners", solved.outliers.size());
    for (std::size_t i = 0; i < std::min<std::size_t>(solved.outliers.size(), 3); ++i) {
      const Outlier& outlier = solved.outliers[i];
      const TargetView& view = detections.views[outlier.view];
      fmt::print("{} {} of {} ({:.2g} px)", i == 0 ? ":" : ",", view.corners[outlier.corner].id,
                 view.image, outlier.error_px);
    }
    fmt::print("{}\n", solved.outliers.size() > 3 ? ", ..." : "");
  }
  for (const std::size_t view : solved.left_out)
    fmt::print("  left out      {}: no pose of the target explains it\n",
               detections.views[view].image);
  fmt::print("  verdict       {}\n", CalibrationVerdictText(answer.report));
  for (const std::string& advice : answer.report.advice) fmt::print("  advice        {}\n", advice);
  for (const std::string& warning : answer.report.warnings)
    fmt::print("  warning       {}\n", warning);
}

CameraRig RigOf(const Answer& answer) {
  const Calibration& solved = answer.Solved();
  CameraRig rig;
  for (std::size_t c = 0; c < solved.state.cameras.size(); ++c) {
    const Eigen::MatrixXd covariance = answer.posterior.OfCamera(c);
    rig.cameras.push_back({solved.state.cameras[c],
                           solved.state.camera_from_rig[c],
                           {covariance.data(), covariance.data() + covariance.size()}});
  }
  rig.meta["made-by"] = MadeBy("calibrate");
  rig.meta["rms_px"] = fmt::format("{:.6g}", solved.rms_px);
  rig.meta["sigma_px"] = fmt::format("{:.6g}", solved.sigma_px);
  for (std::size_t c = 0; c < answer.report.cameras.size(); ++c)
    rig.meta["max_ere_px:" + std::to_string(c)] =
        fmt::format("{:.6g}", answer.report.cameras[c].max_ere_px);
  return rig;
}

void Record(const CalibrateCommand& command, const Registry& types, const Detections& detections,
            const Answer& answer) {
  const Calibration& solved = answer.Solved();
  Recording recording(types);
  recording.graph = BuildCalibration(types, detections, solved.state, solved.use,
                                     answer.selection.options, solved.weight_sigma_px);
  recording.title = "calibration: " + Described(detections);
  recording.made_by = MadeBy("calibrate");
  WriteProblem(command.record, recording, {});
}

int Calibrate(const CalibrateCommand& command, const Console& console) {
  const std::vector<CameraOutput> cameras = CameraOutputsOf(command.outputs);
  if (!command.record.empty()) ExpectEnding(command.record, "--record", ProblemEndings());
  if (!command.report.empty()) ExpectEnding(command.report, "--report", {".html", ".json"});
  for (const std::string& path : {command.detections, command.record, command.report})
    ExpectWritable(path);
  std::optional<OutputFolder> pictures;
  if (!command.pictures.empty()) pictures.emplace(command.pictures);
  const Registry types = LoadTypes(command.reading);
  const CalibrationInput input = LoadCalibrationInput(command.sources, command.target,
                                                      command.image_topic, console, GoOnOrStop);
  const Detections& detections = input.detections;
  // Before the solve: where that is stopped, they need not be looked for again.
  Outputs outputs(console);
  outputs.Try(command.detections, [&] { WriteDetections(command.detections, detections); });
  Answer answer = Solve(command, types, input, console);
  for (const std::string& note : input.notes) answer.report.warnings.push_back(note);
  if (input.target) answer.report.facts.emplace_back("target", Described(*input.target));

  const CameraRig rig = RigOf(answer);
  for (const CameraOutput& camera : cameras)
    outputs.Try(camera.path, [&] { WriteCameras(camera.path, rig, camera.format); });
  outputs.Try(command.record, [&] { Record(command, types, detections, answer); });
  outputs.Try(command.pictures, [&] {
    for (const NamedPicture& picture : CalibrationPictures(answer.report)) {
      pictures->Write(picture.name + ".svg", picture.svg);
      pictures->Write(picture.name + ".png", PngFromSvg(picture.svg, 1000));
    }
  });
  const std::string json = CalibrationReportJson(answer.report);
  outputs.Try(command.report, [&] {
    WriteFile(command.report,
              Ending(command.report) == ".json" ? json : CalibrationReportHtml(answer.report));
  });
  if (command.json)
    fmt::print("{}", json);
  else
    PrintSummary(detections, answer);
  if (!answer.posterior.Constrained()) return kIllPosed;
  if (outputs.Failure() != kDone) return outputs.Failure();
  return ExitOf(answer.Solved().report.termination);
}

}  // namespace

int Run(const CalibrateCommand& command, const Console& console) {
  const Interruptible interruptible;
  try {
    return Calibrate(command, console);
  } catch (const Stopped&) {
    console.Progress("");
    console.Error("stopped before there was a camera: none is written");
    return kNotConverged;
  }
}

}  // namespace graticule::apps
