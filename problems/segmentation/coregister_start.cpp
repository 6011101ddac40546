#include "graticule/problems/segmentation/coregister_start.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <optional>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostTriples = 500;
constexpr double kFarOff = 1e4;  // px: of a point that the camera has no image of

using Triple = std::array<std::size_t, 3>;

std::vector<Triple> Triples(std::size_t count, std::uint64_t seed) {
  std::vector<Triple> triples;
  if (count * (count - 1) * (count - 2) / 6 <= kMostTriples) {
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = a + 1; b < count; ++b)
        for (std::size_t c = b + 1; c < count; ++c) triples.push_back({a, b, c});
    return triples;
  }
  RandomNumbers random(seed);
  while (triples.size() < kMostTriples) {
    const Triple t = {random.Below(count), random.Below(count), random.Below(count)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triples.push_back(t);
  }
  return triples;
}

// The poses from which three points are seen along three rays; at most four.
std::vector<Eigen::Isometry3d> PosesOf(const std::array<Eigen::Vector3d, 3>& points,
                                       const std::array<Eigen::Vector3d, 3>& rays) {
  // OpenCV's sees forward only: a camera turned to the middle of the rays stands in for ours.
  const Eigen::Vector3d middle = rays[0] + rays[1] + rays[2];
  if (!(middle.norm() > 1e-3)) return {};
  const Eigen::Quaterniond turned_from_camera =
      Eigen::Quaterniond::FromTwoVectors(middle, Eigen::Vector3d::UnitZ());
  std::vector<cv::Point3d> in_lidar;
  std::vector<cv::Point2d> seen;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d ray = turned_from_camera * rays[i];
    if (!(ray.z() > 0.05)) return {};
    in_lidar.emplace_back(points[i].x(), points[i].y(), points[i].z());
    seen.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  const Eigen::Vector3d a = points[1] - points[0], b = points[2] - points[0];
  if (!(a.cross(b).norm() > 1e-3 * a.norm() * b.norm())) return {};
  std::vector<cv::Mat> turns, shifts;
  cv::solveP3P(in_lidar, seen, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts,
               cv::SOLVEPNP_AP3P);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Eigen::Vector3d w(turns[i].at<double>(0), turns[i].at<double>(1), turns[i].at<double>(2));
    const Eigen::Vector3d t(shifts[i].at<double>(0), shifts[i].at<double>(1),
                            shifts[i].at<double>(2));
    if (!w.allFinite() || !t.allFinite()) continue;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const double angle = w.norm();
    if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    pose.translation() = t;
    poses.push_back(turned_from_camera.conjugate() * pose);
  }
  return poses;
}

// The distance that half of the points and two keep below.
double MedianDistance(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                      const std::vector<Correspondence>& data,
                      const Eigen::Isometry3d& camera_from_lidar, std::vector<double>* distances) {
  distances->clear();
  const CameraModel& model = camera.Model();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_lidar * points[i];
    Eigen::Vector2d pixel;
    const bool is_seen = model.project(camera.Intrinsics().parameters.data(), in_camera.data(),
                                       pixel.data(), nullptr, nullptr);
    distances->push_back(
        is_seen ? std::min(kFarOff, (pixel - Eigen::Vector2d(data[i].pixel.data())).norm())
                : kFarOff);
  }
  const auto at = distances->begin() + static_cast<std::ptrdiff_t>((points.size() + 3) / 2);
  std::nth_element(distances->begin(), at, distances->end());
  return *at;
}

bool AreAlike(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < 0.05;
}

std::vector<CoregisterStart> Ranked(const std::vector<Eigen::Vector3d>& points,
                                    const std::vector<Correspondence>& data, const Camera& camera,
                                    std::uint64_t seed, std::size_t most) {
  std::vector<std::optional<Eigen::Vector3d>> rays;
  for (const Correspondence& point : data)
    rays.push_back(camera.Unproject(Eigen::Vector2d(point.pixel.data())));
  struct Candidate {
    Eigen::Isometry3d pose;
    double median;
  };
  std::vector<Candidate> candidates;
  std::vector<double> distances;
  for (const auto& [a, b, c] : Triples(points.size(), seed)) {
    if (!rays[a] || !rays[b] || !rays[c]) continue;
    for (const Eigen::Isometry3d& pose :
         PosesOf({points[a], points[b], points[c]}, {*rays[a], *rays[b], *rays[c]}))
      candidates.push_back({pose, MedianDistance(camera, points, data, pose, &distances)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.median < b.median; });
  std::vector<CoregisterStart> starts;
  std::vector<Eigen::Isometry3d> taken;
  for (const Candidate& candidate : candidates) {
    if (starts.size() == most || candidate.median > 3 * candidates[0].median + 3) break;
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const auto& other) { return AreAlike(other, candidate.pose); }))
      continue;
    taken.push_back(candidate.pose);
    starts.push_back({PoseOf(candidate.pose), candidate.median});
  }
  return starts;
}

void RefuseALine(const std::vector<Eigen::Vector3d>& points, double sigma_m) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) middle += point;
  middle /= static_cast<double>(points.size());
  Eigen::MatrixXd about(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    about.col(static_cast<Eigen::Index>(i)) = points[i] - middle;
  const Eigen::Vector3d extent = Eigen::JacobiSVD<Eigen::MatrixXd>(about).singularValues() /
                                 std::sqrt(static_cast<double>(points.size()));
  if (extent[1] > 1e-3 * extent[0] && extent[1] > sigma_m) return;
  throw Error("the LIDAR's points lie on a line, to " + Shown(extent[1]) +
                  " m: the camera may turn about it; expected points in space",
              ErrorKind::kIllPosed);
}

std::vector<CoregisterStart> FromPoints(const CoregisterData& data, const Camera& camera,
                                        const CoregisterOptions& options, std::size_t most) {
  std::vector<Eigen::Vector3d> points, mirrored;
  for (const Correspondence& point : data.points) {
    points.emplace_back(point.in_lidar.data());
    mirrored.emplace_back(point.in_lidar[0], -point.in_lidar[1], point.in_lidar[2]);
  }
  RefuseALine(points, options.sigma_m);
  std::vector<CoregisterStart> starts = Ranked(points, data.points, camera, options.seed, most);
  const double diagonal = std::hypot(camera.Width(), camera.Height());
  const double median = starts.empty() ? kFarOff : starts[0].median_px;
  // The mirror image of points in a plane is the same points turned round.
  if (median > 5 && points.size() > 4) {
    const auto other = Ranked(mirrored, data.points, camera, options.seed, 1);
    if (!other.empty() && other[0].median_px < median / 4)
      throw Error("the correspondences fit as their mirror image only (half of them within " +
                      Shown(other[0].median_px) + " px, else " + Shown(median) +
                      "): one axis of the LIDAR's frame points the other way",
                  ErrorKind::kIllPosed);
  }
  if (median > diagonal / 20)
    throw Error("no pose of the camera explains half of the correspondences: the best leaves " +
                    Shown(median) + " px; are points and pixels in the same order?",
                ErrorKind::kIllPosed);
  return starts;
}

// Normals turn the frames into each other, then distances shift them.
CoregisterStart FromBoards(const std::vector<BoardSighting>& boards) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), across = Eigen::Matrix3d::Zero();
  std::vector<Eigen::Vector3d> in_camera, in_lidar;
  std::vector<double> offsets;
  for (const BoardSighting& board : boards) {
    const Eigen::Isometry3d camera_from_board = IsometryOf(board.camera_from_board);
    // Both toward the sensor that saw the board.
    Eigen::Vector3d a = camera_from_board.linear().col(2), b = board.normal_in_lidar;
    if (a.dot(camera_from_board.translation()) > 0) a = -a;
    const double turned = board.offset_m > 0 ? -1 : 1;
    b *= turned;
    in_camera.push_back(a);
    in_lidar.push_back(b);
    offsets.push_back(a.dot(camera_from_board.translation()) - turned * board.offset_m);
    sum += a * b.transpose();
    across += a * a.transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> spread(across);
  if (spread.singularValues()[2] < 1e-3 * static_cast<double>(boards.size()))
    throw Error(
        "the boards' planes leave the camera free to move along them: expected three that "
        "are tilted against each other",
        ErrorKind::kIllPosed);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < boards.size(); ++i) right += in_camera[i] * offsets[i];
  pose.translation() = across.inverse() * right;
  return {PoseOf(pose), 0};
}

}  // namespace

std::vector<CoregisterStart> FindCoregisterStarts(const CoregisterData& data, const Camera& camera,
                                                  const CoregisterOptions& options,
                                                  std::size_t most) {
  if (data.points.size() >= 4) return FromPoints(data, camera, options, most);
  if (data.boards.size() >= 3) return {FromBoards(data.boards)};
  throw Error("expected at least 4 correspondences (6 to see which is wrong) or 3 boards, found " +
                  std::to_string(data.points.size()) + " and " + std::to_string(data.boards.size()),
              ErrorKind::kIllPosed);
}

}  // namespace graticule
