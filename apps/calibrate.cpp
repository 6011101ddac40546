#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "calibration_input.hpp"
#include "commands.hpp"
#include "graticule/factors/camera_model.hpp"
#include "graticule/io/camera_file.hpp"
#include "graticule/problems/calibration/bootstrap.hpp"
#include "graticule/problems/calibration/max_ere.hpp"
#include "graticule/problems/calibration/posterior.hpp"
#include "graticule/problems/calibration/select_model.hpp"
#include "graticule/solver/schema.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

// "ros:camera.yaml" as a format and a path; without a known word before the colon all is the path.
struct Output {
  std::optional<CameraFormat> format;
  std::string path;
};

Output OutputOf(const std::string& words) {
  const std::size_t colon = words.find(':');
  if (colon == std::string::npos || colon == 0) return {std::nullopt, words};
  return {CameraFormatFromWord(words.substr(0, colon)), words.substr(colon + 1)};
}

BoardShape BoardOf(const std::string& word) {
  return word == "free"     ? BoardShape::kFree
         : word == "warped" ? BoardShape::kWarped
                            : BoardShape::kFlat;
}

// What is said of one camera.
struct CameraAnswer {
  std::vector<double> deviations;  // of its parameters
  EreMap compensated, raw;
};

struct Answer {
  ModelSelection selection;
  Posterior posterior;
  std::vector<CameraAnswer> cameras;

  const Calibration& Solved() const { return selection.calibration; }
  double MaxErePx() const {
    double worst = 0;
    for (const CameraAnswer& camera : cameras) worst = std::max(worst, camera.compensated.MaxPx());
    return worst;
  }
};

Answer Solve(const CalibrateCommand& command, const Registry& types, const Detections& detections,
             const Console& console) {
  CalibrationOptions options;
  options.sigma_px = command.sigma_px;
  std::vector<std::string> models;
  if (command.model != "auto") models = {CameraModelOf(command.model).name};
  std::vector<BoardShape> boards = {BoardShape::kFlat, BoardShape::kWarped, BoardShape::kFree};
  if (command.board != "auto") boards = {BoardOf(command.board)};
  console.Progress("looking for the camera");
  Answer answer;
  answer.selection = SelectModel(types, detections, options, models, boards);
  const Calibration& solved = answer.Solved();
  PosteriorOptions posterior;
  posterior.sigma_px = command.sigma_px > 0 ? command.sigma_px : solved.sigma_px;
  posterior.board = answer.selection.options.board;
  posterior.corner_sigma_m = CornerSigma(detections, answer.selection.options);
  answer.posterior = ComputePosterior(detections, solved.state, solved.use, posterior);
  for (std::size_t c = 0; c < solved.state.cameras.size(); ++c) {
    const Camera camera(solved.state.cameras[c]);
    CameraAnswer one;
    one.deviations = answer.posterior.Deviations("camera:" + std::to_string(c));
    const Eigen::MatrixXd covariance = answer.posterior.OfCamera(c);
    EreOptions ere;
    if (command.range_m > 0) ere.range_m = command.range_m;
    one.compensated = EreGrid(camera, ere).Map(covariance);
    MarkReached(detections, c, solved.use, &one.compensated);
    ere.gauge = EreGauge::kRaw;
    one.raw = EreGrid(camera, ere).Map(covariance);
    answer.cameras.push_back(std::move(one));
  }
  console.Progress("");
  return answer;
}

std::string WhereOf(const EreMap& map) {
  const ErePoint* worst = map.Worst();
  if (!worst) return "nowhere";
  return fmt::format("{:.3g} px at ({:.0f}, {:.0f}){}", worst->ere_px, worst->pixel.x(),
                     worst->pixel.y(), worst->is_reached ? "" : ", where no corner was seen");
}

std::string Verdict(const CalibrateCommand& command, const Answer& answer) {
  if (!answer.posterior.Constrained()) return DescribeUnconstrained(answer.posterior);
  const double max = answer.MaxErePx();
  return fmt::format("{} px asked for: {}", command.accuracy_px,
                     max <= command.accuracy_px ? "met" : "not met");
}

void PrintSummary(const CalibrateCommand& command, const Detections& detections,
                  const Answer& answer) {
  const Calibration& solved = answer.Solved();
  const ModelSelection& selection = answer.selection;
  fmt::print("{}\n", Described(detections));
  const ModelTrial& chosen = selection.trials[selection.chosen];
  fmt::print("  model         {}{}\n", chosen.model,
             selection.trials.size() > 1
                 ? fmt::format(", chosen of {} (held-out mean {:.4f} px)", selection.trials.size(),
                               chosen.held_out.mean_px)
                 : "");
  fmt::print("  target        {}", BoardShapeName(selection.options.board));
  for (const ModelTrial& shape : selection.shapes)
    fmt::print("{} {} {:.4f} px", &shape == &selection.shapes.front() ? "; held-out mean:" : ",",
               BoardShapeName(shape.board), shape.held_out.mean_px);
  fmt::print("\n");
  for (std::size_t c = 0; c < answer.cameras.size(); ++c) {
    const CameraIntrinsics& camera = solved.state.cameras[c];
    const Fields fields = ParseFields(CameraModelOf(camera.model).fields);
    if (answer.cameras.size() > 1) fmt::print("  camera        {}\n", camera.name);
    for (std::size_t i = 0; i < fields.size(); ++i)
      fmt::print("  {:<13} {:>12.6g} ± {:.2g} {}\n", fields[i].name, camera.parameters[i],
                 answer.cameras[c].deviations[i], fields[i].unit);
    fmt::print("  Max ERE       {} (the frame's rotation taken out); {} raw\n",
               WhereOf(answer.cameras[c].compensated), WhereOf(answer.cameras[c].raw));
  }
  fmt::print("  residuals     rms {:.4f} px, worst {:.3f} px, {:.4f} px on either axis\n",
             solved.rms_px, solved.worst_px, solved.sigma_px);
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
  fmt::print("  accuracy      {}\n", Verdict(command, answer));
}

nlohmann::ordered_json ErrorJson(const ReprojectionError& error) {
  return {{"views", error.views},
          {"corners", error.corners},
          {"unseen", error.unseen},
          {"mean_px", error.mean_px},
          {"rms_px", error.rms_px},
          {"median_px", error.median_px},
          {"p99.5_px", error.percentile_995_px},
          {"max_px", error.max_px}};
}

nlohmann::ordered_json EreJson(const EreMap& map) {
  const ErePoint* worst = map.Worst();
  if (!worst) return nullptr;
  return {{"max_px", worst->ere_px},
          {"at_px", {worst->pixel.x(), worst->pixel.y()}},
          {"a_corner_was_seen_near", worst->is_reached}};
}

nlohmann::ordered_json TrialJson(const ModelTrial& trial) {
  nlohmann::ordered_json json = {{"model", trial.model},
                                 {"board", BoardShapeName(trial.board)},
                                 {"parameters", trial.parameters}};
  if (!trial.failure.empty()) {
    json["failure"] = trial.failure;
    return json;
  }
  json["converged"] = trial.converged;
  json["rms_px"] = trial.rms_px;
  json["held_out"] = ErrorJson(trial.held_out);
  json["bic"] = trial.bic;
  return json;
}

nlohmann::ordered_json Json(const CalibrateCommand& command, const Detections& detections,
                            const Answer& answer) {
  const Calibration& solved = answer.Solved();
  nlohmann::ordered_json json;
  for (std::size_t c = 0; c < answer.cameras.size(); ++c) {
    const CameraIntrinsics& camera = solved.state.cameras[c];
    const Fields fields = ParseFields(CameraModelOf(camera.model).fields);
    nlohmann::ordered_json parameters;
    for (std::size_t i = 0; i < fields.size(); ++i)
      parameters[fields[i].name] = {{"value", camera.parameters[i]},
                                    {"deviation", answer.cameras[c].deviations[i]}};
    json["cameras"].push_back({{"name", camera.name},
                               {"width", camera.width},
                               {"height", camera.height},
                               {"model", camera.model},
                               {"parameters", parameters},
                               {"camera_from_rig", solved.state.camera_from_rig[c]},
                               {"max_ere",
                                {{"rotation_compensated", EreJson(answer.cameras[c].compensated)},
                                 {"raw", EreJson(answer.cameras[c].raw)}}}});
  }
  json["board"] = BoardShapeName(answer.selection.options.board);
  json["corners"] = solved.corners;
  json["rms_px"] = solved.rms_px;
  json["worst_px"] = solved.worst_px;
  json["sigma_px"] = solved.sigma_px;
  json["accuracy_px"] = command.accuracy_px;
  json["met"] = answer.posterior.Constrained() && answer.MaxErePx() <= command.accuracy_px;
  json["unconstrained"] = answer.posterior.unconstrained;
  json["set_aside"] = nlohmann::ordered_json::array();
  for (const Outlier& outlier : solved.outliers) {
    const TargetView& view = detections.views[outlier.view];
    json["set_aside"].push_back(
        {{"image", view.image},
         {"corner", view.corners[outlier.corner].id},
         {"error_px", std::isfinite(outlier.error_px) ? nlohmann::json(outlier.error_px)
                                                      : nlohmann::json(nullptr)}});
  }
  json["left_out"] = nlohmann::ordered_json::array();
  for (const std::size_t view : solved.left_out)
    json["left_out"].push_back(detections.views[view].image);
  for (const ModelTrial& trial : answer.selection.shapes)
    json["boards_tried"].push_back(TrialJson(trial));
  for (const ModelTrial& trial : answer.selection.trials)
    json["models_tried"].push_back(TrialJson(trial));
  return json;
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
  rig.meta["max_ere_px"] = fmt::format("{:.6g}", answer.MaxErePx());
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

}  // namespace

int Run(const CalibrateCommand& command, const Console& console) {
  std::vector<Output> outputs;
  for (const std::string& words : command.outputs) outputs.push_back(OutputOf(words));
  for (const Output& output : outputs) ExpectWritable(output.path);
  if (!command.record.empty()) ExpectEnding(command.record, "--record", ProblemEndings());
  const Registry types = LoadTypes(command.reading);
  const Detections detections = LoadDetections(command.sources, console);
  const Answer answer = Solve(command, types, detections, console);

  const CameraRig rig = RigOf(answer);
  for (const Output& output : outputs) WriteCameras(output.path, rig, output.format);
  if (!command.record.empty()) Record(command, types, detections, answer);
  if (command.json)
    fmt::print("{}\n", Json(command, detections, answer).dump(2));
  else
    PrintSummary(command, detections, answer);
  if (!answer.posterior.Constrained()) return kIllPosed;
  return ExitOf(answer.Solved().report.termination);
}

int Run(const CalibrateEvaluateCommand& command, const Console& console) {
  const CameraRig rig = ReadCameras(command.camera);
  const Detections test = LoadDetections(command.sources, console);
  CalibrationState state;
  for (const RigCamera& camera : rig.cameras) {
    state.cameras.push_back(camera.intrinsics);
    state.camera_from_rig.push_back(camera.camera_from_rig);
  }
  if (test.cameras.size() != state.cameras.size())
    throw Error(fmt::format("{} has {} cameras, the test set {}", command.camera,
                            state.cameras.size(), test.cameras.size()),
                ErrorKind::kUsage);
  for (std::size_t c = 0; c < test.cameras.size(); ++c) {
    CameraIntrinsics& camera = state.cameras[c];
    if (camera.width == 0) camera.width = test.cameras[c].width;
    if (camera.height == 0) camera.height = test.cameras[c].height;
    if (camera.width != test.cameras[c].width || camera.height != test.cameras[c].height)
      throw Error(fmt::format("{}: the camera's images have {} x {} pixels, the test set's {} x {}",
                              command.camera, camera.width, camera.height, test.cameras[c].width,
                              test.cameras[c].height));
  }
  const ReprojectionError error = EvaluateOn(state, test);
  nlohmann::ordered_json json = {{"test", ErrorJson(error)}};
  if (!command.json)
    fmt::print(
        "{}\n  the target's pose optimised for every view, the camera as it is\n"
        "  error         mean {:.4f} px, rms {:.4f}, median {:.4f}, 99.5 % {:.4f}, max {:.4f}\n"
        "  corners       {} in {} views; {} that the model has no image of\n",
        Described(test), error.mean_px, error.rms_px, error.median_px, error.percentile_995_px,
        error.max_px, error.corners, error.views, error.unseen);
  if (!command.against.empty()) {
    const CameraRig other = ReadCameras(command.against);
    if (other.cameras.size() != state.cameras.size())
      throw Error(command.against + ": expected as many cameras as " + command.camera + " has");
    for (std::size_t c = 0; c < state.cameras.size(); ++c) {
      CameraIntrinsics second = other.cameras[c].intrinsics;
      if (second.width == 0) second.width = state.cameras[c].width;
      if (second.height == 0) second.height = state.cameras[c].height;
      EreOptions options;
      options.columns = 41;
      options.rows = 31;
      const EreMap difference = ModelDifference(Camera(state.cameras[c]), Camera(second), options);
      json["difference"].push_back(EreJson(difference));
      if (!command.json)
        fmt::print("  difference    {} (the best rotation taken out)\n", WhereOf(difference));
    }
  }
  if (command.json) fmt::print("{}\n", json.dump(2));
  return kDone;
}

}  // namespace graticule::apps
