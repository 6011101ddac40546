#include "graticule/problems/urban/town_scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/problems/segmentation/scene_sensors.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Eigen::Vector3d;

constexpr double kLidarHeight = 1, kFarthest = 80;  // m
constexpr std::uint32_t kGround = 1, kFirstWall = 2, kLastWall = 19, kFirstThing = 20;
constexpr std::uint64_t kPointStream = 3;

double HeightOf(TownThing thing) {
  switch (thing) {
    case TownThing::kOpen:
      return 0;
    case TownThing::kWall:
    case TownThing::kPartition:
      return 3;
    case TownThing::kFurniture:
      return 0.75;
    case TownThing::kTree:
      return 4;
    case TownThing::kCar:
      return 1.5;
  }
  return 0;
}

// A town whose cells are prisms, as high as what stands on them.
class Prisms {
 public:
  explicit Prisms(const Town& town) : town_(town), grid_(town.grid) { FindPieces(); }

  /// Which tree or car is there; 0: none.
  std::uint32_t OutdoorsAt(double x, double y) const {
    const auto column = static_cast<long>(std::floor(x / grid_.resolution));
    const auto row = static_cast<long>(std::floor(y / grid_.resolution));
    return IsInside(column, row) && town_.things[Index(column, row)] > TownThing::kFurniture
               ? piece_of_[Index(column, row)]
               : 0;
  }

  // Amanatides and Woo's traversal, with heights.
  std::optional<SceneHit> Cast(const SceneRay& ray) {
    const Vector3d &o = ray.origin, &d = ray.direction;
    const double res = grid_.resolution;
    auto column = static_cast<long>(std::floor(o.x() / res));
    auto row = static_cast<long>(std::floor(o.y() / res));
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double per_x = d.x() != 0 ? res / std::abs(d.x()) : kNever;
    const double per_y = d.y() != 0 ? res / std::abs(d.y()) : kNever;
    const long step_x = d.x() > 0 ? 1 : -1, step_y = d.y() > 0 ? 1 : -1;
    const auto first = [&](double at, long cell, double direction) {
      const double edge = static_cast<double>(direction > 0 ? cell + 1 : cell) * res;
      return direction != 0 ? (edge - at) / direction : kNever;
    };
    double next_x = first(o.x(), column, d.x()), next_y = first(o.y(), row, d.y());
    const double ground = d.z() < 0 ? -o.z() / d.z() : kNever;
    double enter = 0;
    int side = 2;  // the axis of the face that the cell is entered by; 2: began in it
    while (enter < kFarthest && IsInside(column, row)) {
      const double leave = std::min(next_x, next_y);
      const TownThing thing = town_.things[Index(column, row)];
      const double height = HeightOf(thing);
      if (height > 0 && enter < ground) {
        if (o.z() + enter * d.z() <= height) return Seen(ray, enter, side, column, row);
        const double top = (height - o.z()) / d.z();
        if (d.z() < 0 && top <= leave) return Seen(ray, top, 2, column, row);
      }
      if (ground <= leave) return Ground(ray, ground);
      enter = leave;
      side = next_x < next_y ? 0 : 1;
      if (side == 0) {
        next_x += per_x;
        column += step_x;
      } else {
        next_y += per_y;
        row += step_y;
      }
    }
    return std::nullopt;
  }

 private:
  bool IsInside(long column, long row) const {
    return column >= 0 && row >= 0 && column < static_cast<long>(grid_.width) &&
           row < static_cast<long>(grid_.height);
  }
  std::size_t Index(long column, long row) const {
    return static_cast<std::size_t>(row) * grid_.width + static_cast<std::size_t>(column);
  }

  bool IsThing(std::size_t cell) const { return town_.things[cell] >= TownThing::kFurniture; }

  // Cells of a kind that touch are one piece: a tree, a wall as far as its next door.
  void FindPieces() {
    piece_of_.assign(town_.things.size(), 0);
    std::uint32_t count = 0;
    std::vector<std::size_t> open;
    for (std::size_t start = 0; start < piece_of_.size(); ++start) {
      const TownThing kind = town_.things[start];
      if (piece_of_[start] != 0 || kind == TownThing::kOpen) continue;
      ++count;
      open.assign(1, start);
      piece_of_[start] = count;
      while (!open.empty()) {
        const auto column = static_cast<long>(open.back() % grid_.width);
        const auto row = static_cast<long>(open.back() / grid_.width);
        open.pop_back();
        for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          if (!IsInside(column + dx, row + dy)) continue;
          const std::size_t beside = Index(column + dx, row + dy);
          if (piece_of_[beside] != 0 || town_.things[beside] != kind) continue;
          piece_of_[beside] = count;
          open.push_back(beside);
        }
      }
    }
  }

  // The number of a house; of the town's own wall, how many there are.
  std::size_t HouseAt(long column, long row) const {
    const double x = (static_cast<double>(column) + 0.5) * grid_.resolution;
    const double y = (static_cast<double>(row) + 0.5) * grid_.resolution;
    const auto is_in = [&](const Town::House& house) {
      return x > house.x0 && x < house.x1 && y > house.y0 && y < house.y1;
    };
    return static_cast<std::size_t>(std::find_if(town_.houses.begin(), town_.houses.end(), is_in) -
                                    town_.houses.begin());
  }

  // Faces of walls get labels in the order in which they are first seen.
  std::uint32_t LabelOfFace(int side, long column, long row) {
    const long plane = side == 0 ? column : side == 1 ? row : 0;
    const std::tuple<std::size_t, int, long> face{HouseAt(column, row), side, plane};
    const auto next =
        static_cast<std::uint32_t>(std::min<std::size_t>(kFirstWall + faces_.size(), kLastWall));
    return faces_.try_emplace(face, next).first->second;
  }

  static std::optional<SceneHit> Ground(const SceneRay& ray, double at) {
    if (at > kFarthest) return std::nullopt;
    const Vector3d place = ray.origin + at * ray.direction;
    // Slabs of 1.5 m.
    const auto slab = static_cast<long>(std::floor(place.x() / 1.5)) +
                      static_cast<long>(std::floor(place.y() / 1.5));
    return SceneHit{at, kGround,
                    Vector3d(116, 114, 110) + (slab % 2 == 0 ? 6 : 0) * Vector3d::Ones()};
  }

  std::optional<SceneHit> Seen(const SceneRay& ray, double at, int side, long column, long row) {
    const Vector3d place = ray.origin + at * ray.direction;
    const std::size_t cell = Index(column, row);
    const double light = side == 2 ? 1.1 : side == 0 ? 0.82 : 1;
    SceneHit hit;
    hit.distance_m = at;
    Vector3d colour;
    switch (town_.things[cell]) {
      case TownThing::kWall: {
        constexpr double kHouses[4][3] = {
            {176, 110, 88}, {206, 196, 170}, {150, 164, 178}, {190, 160, 110}};
        colour = Vector3d(kHouses[HouseAt(column, row) % 4]);
        // Windows, which no laser tells from the wall.
        const double along = side == 0 ? place.y() : place.x();
        const double in_bay = along - 3 * std::floor(along / 3);
        if (side != 2 && in_bay > 1 && in_bay < 2.2 && place.z() > 1 && place.z() < 2.2)
          colour = Vector3d(62, 72, 86);
        hit.label = LabelOfFace(side, column, row);
        break;
      }
      case TownThing::kPartition:
        colour = Vector3d(214, 212, 204);
        hit.label = LabelOfFace(side, column, row);
        break;
      case TownThing::kTree:
        colour = Vector3d(92, 70, 46);
        break;
      case TownThing::kCar: {
        constexpr double kCars[4][3] = {
            {150, 30, 34}, {40, 62, 120}, {200, 200, 204}, {52, 92, 62}};
        colour = Vector3d(kCars[piece_of_[cell] % 4]);
        break;
      }
      default:
        colour = Vector3d(150, 116, 74);
    }
    if (IsThing(cell)) hit.label = kFirstThing + piece_of_[cell];
    hit.colour = light * colour;
    return hit;
  }

  const Town& town_;
  const OccupancyGrid& grid_;
  std::vector<std::uint32_t> piece_of_;  // 0: none
  std::map<std::tuple<std::size_t, int, long>, std::uint32_t> faces_;
};

// How many trees and cars there are 3 to 12 m ahead, each seen by a few beams of a fan of half a
// circle.
std::size_t ThingsAhead(const Town& town, const Prisms& prisms, const PlanarPose& pose) {
  std::map<std::uint32_t, int> beams;
  for (int i = -45; i <= 45; ++i) {
    const double angle = pose.yaw + i * M_PI / 180;
    const double range = CastRay(town.grid, pose.x, pose.y, angle, 12);
    if (range < 3 || range >= 12) continue;
    const double into = range + town.grid.resolution / 2;
    ++beams[prisms.OutdoorsAt(pose.x + into * std::cos(angle), pose.y + into * std::sin(angle))];
  }
  beams.erase(0);
  return static_cast<std::size_t>(std::count_if(
      beams.begin(), beams.end(), [](const auto& thing) { return thing.second >= 3; }));
}

PlanarPose BestPlace(const SimulatedMission& mission, std::size_t robot, const Prisms& prisms) {
  std::optional<PlanarPose> best;
  std::size_t most = 0;
  const LaserLog& log = mission.mission.log;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (log.scans[i].robot != robot) continue;
    const PlanarPose& pose = mission.world_from_robot[i];
    const std::size_t things = ThingsAhead(mission.town, prisms, pose);
    if (best && things <= most) continue;
    best = pose;
    most = things;
  }
  if (!best) throw Error("a scene needs a robot with a scan", ErrorKind::kUsage);
  return *best;
}

// The camera looks ahead, 8 cm above the LIDAR and 3 cm to the left, screwed on by hand: turned by
// two degrees or so.
Eigen::Isometry3d CameraFromLidar() {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Vector3d turn(0.021, -0.034, 0.016);
  Eigen::Isometry3d camera_from_lidar = Eigen::Isometry3d::Identity();
  camera_from_lidar.linear() =
      Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * axes;
  camera_from_lidar.translation() = -camera_from_lidar.linear() * Vector3d(0.02, 0.03, 0.08);
  return camera_from_lidar;
}

// A point of the scan in each part of the image where there is one that the camera sees.
void PickPoints(Prisms* prisms, const Eigen::Isometry3d& world_from_lidar,
                const Eigen::Isometry3d& camera_from_lidar, std::uint64_t seed, TownScene* town) {
  constexpr int kColumns = 7, kRows = 5;
  constexpr double kSigmaPx = 1;
  const PointCloud& cloud = town->scene.cloud;
  const Camera camera(town->scene.camera);
  std::vector<std::pair<std::size_t, Eigen::Vector2d>> parts[kColumns * kRows];
  const Eigen::Isometry3d world_from_camera = world_from_lidar * camera_from_lidar.inverse();
  for (std::size_t i = 0; i < cloud.in_sensor.size(); ++i) {
    if (cloud.labels[i] == 0) continue;
    const Vector3d in_camera = camera_from_lidar * cloud.in_sensor[i].cast<double>();
    const auto pixel = camera.Project(in_camera);
    if (!pixel || pixel->x() < 8 || pixel->y() < 8 || pixel->x() > camera.Width() - 9 ||
        pixel->y() > camera.Height() - 9)
      continue;
    const auto part = static_cast<int>(pixel->x() * kColumns / camera.Width()) +
                      kColumns * static_cast<int>(pixel->y() * kRows / camera.Height());
    parts[part].emplace_back(i, *pixel);
  }
  RandomNumbers random(seed, kPointStream);
  for (const auto& part : parts) {
    for (int tries = 0; tries < 20 && !part.empty(); ++tries) {
      const auto& [i, pixel] = part[random.Below(part.size())];
      const Vector3d in_camera = camera_from_lidar * cloud.in_sensor[i].cast<double>();
      const auto seen = prisms->Cast(
          {world_from_camera.translation(), world_from_camera.linear() * in_camera.normalized()});
      if (!seen || std::abs(seen->distance_m - in_camera.norm()) > 0.1) continue;  // hidden
      Correspondence point;
      for (Eigen::Index k = 0; k < 3; ++k)
        point.in_lidar[static_cast<std::size_t>(k)] =
            std::round(1000 * static_cast<double>(cloud.in_sensor[i][k])) / 1000;
      for (Eigen::Index k = 0; k < 2; ++k)
        point.pixel[static_cast<std::size_t>(k)] =
            std::round(10 * (pixel[k] + kSigmaPx * random.Normal())) / 10;
      town->points.push_back(point);
      break;
    }
  }
  // Two of them are mistaken for something else.
  const std::size_t count = town->points.size();
  if (count < 16) return;
  for (const std::size_t wrong : {count / 3, 2 * count / 3}) {
    const double angle = random.Uniform(0, 2 * M_PI), off = random.Uniform(20, 60);
    std::array<double, 2>& pixel = town->points[wrong].pixel;
    pixel[0] = std::round(10 * (pixel[0] + off * std::cos(angle))) / 10;
    pixel[1] = std::round(10 * (pixel[1] + off * std::sin(angle))) / 10;
    town->wrong.push_back(wrong);
  }
}

}  // namespace

TownScene SimulateTownScene(const SimulatedMission& mission, std::size_t robot,
                            const CameraIntrinsics& camera, std::uint64_t seed) {
  Prisms prisms(mission.town);
  TownScene town;
  town.world_from_robot = BestPlace(mission, robot, prisms);
  Eigen::Isometry3d world_from_lidar = Eigen::Isometry3d::Identity();
  world_from_lidar.linear() =
      Eigen::AngleAxisd(town.world_from_robot.yaw, Vector3d::UnitZ()).toRotationMatrix();
  world_from_lidar.translation() =
      Vector3d(town.world_from_robot.x, town.world_from_robot.y, kLidarHeight);
  const Eigen::Isometry3d camera_from_lidar = CameraFromLidar();
  SceneOptions options;
  options.seed = seed;
  const RayCaster cast = [&](const SceneRay& ray) { return prisms.Cast(ray); };
  town.scene.cloud = SweepScene(cast, world_from_lidar, options);
  town.scene.camera = camera;
  town.scene.camera_from_lidar = PoseOf(camera_from_lidar);
  town.scene.image = PhotographScene(cast, Camera(camera),
                                     world_from_lidar * camera_from_lidar.inverse(), options);
  PickPoints(&prisms, world_from_lidar, camera_from_lidar, seed, &town);
  return town;
}

}  // namespace graticule
