#include "graticule/problems/segmentation/colour_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "graticule/problems/calibration/state.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// The least depth of the points in square cells of the picture.
class DepthCells {
 public:
  DepthCells(int width, int height, std::size_t points)
      : cell_(
            std::max(1.0, 1.5 * std::sqrt(static_cast<double>(width) * height /
                                          static_cast<double>(std::max<std::size_t>(points, 1))))),
        columns_(static_cast<int>(width / cell_) + 1),
        rows_(static_cast<int>(height / cell_) + 1),
        depths_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                std::numeric_limits<float>::infinity()) {}

  void Add(const Eigen::Vector2f& pixel, float depth) {
    float& least = depths_[Place(Column(pixel), Row(pixel))];
    least = std::min(least, depth);
  }

  bool IsHidden(const Eigen::Vector2f& pixel, float nearer_than) const {
    const int column = Column(pixel), row = Row(pixel);
    const auto is_nearer = [&](int c, int r) {
      return c >= 0 && r >= 0 && c < columns_ && r < rows_ && depths_[Place(c, r)] < nearer_than;
    };
    return is_nearer(column, row) || (is_nearer(column - 1, row) && is_nearer(column + 1, row)) ||
           (is_nearer(column, row - 1) && is_nearer(column, row + 1));
  }

 private:
  int Column(const Eigen::Vector2f& pixel) const {
    return std::clamp(static_cast<int>((pixel.x() + 0.5) / cell_), 0, columns_ - 1);
  }
  int Row(const Eigen::Vector2f& pixel) const {
    return std::clamp(static_cast<int>((pixel.y() + 0.5) / cell_), 0, rows_ - 1);
  }
  std::size_t Place(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  double cell_;
  int columns_, rows_;
  std::vector<float> depths_;
};

Rgb ColourAt(const ColourImage& image, const Eigen::Vector2f& pixel) {
  const auto locate = [](float at, std::size_t size, std::size_t* first, float* share) {
    const float clamped = std::clamp(at, 0.0f, static_cast<float>(size - 1));
    *first = std::min(static_cast<std::size_t>(clamped), size < 2 ? 0 : size - 2);
    *share = clamped - static_cast<float>(*first);
  };
  std::size_t x, y;
  float sx, sy;
  locate(pixel.x(), image.width, &x, &sx);
  locate(pixel.y(), image.height, &y, &sy);
  const std::size_t right = image.width > 1 ? 3 : 0, down = image.height > 1 ? 3 * image.width : 0;
  const std::uint8_t* at = &image.rgb[3 * (y * image.width + x)];
  Rgb colour;
  for (std::size_t c = 0; c < 3; ++c) {
    const float upper = (1 - sx) * at[c] + sx * at[c + right];
    const float lower = (1 - sx) * at[c + down] + sx * at[c + down + right];
    colour[c] = static_cast<std::uint8_t>(std::lround((1 - sy) * upper + sy * lower));
  }
  return colour;
}

}  // namespace

CloudColours ColoursOf(const PointCloud& cloud, const ColourImage& image, const Camera& camera,
                       const std::array<double, 7>& camera_from_lidar,
                       const ColourOptions& options) {
  if (static_cast<int>(image.width) != camera.Width() ||
      static_cast<int>(image.height) != camera.Height())
    throw Error("the picture is " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " px, the camera " +
                    std::to_string(camera.Width()) + " x " + std::to_string(camera.Height()),
                ErrorKind::kInput);
  const Eigen::Isometry3d camera_from_cloud = IsometryOf(camera_from_lidar);
  CloudColours result;
  result.colours.assign(cloud.Size(), {0, 0, 0});
  result.is_seen.assign(cloud.Size(), 0);
  struct Projected {
    std::size_t point;
    Eigen::Vector2f pixel;
    float depth;
  };
  std::vector<Projected> projected;
  for (std::size_t i = 0; i < cloud.Size(); ++i) {
    if (!cloud.in_sensor[i].allFinite()) continue;
    const Eigen::Vector3d in_camera = camera_from_cloud * cloud.in_sensor[i].cast<double>();
    const auto pixel = camera.Project(in_camera);
    if (!pixel || pixel->x() < -0.5 || pixel->y() < -0.5 || pixel->x() > camera.Width() - 0.5 ||
        pixel->y() > camera.Height() - 0.5)
      ++result.outside;
    else
      projected.push_back({i, pixel->cast<float>(), static_cast<float>(in_camera.norm())});
  }
  DepthCells cells(camera.Width(), camera.Height(), projected.size());
  for (const Projected& point : projected) cells.Add(point.pixel, point.depth);
  for (const Projected& point : projected) {
    const double margin = std::max(options.hidden_m, options.hidden_share * point.depth);
    if (cells.IsHidden(point.pixel, point.depth - static_cast<float>(margin))) {
      ++result.hidden;
      continue;
    }
    result.colours[point.point] = ColourAt(image, point.pixel);
    result.is_seen[point.point] = 1;
    ++result.seen;
  }
  return result;
}

PointCloud Coloured(const PointCloud& cloud, const CloudColours& colours, bool keep_unseen) {
  PointCloud coloured = cloud;
  coloured.colours = colours.colours;
  if (!keep_unseen)
    for (std::size_t i = 0; i < coloured.Size(); ++i)
      if (!colours.is_seen[i]) coloured.in_sensor[i] = kNoReturn;
  return coloured;
}

}  // namespace graticule
