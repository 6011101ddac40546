#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.hpp"
#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/correspondences.hpp"
#include "graticule/io/detections.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/rig.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/calibration/target_pose.hpp"
#include "graticule/problems/segmentation/coregister_error.hpp"
#include "graticule/problems/segmentation/coregister_evaluate.hpp"
#include "outputs.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

constexpr double kDegree = M_PI / 180;

// Boards whose planes were measured, with the poses that the camera sees.
std::vector<BoardSighting> ReadBoards(const CoregisterCommand& command, const Camera& camera,
                                      double sigma_px) {
  std::vector<BoardSighting> boards;
  if (command.planes.empty() != command.detections.empty())
    throw Error("--planes and --detections go together", ErrorKind::kUsage);
  if (command.planes.empty()) return boards;
  const Detections detections = ReadDetections({command.detections});
  std::map<std::string, const TargetView*> views;
  for (const TargetView& view : detections.views) views[view.image] = &view;
  for (const MeasuredPlane& plane : ParsePlanes(ReadFile(command.planes), command.planes)) {
    const auto view = views.find(plane.image);
    if (view == views.end())
      throw Error(
          fmt::format("{}: {} has no view '{}'", command.planes, command.detections, plane.image));
    CornerPairs corners;
    for (const DetectedCorner& corner : view->second->corners) {
      corners.in_target.emplace_back(corner.in_target.data());
      corners.pixels.emplace_back(corner.pixel.data());
    }
    const auto pose = FindTargetPose(camera, corners, 3 * sigma_px);
    if (!pose)
      throw Error(
          fmt::format("{}: the board of '{}' has no pose", command.detections, plane.image));
    boards.push_back({plane.image, PoseOf(pose->camera_from_target),
                      Eigen::Vector3d(plane.normal.data()), plane.offset_m});
  }
  return boards;
}

// The nearest, the median and the farthest of the points, from the camera.
std::vector<double> RangesOf(const CoregisterData& data, const Coregistration& solved) {
  std::vector<double> ranges;
  const Eigen::Isometry3d camera_from_lidar = IsometryOf(solved.state.camera_from_lidar);
  for (std::size_t i = 0; i < data.points.size(); ++i)
    if (solved.use[i])
      ranges.push_back(
          (camera_from_lidar * Eigen::Vector3d(data.points[i].in_lidar.data())).norm());
  for (const BoardSighting& board : data.boards)
    ranges.push_back(Eigen::Vector3d(board.camera_from_board.data()).norm());
  std::sort(ranges.begin(), ranges.end());
  return {ranges.front(), ranges[ranges.size() / 2], ranges.back()};
}

struct Answer {
  Coregistration solved;
  HeldOut held_out;
  std::vector<FreedParameter> tried;
  CoregisterOptions options;
  std::vector<ExtrinsicError> errors;
  NextCorrespondence next;
  /// How far the camera is from where another rig has it.
  struct Apart {
    double metres, degrees;
  };
  std::optional<Apart> apart;
};

// Where the camera is on the LIDAR, by either.
Answer::Apart ApartOf(const Se3Array& camera_from_lidar, const Se3Array& other) {
  const Eigen::Isometry3d one = IsometryOf(camera_from_lidar).inverse();
  const Eigen::Isometry3d two = IsometryOf(other).inverse();
  return {(one.translation() - two.translation()).norm(),
          Eigen::AngleAxisd(one.linear().transpose() * two.linear()).angle() / kDegree};
}

std::string NameOf(const CoregisterData& data, std::size_t i) {
  return i < data.points.size() ? data.points[i].name : data.boards[i - data.points.size()].name;
}

nlohmann::ordered_json JsonOf(const CoregisterData& data, const Answer& answer) {
  const Coregistration& solved = answer.solved;
  nlohmann::ordered_json json = {
      {"camera_from_lidar", solved.state.camera_from_lidar},
      {"camera",
       {{"model", solved.state.camera.model}, {"parameters", solved.state.camera.parameters}}},
      {"points", data.points.size()},
      {"boards", data.boards.size()},
      {"rms_px", solved.rms_px},
      {"noise_scale", solved.scale},
      {"region_95", solved.region_95}};
  for (int row = 0; row < 6; ++row) {
    std::vector<double> values;
    for (int column = 0; column < 6; ++column) values.push_back(solved.covariance(row, column));
    json["covariance"].push_back(values);
  }
  json["outliers"] = nlohmann::ordered_json::array();
  for (const std::size_t i : solved.outliers) json["outliers"].push_back(NameOf(data, i));
  const std::vector<Eigen::Vector2d> residuals = PointResiduals(solved.state, data.points);
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    nlohmann::ordered_json point = {{"name", data.points[i].name}, {"counts", solved.use[i] != 0}};
    point["residual_px"] = {residuals[i].x(), residuals[i].y()};
    point["held_out_px"] = answer.held_out.distances_px[i];
    json["residuals"].push_back(point);
  }
  json["held_out"] = {{"rms_px", answer.held_out.rms_px},
                      {"rms_counted_px", answer.held_out.rms_counted_px},
                      {"median_px", answer.held_out.median_px}};
  for (const FreedParameter& tried : answer.tried)
    json["freed"].push_back(
        {{"parameter", tried.name}, {"held_out_px", tried.held_out_px}, {"kept", tried.is_kept}});
  for (const ExtrinsicError& error : answer.errors)
    json["expected_error"].push_back({{"range_m", error.range_m},
                                      {"max_px", error.max_px},
                                      {"at_px", {error.max_at.x, error.max_at.y}}});
  json["next"] = {{"at_px", {answer.next.pixel.x, answer.next.pixel.y}},
                  {"range_m", answer.next.range_m},
                  {"max_px_before", answer.next.max_px_before},
                  {"max_px", answer.next.max_px}};
  if (answer.apart)
    json["apart"] = {{"m", answer.apart->metres}, {"degrees", answer.apart->degrees}};
  return json;
}

void Print(const CoregisterCommand& command, const CoregisterData& data, const Answer& answer) {
  const Coregistration& solved = answer.solved;
  const Se3Array& pose = solved.state.camera_from_lidar;
  const auto deviation = [&](int i) { return std::sqrt(solved.covariance(i, i)); };
  fmt::print("{}: {} correspondences, {} boards; {} of {} parameters estimated\n", command.camera,
             data.points.size(), data.boards.size(), solved.freedoms,
             6 + solved.state.camera.parameters.size());
  fmt::print("  camera from lidar   [{:.5f} {:.5f} {:.5f}] m, [{:.6f} {:.6f} {:.6f} {:.6f}]\n",
             pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6]);
  fmt::print(
      "  known to            {:.1f} {:.1f} {:.1f} mm and {:.3f} {:.3f} {:.3f} degrees (one "
      "standard "
      "deviation)\n",
      1e3 * deviation(0), 1e3 * deviation(1), 1e3 * deviation(2), deviation(3) / kDegree,
      deviation(4) / kDegree, deviation(5) / kDegree);
  if (!data.points.empty())
    fmt::print(
        "  residuals           rms {:.2f} px; left out in turn {:.2f} px (all points {:.2f}, "
        "median "
        "{:.2f})\n",
        solved.rms_px, answer.held_out.rms_counted_px, answer.held_out.rms_px,
        answer.held_out.median_px);
  std::string outliers;
  const std::vector<Eigen::Vector2d> residuals = PointResiduals(solved.state, data.points);
  for (const std::size_t i : solved.outliers) {
    outliers += (outliers.empty() ? "" : ", ") + NameOf(data, i);
    if (i < data.points.size()) outliers += fmt::format(" ({:.0f} px)", residuals[i].norm());
  }
  fmt::print("  outliers            {}\n", outliers.empty() ? "none" : outliers);
  for (const FreedParameter& tried : answer.tried)
    fmt::print("  {:<12} freed  left out in turn {:.2f} px: {}\n", tried.name, tried.held_out_px,
               tried.is_kept ? "kept" : "not kept");
  for (const ExtrinsicError& error : answer.errors)
    fmt::print("  expected error      {:.2f} px at most at {:.1f} m, at ({:.0f}, {:.0f})\n",
               error.max_px, error.range_m, error.max_at.x, error.max_at.y);
  fmt::print(
      "  next                a point near ({:.0f}, {:.0f}) at {:.1f} m: {:.2f} -> {:.2f} px\n",
      answer.next.pixel.x, answer.next.pixel.y, answer.next.range_m, answer.next.max_px_before,
      answer.next.max_px);
  if (answer.apart)
    fmt::print("  apart               {:.1f} mm and {:.3f} degrees from {}\n",
               1e3 * answer.apart->metres, answer.apart->degrees, command.against);
}

void WritePicture(const std::string& path, const std::string& svg) {
  WriteFile(path, Ending(path) == ".png" ? PngFromSvg(svg, 1000) : svg);
}

void WriteResiduals(const CoregisterCommand& command, const CoregisterData& data,
                    const Answer& answer) {
  const CameraIntrinsics& camera = answer.solved.state.camera;
  ResidualPicture picture;
  picture.title = "Correspondences: from where each was seen to where it is projected";
  picture.width = camera.width;
  picture.height = camera.height;
  const auto residuals = PointResiduals(answer.solved.state, data.points);
  for (std::size_t i = 0; i < data.points.size(); ++i)
    picture.corners.push_back({0,
                               static_cast<int>(i),
                               {data.points[i].pixel[0], data.points[i].pixel[1]},
                               {residuals[i].x(), residuals[i].y()},
                               answer.solved.use[i] == 0});
  WritePicture(command.picture, DrawResiduals(picture));
}

void WriteErrorMap(const CoregisterCommand& command, const Answer& answer) {
  ErrorMap map;
  map.title = "Expected error of the LIDAR's points in the image";
  map.subtitle = fmt::format("of the extrinsics, at {:.1f} m", answer.errors[0].range_m);
  map.field = answer.errors[0].field;
  map.max_px = answer.errors[0].max_px;
  map.max_at = answer.errors[0].max_at;
  WritePicture(command.error_map, DrawErrorMap(map));
}

void WriteRigOf(const CoregisterCommand& command, const Answer& answer) {
  LidarRig rig;
  rig.camera = answer.solved.state.camera;
  rig.camera_from_lidar = answer.solved.state.camera_from_lidar;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column)
      rig.covariance.push_back(answer.solved.covariance(row, column));
  rig.meta["made-by"] = MadeBy("coregister");
  rig.meta["rms_px"] = fmt::format("{:.6g}", answer.solved.rms_px);
  rig.meta["held_out_px"] = fmt::format("{:.6g}", answer.held_out.rms_counted_px);
  WriteRig(command.output, rig);
}

void Record(const CoregisterCommand& command, const Registry& types, const CoregisterData& data,
            const Answer& answer) {
  Recording recording(types);
  recording.graph = BuildCoregistration(types, data, answer.solved.state, answer.solved.use,
                                        answer.options, answer.solved.scale);
  recording.title =
      fmt::format("co-registration: {} points, {} boards", data.points.size(), data.boards.size());
  recording.made_by = MadeBy("coregister");
  WriteProblem(command.record, recording, {});
}

}  // namespace

int Run(const CoregisterCommand& command, const Console& console) {
  if (!command.record.empty()) ExpectEnding(command.record, "--record", ProblemEndings());
  for (const auto& [path, option] :
       {std::pair(&command.picture, "--plot"), std::pair(&command.error_map, "--error-map")})
    if (!path->empty()) ExpectEnding(*path, option, {".svg", ".png"});
  for (const std::string& path :
       {command.output, command.record, command.picture, command.error_map})
    ExpectWritable(path);
  if (command.points.empty() && command.planes.empty())
    throw Error("expected --points, or --detections with --planes", ErrorKind::kUsage);
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (!is_finite(command.sigma_px) || !is_finite(command.sigma_m) ||
      !std::all_of(command.ranges_m.begin(), command.ranges_m.end(), is_finite))
    throw Error("--sigma, --lidar-sigma and --range have to be finite", ErrorKind::kUsage);
  const Registry types = LoadTypes(command.reading);
  const CameraIntrinsics intrinsics = ReadCamera(command.camera);
  const Camera camera = About(command.camera, [&] { return Camera(intrinsics); });

  std::optional<Se3Array> other;
  if (!command.against.empty()) other = ReadRig(command.against).camera_from_lidar;

  Answer answer;
  answer.options.sigma_m = command.sigma_m;
  answer.options.outlier_share = command.outlier_share;
  answer.options.sigmas_are_known = command.sigma_px > 0;
  if (command.sigma_px > 0) answer.options.sigma_px = command.sigma_px;
  CoregisterData data;
  if (!command.points.empty()) data.points = ReadCorrespondences(command.points);
  data.boards = ReadBoards(command, camera, answer.options.sigma_px);

  const std::string& source = command.points.empty() ? command.planes : command.points;
  About(source, [&] {
    answer.solved = Coregister(types, data, intrinsics, answer.options);
    if (command.free_parameters) {
      FreedCoregistration freed = FreeParameters(types, data, answer.solved, answer.options);
      answer.solved = std::move(freed.solved);
      answer.held_out = std::move(freed.held_out);
      answer.options = std::move(freed.options);
      answer.tried = std::move(freed.tried);
    } else {
      answer.held_out = LeaveOneOut(types, data, answer.solved, answer.options);
    }
    return 0;
  });
  const Camera solved_camera(answer.solved.state.camera);
  const std::vector<double> ranges =
      command.ranges_m.empty() ? RangesOf(data, answer.solved) : command.ranges_m;
  answer.errors = ExpectedErrors(solved_camera, answer.solved.state.camera_from_lidar,
                                 answer.solved.covariance, ranges);
  answer.next = SuggestCorrespondence(solved_camera, answer.solved, answer.options, ranges);

  if (other) answer.apart = ApartOf(answer.solved.state.camera_from_lidar, *other);

  Outputs outputs(console);
  outputs.Try(command.output, [&] { WriteRigOf(command, answer); });
  outputs.Try(command.record, [&] { Record(command, types, data, answer); });
  outputs.Try(command.picture, [&] { WriteResiduals(command, data, answer); });
  outputs.Try(command.error_map, [&] { WriteErrorMap(command, answer); });
  if (command.json) {
    fmt::print("{}\n", JsonText(JsonOf(data, answer), 2));
  } else {
    Print(command, data, answer);
  }
  if (outputs.Failure() != kDone) return outputs.Failure();
  return ExitOf(answer.solved.report.termination);
}

}  // namespace graticule::apps
