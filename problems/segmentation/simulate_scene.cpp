#include "graticule/problems/segmentation/simulate_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/segmentation/scene_sensors.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Eigen::Vector3d;

using Ray = SceneRay;

enum class Shape { kFloor, kSlope, kWall, kBox, kCylinder, kBall };

// Things stand on z = 0 at `place`, but for balls (their centre) and walls (any point of them).
struct Thing {
  Shape shape;
  std::uint32_t label;
  Vector3d place, size;  // size: of a box in x, y, z; radius and height; normal of a wall
  Vector3d colour;
};

constexpr double kNever = std::numeric_limits<double>::infinity();

double FirstPositive(double near, double far) {
  return near > 1e-6 ? near : far > 1e-6 ? far : kNever;
}

double HitBox(const Ray& ray, const Thing& thing) {
  const Vector3d low = thing.place - Vector3d(thing.size.x() / 2, thing.size.y() / 2, 0);
  const Vector3d high = low + thing.size;
  double enter = -kNever, leave = kNever;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double a = (low[k] - ray.origin[k]) / ray.direction[k];
    const double b = (high[k] - ray.origin[k]) / ray.direction[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? FirstPositive(enter, leave) : kNever;
}

double HitCylinder(const Ray& ray, const Thing& thing) {
  const double radius = thing.size.x(), height = thing.size.z();
  const Vector3d from = ray.origin - thing.place;
  const Vector3d& d = ray.direction;
  const double a = d.x() * d.x() + d.y() * d.y(), b = from.x() * d.x() + from.y() * d.y();
  const double c = from.x() * from.x() + from.y() * from.y() - radius * radius;
  const double root = b * b - a * c;
  double hit = kNever;
  if (root >= 0 && a > 0) {
    const double side = (-b - std::sqrt(root)) / a;
    const double z = from.z() + side * d.z();
    if (side > 1e-6 && z >= 0 && z <= height) hit = side;
  }
  const double lid = (height - from.z()) / d.z();
  const Vector3d at = from + lid * d;
  if (lid > 1e-6 && at.x() * at.x() + at.y() * at.y() <= radius * radius) hit = std::min(hit, lid);
  return hit;
}

double HitBall(const Ray& ray, const Thing& thing) {
  const Vector3d from = ray.origin - thing.place;
  const double b = from.dot(ray.direction);
  const double root = b * b - from.squaredNorm() + thing.size.x() * thing.size.x();
  return root < 0 ? kNever : FirstPositive(-b - std::sqrt(root), -b + std::sqrt(root));
}

// The hill's ground, with bumps of 3 cm.
double SlopeHeight(double x, double y) {
  return 0.12 * std::max(0.0, x - 2) + 0.015 * std::sin(5 * x + 2 * y) +
         0.015 * std::sin(3 * x - 7 * y);
}

double HitSlope(const Ray& ray) {
  double before = 0;
  for (double at = 0.05; at < 40; at += 0.02 + 0.01 * at) {
    Vector3d point = ray.origin + at * ray.direction;
    if (point.z() > SlopeHeight(point.x(), point.y())) {
      before = at;
      continue;
    }
    double after = at;
    for (int k = 0; k < 30; ++k) {
      const double middle = (before + after) / 2;
      point = ray.origin + middle * ray.direction;
      (point.z() > SlopeHeight(point.x(), point.y()) ? before : after) = middle;
    }
    return after;
  }
  return kNever;
}

double Hit(const Ray& ray, const Thing& thing) {
  double at = kNever;
  switch (thing.shape) {
    case Shape::kFloor:
      at = -ray.origin.z() / ray.direction.z();
      break;
    case Shape::kSlope:
      return HitSlope(ray);
    case Shape::kWall:
      at = (thing.place - ray.origin).dot(thing.size) / ray.direction.dot(thing.size);
      break;
    case Shape::kBox:
      return HitBox(ray, thing);
    case Shape::kCylinder:
      return HitCylinder(ray, thing);
    case Shape::kBall:
      return HitBall(ray, thing);
  }
  return at > 1e-6 ? at : kNever;
}

const Thing* FirstHit(const std::vector<Thing>& things, const Ray& ray, double* distance) {
  const Thing* first = nullptr;
  *distance = kNever;
  for (const Thing& thing : things) {
    const double at = Hit(ray, thing);
    if (at >= *distance) continue;
    *distance = at;
    first = &thing;
  }
  return first;
}

std::vector<Thing> Hallway() {
  const Vector3d grey(118, 116, 112), cream(205, 198, 180), blue(40, 70, 150);
  return {
      {Shape::kFloor, 1, {0, 0, 0}, {0, 0, 0}, grey},
      {Shape::kWall, 2, {0, 1.6, 0}, {0, 1, 0}, cream},
      {Shape::kWall, 3, {0, -1.6, 0}, {0, 1, 0}, cream},
      {Shape::kWall, 4, {7.5, 0, 0}, {1, 0, 0}, {150, 160, 190}},
      {Shape::kCylinder, 20, {3.2, 0.9, 0}, {0.22, 0, 0.6}, grey + Vector3d(4, 4, 4)},
      {Shape::kBox, 30, {4.2, -1.25, 0}, {0.5, 0.5, 0.8}, blue},
      {Shape::kBox, 40, {5.6, 0.3, 0}, {0.6, 0.4, 0.45}, {170, 120, 70}},
      {Shape::kBall, 50, {2.6, -0.5, 0.2}, {0.2, 0, 0}, {200, 60, 40}},
      {Shape::kCylinder, 60, {4.6, 1.3, 0}, {0.2, 0, 1.0}, cream - Vector3d(6, 6, 6)},
  };
}

std::vector<Thing> Hill() {
  const Vector3d grass(196, 190, 150);
  const auto on_slope = [](double x, double y) { return Vector3d(x, y, SlopeHeight(x, y) - 0.05); };
  return {
      {Shape::kSlope, 1, {0, 0, 0}, {0, 0, 0}, grass},
      {Shape::kCylinder, 20, on_slope(3.5, 0.8), {0.25, 0, 0.85}, {226, 160, 110}},
      {Shape::kCylinder, 30, on_slope(4.5, -0.9), {0.25, 0, 0.85}, {226, 160, 110}},
      {Shape::kCylinder, 40, on_slope(6.0, 0.1), {0.22, 0, 3.0}, {190, 170, 140}},
      {Shape::kBox, 50, on_slope(5.0, 1.9), {0.6, 0.6, 0.7}, {214, 205, 180}},
  };
}

// Light falls from above, softly.
std::optional<SceneHit> Cast(const std::vector<Thing>& things, const Ray& ray) {
  double distance;
  const Thing* thing = FirstHit(things, ray, &distance);
  if (!thing) return std::nullopt;
  double shade = 1;
  if (thing->shape == Shape::kCylinder || thing->shape == Shape::kBall) {
    const Vector3d at = ray.origin + distance * ray.direction;
    Vector3d normal = at - thing->place;
    if (thing->shape == Shape::kCylinder)
      normal.z() = at.z() > thing->place.z() + thing->size.z() - 1e-6 ? 10 : 0;
    shade = 0.85 + 0.15 * normal.normalized().dot(Vector3d(-0.4, 0.3, 1).normalized());
  }
  return SceneHit{distance, thing->label, shade * thing->colour};
}

}  // namespace

SimulatedScene SimulateScene(std::string_view name, const SceneOptions& options) {
  if (name != "hallway" && name != "hill")
    throw Error("no such scene: '" + std::string(name) + "'; expected hallway, hill",
                ErrorKind::kUsage);
  const std::vector<Thing> things = name == "hill" ? Hill() : Hallway();
  SimulatedScene scene;
  const double focal = 752 / (2 * std::tan(111.0 / 360 * M_PI)) * 1.35;
  scene.camera = {"cam0", "brown5", 752, 480, {focal, focal, 375.5, 239.5, -0.22, 0.04, 0, 0, 0}};
  // The camera looks ahead, 8 cm above the LIDAR and 3 cm to the left.
  Eigen::Matrix3d camera_turn;
  camera_turn << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Eigen::Isometry3d camera_from_lidar = Eigen::Isometry3d::Identity();
  camera_from_lidar.linear() = camera_turn;
  camera_from_lidar.translation() = -camera_turn * Vector3d(0.02, 0.03, 0.08);
  scene.camera_from_lidar = PoseOf(camera_from_lidar);
  Eigen::Isometry3d world_from_lidar = Eigen::Isometry3d::Identity();
  world_from_lidar.translation() = Vector3d(0, 0, 1);

  const RayCaster cast = [&](const Ray& ray) { return Cast(things, ray); };
  scene.cloud = SweepScene(cast, world_from_lidar, options);
  scene.image = PhotographScene(cast, Camera(scene.camera),
                                world_from_lidar * camera_from_lidar.inverse(), options);
  return scene;
}

}  // namespace graticule
