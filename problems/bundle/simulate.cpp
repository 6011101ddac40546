#include "graticule/problems/bundle/simulate.hpp"

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Camera = std::array<double, 9>;
using Pixel = Eigen::Vector2d;

// On the ring, a little up and down; looking along its -z at the middle, its y axis up.
Camera OnTheRing(const RingOptions& options, int index) {
  const double angle = 2 * M_PI * index / options.cameras;
  const Eigen::Vector3d centre(options.ring_m * std::cos(angle), options.ring_m * std::sin(angle),
                               0.1 * options.ring_m * std::sin(3 * angle));
  const Eigen::Vector3d back = centre.normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(back).normalized();
  Eigen::Matrix3d camera_from_world;
  camera_from_world << right.transpose(), back.cross(right).transpose(), back.transpose();
  const Eigen::AngleAxisd turn(camera_from_world);
  const Eigen::Vector3d w = turn.angle() * turn.axis(), t = -(camera_from_world * centre);
  return {w.x(), w.y(), w.z(), t.x(), t.y(), t.z(), options.focal_px, -0.05, 0.01};
}

// The published model, as bal_reprojection/1 states it.
Pixel Project(const Camera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d w(camera[0], camera[1], camera[2]);
  const double angle = w.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d p =
      Eigen::AngleAxisd(angle, axis) * point + Eigen::Vector3d(camera[3], camera[4], camera[5]);
  const Pixel flat = -p.head<2>() / p.z();
  const double n = flat.squaredNorm();
  return camera[6] * (1 + camera[7] * n + camera[8] * n * n) * flat;
}

}  // namespace

SimulatedBundle SimulateRing(const Registry& types, const RingOptions& options) {
  if (options.cameras < 2 || options.points < 1 || !(options.pixel_sigma > 0) ||
      !(options.cloud_m > 0) || !(options.ring_m > 2 * options.cloud_m))
    throw Error(
        "simulated ring: expected two cameras or more, a point or more, a pixel sigma above 0, and "
        "a ring of more than twice the cloud",
        ErrorKind::kUsage);
  RandomNumbers random(options.seed), noise(options.seed, 1), start(options.seed, 2);
  Graph graph(types);
  std::vector<Camera> cameras;
  std::vector<Eigen::Vector3d> points;
  const Graph::TypeId camera_type = graph.VariableTypeId("bal_camera/1");
  const Graph::TypeId point_type = graph.VariableTypeId("point3/1");
  const Graph::TypeId seen = graph.FactorTypeId("bal_reprojection/1");
  for (int i = 0; i < options.cameras; ++i) {
    cameras.push_back(OnTheRing(options, i));
    Camera believed = cameras.back();
    const bool fixed = i < 2;
    for (std::size_t k = 0; k < 6 && !fixed; ++k)
      believed[k] += (k < 3 ? options.camera_sigma_rad : options.camera_sigma_m) * start.Normal();
    graph.Add(Key("camera", static_cast<std::uint64_t>(i)), camera_type,
              {believed.data(), believed.size()}, fixed);
  }
  for (int i = 0; i < options.points; ++i) {
    Eigen::Vector3d point;
    for (double& x : point) x = random.Uniform(-options.cloud_m, options.cloud_m);
    points.push_back(point);
    for (double& x : point) x += options.point_sigma_m * start.Normal();
    graph.Add(Key("point", static_cast<std::uint64_t>(i)), point_type, {point.data(), 3}, false);
  }
  const std::vector<double> sigma = {options.pixel_sigma};
  const auto camera_count = static_cast<std::uint64_t>(options.cameras);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::uint64_t sure = random.Below(camera_count);
    for (std::uint64_t c = 0; c < camera_count; ++c) {
      const bool is_sure = c == sure || c == (sure + 1) % camera_count;
      if (random.Unit() >= options.visible && !is_sure) continue;
      Pixel pixel = Project(cameras[c], points[p]);
      for (double& x : pixel) x -= options.pixel_sigma * noise.Normal();
      const VariableId ends[2] = {static_cast<VariableId>(c),
                                  static_cast<VariableId>(camera_count + p)};
      graph.Add(seen, {ends, 2}, {pixel.data(), 2}, {NoiseKind::kSigma, sigma}, Loss{}, "image");
    }
  }
  Values truth = graph.InitialValues();
  for (std::size_t c = 0; c < cameras.size(); ++c)
    std::copy(cameras[c].begin(), cameras[c].end(), truth.Mutable(static_cast<VariableId>(c)));
  for (std::size_t p = 0; p < points.size(); ++p)
    std::copy(points[p].begin(), points[p].end(),
              truth.Mutable(static_cast<VariableId>(cameras.size() + p)));
  return {std::move(graph), std::move(truth)};
}

}  // namespace graticule
