#include "graticule/problems/segmentation/scene_sensors.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/random.hpp"

namespace graticule {
namespace {

using Eigen::Vector3d;

// Streams of a scene's seed.
constexpr std::uint64_t kLidarStream = 1, kCameraStream = 2;

std::uint8_t Channel(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

PointCloud SweepScene(const RayCaster& cast, const Eigen::Isometry3d& world_from_lidar,
                      const SceneOptions& options) {
  PointCloud cloud;
  cloud.width = options.bearings;
  cloud.height = options.scans;
  cloud.in_sensor.assign(cloud.width * cloud.height, kNoReturn);
  cloud.labels.assign(cloud.width * cloud.height, 0);
  RandomNumbers random(options.seed, kLidarStream);
  for (std::size_t row = 0; row < cloud.height; ++row)
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const double tilt =
          0.35 - options.sweep_rad * static_cast<double>(row) /
                     static_cast<double>(std::max<std::size_t>(cloud.height, 2) - 1);
      const double bearing = options.bearing_step_rad * (static_cast<double>(cloud.width - 1) / 2 -
                                                         static_cast<double>(column));
      const Vector3d in_lidar(std::cos(bearing) * std::cos(tilt), std::sin(bearing),
                              std::cos(bearing) * std::sin(tilt));
      const auto hit = cast({world_from_lidar.translation(), world_from_lidar.linear() * in_lidar});
      const double noise = options.range_sigma_m * random.Normal();
      if (!hit || hit->distance_m > options.max_range_m) continue;
      const std::size_t i = row * cloud.width + column;
      cloud.in_sensor[i] = ((hit->distance_m + noise) * in_lidar).cast<float>();
      cloud.labels[i] = hit->label;
    }
  return cloud;
}

ColourImage PhotographScene(const RayCaster& cast, const Camera& camera,
                            const Eigen::Isometry3d& world_from_camera,
                            const SceneOptions& options) {
  ColourImage image;
  image.width = static_cast<std::size_t>(camera.Width());
  image.height = static_cast<std::size_t>(camera.Height());
  image.rgb.assign(3 * image.width * image.height, 0);
  RandomNumbers random(options.seed, kCameraStream);
  for (std::size_t v = 0; v < image.height; ++v)
    for (std::size_t u = 0; u < image.width; ++u) {
      const auto ray_in_camera =
          camera.Unproject(Eigen::Vector2d(static_cast<double>(u), static_cast<double>(v)));
      if (!ray_in_camera) continue;
      const auto hit = cast({world_from_camera.translation(),
                             world_from_camera.linear() * ray_in_camera->normalized()});
      const Vector3d colour = hit ? hit->colour : Vector3d(250, 250, 255);
      for (std::size_t c = 0; c < 3; ++c)
        image.rgb[3 * (v * image.width + u) + c] =
            Channel(colour[static_cast<Eigen::Index>(c)] + options.colour_sigma * random.Normal());
    }
  return image;
}

}  // namespace graticule
