#include "graticule/problems/calibration/render.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr int kTexelsPerSquare = 8;       // across the smallest black square
constexpr double kMostTexels = 4e6;       // of the finest level
constexpr double kLeastTexelsAside = 16;  // of the coarsest

// Shade of a room of brick walls, 6 x 3 x 8 m around the camera, in this direction.
double ShadeOfRoom(const Eigen::Vector3d& ray) {
  const Eigen::Array3d half(3, 1.5, 4);
  const Eigen::Array3d reach = ray.array().abs() / half;
  Eigen::Index axis;
  const double nearest = reach.maxCoeff(&axis);
  const Eigen::Vector3d hit = ray / nearest;
  const Eigen::Index along = axis == 0 ? 2 : 0, up = axis == 1 ? 2 : 1;
  constexpr double kBrick = 1, kRow = 0.5, kJoint = 0.02;
  const double row = std::floor((hit[up] + 100) / kRow);
  const double shift = std::fmod(row, 2) * kBrick / 2;
  const double in_row = std::fmod(hit[up] + 100, kRow);
  const double in_brick = std::fmod(hit[along] + 100 + shift, kBrick);
  const bool is_joint = in_row < kJoint || in_brick < kJoint;
  const double wall = axis == 2 ? 150 : axis == 0 ? 130 : hit.y() > 0 ? 105 : 165;
  return is_joint ? wall - 45 : wall;
}

// Two nearly normal numbers of standard deviation 1: sums of four random bytes each.
struct Pair {
  float first, second;
};
Pair NearlyNormal(RandomNumbers* random) {
  constexpr float kMean = 4 * 127.5f, kDeviation = 147.8f;  // sqrt(4 (256^2 - 1) / 12)
  const std::uint64_t bits = random->Bits();
  int sums[2] = {0, 0};
  for (int i = 0; i < 8; ++i) sums[i / 4] += static_cast<int>(bits >> (8 * i) & 255);
  return {(static_cast<float>(sums[0]) - kMean) / kDeviation,
          (static_cast<float>(sums[1]) - kMean) / kDeviation};
}

}  // namespace

TargetRenderer::TargetRenderer(const Target& target, const Camera& camera,
                               const RenderOptions& options)
    : camera_(camera), options_(options), printed_towards_z_(HasYUp(target)) {
  CheckTarget(target);
  if (options_.rays < 1 || options_.rays > 8)
    throw Error("render: expected 1 to 8 rays along a pixel's side", ErrorKind::kUsage);
  Print(target);
  FindRays();
  PaintRoom();
}

void TargetRenderer::Print(const Target& target) {
  const std::vector<TargetSquare> squares = BlackOf(target);
  extent_ = ExtentOf(target);
  double smallest = HUGE_VAL;
  for (const TargetSquare& square : squares)
    smallest = std::min({smallest, square.width, square.height});
  const double width_m = extent_[2] - extent_[0], height_m = extent_[3] - extent_[1];
  texel_m_ = std::max(smallest / kTexelsPerSquare, std::sqrt(width_m * height_m / kMostTexels));
  const int width = static_cast<int>(std::ceil(width_m / texel_m_));
  const int height = static_cast<int>(std::ceil(height_m / texel_m_));

  // The share of every texel that is black.
  std::vector<float> black(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto share = [](int texel, double from, double to) {
    return std::max(0.0, std::min(to, texel + 1.0) - std::max(from, static_cast<double>(texel)));
  };
  for (const TargetSquare& square : squares) {
    const double left = (square.x - extent_[0]) / texel_m_, right = left + square.width / texel_m_;
    const double top = (square.y - extent_[1]) / texel_m_, end = top + square.height / texel_m_;
    for (int y = std::max(0, static_cast<int>(top)); y < std::min<double>(height, end); ++y)
      for (int x = std::max(0, static_cast<int>(left)); x < std::min<double>(width, right); ++x)
        black[static_cast<std::size_t>(y * width + x)] +=
            static_cast<float>(share(x, left, right) * share(y, top, end));
  }
  Level level{width, height, {}};
  for (const float share_of_black : black)
    level.shades.push_back(static_cast<std::uint8_t>(std::lround(
        options_.white + (options_.black - options_.white) * std::min(1.f, share_of_black))));
  while (std::min(level.width, level.height) >= 2 * kLeastTexelsAside) {
    levels_.push_back(std::move(level));
    const Level& fine = levels_.back();
    level = {fine.width / 2, fine.height / 2, {}};
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) {
        const std::uint8_t* four = &fine.shades[static_cast<std::size_t>(2 * y * fine.width) +
                                                static_cast<std::size_t>(2 * x)];
        level.shades.push_back(static_cast<std::uint8_t>(
            (four[0] + four[1] + four[fine.width] + four[fine.width + 1] + 2) / 4));
      }
  }
  levels_.push_back(std::move(level));
}

void TargetRenderer::FindRays() {
  constexpr int kStep = 2;
  const int columns = camera_.Width() / kStep + 2, rows = camera_.Height() / kStep + 2;
  // Nodes at -0.5, 1.5, 3.5 ...: pixels' edges.
  std::vector<Eigen::Vector3f> nodes;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto ray = camera_.Unproject({kStep * column - 0.5, kStep * row - 0.5});
      nodes.push_back(ray ? Eigen::Vector3f(ray->cast<float>()) : Eigen::Vector3f::Zero());
    }
  const int n = options_.rays;
  bool any = false;
  rays_.reserve(static_cast<std::size_t>(camera_.Width() * camera_.Height() * n * n));
  for (int y = 0; y < camera_.Height(); ++y)
    for (int x = 0; x < camera_.Width(); ++x)
      for (int i = 0; i < n * n; ++i) {
        const float across =
            (static_cast<float>(x) + (static_cast<float>(i % n) + 0.5f) / static_cast<float>(n)) /
            kStep;
        const float down =
            (static_cast<float>(y) + (static_cast<float>(i / n) + 0.5f) / static_cast<float>(n)) /
            kStep;
        const int column = static_cast<int>(across), row = static_cast<int>(down);
        const float a = across - static_cast<float>(column), b = down - static_cast<float>(row);
        const Eigen::Vector3f* node = &nodes[static_cast<std::size_t>(row * columns + column)];
        const Eigen::Vector3f corners[4] = {node[0], node[1], node[columns], node[columns + 1]};
        Eigen::Vector3f ray = (1 - b) * ((1 - a) * corners[0] + a * corners[1]) +
                              b * ((1 - a) * corners[2] + a * corners[3]);
        for (const Eigen::Vector3f& corner : corners)
          if (corner.isZero()) ray.setZero();
        any = any || !ray.isZero();
        rays_.push_back({ray.x(), ray.y(), ray.z()});
      }
  if (!any) throw Error("render: no pixel of this camera has a ray", ErrorKind::kUsage);
}

void TargetRenderer::PaintRoom() {
  const std::size_t n = static_cast<std::size_t>(options_.rays * options_.rays);
  room_.resize(rays_.size() / n);
  for (std::size_t pixel = 0; pixel < room_.size(); ++pixel) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d ray = Eigen::Vector3f(rays_[pixel * n + i].data()).cast<double>();
      if (!ray.isZero()) sum += options_.has_room ? ShadeOfRoom(ray) : 140;
    }
    room_[pixel] = static_cast<float>(sum / static_cast<double>(n));
  }
}

// The coarsest print whose texels are not larger than what lies between two rays, where the target
// is nearest.
const TargetRenderer::Level& TargetRenderer::LevelAt(const Eigen::Isometry3d& camera_from_target,
                                                     double* texel_m) const {
  double most = 0;  // rays a texel
  for (const double across : {0., 0.5, 1.})
    for (const double down : {0., 0.5, 1.}) {
      const Eigen::Vector3d at(extent_[0] + across * (extent_[2] - extent_[0]),
                               extent_[1] + down * (extent_[3] - extent_[1]), 0);
      const auto pixel = camera_.Project(camera_from_target * at);
      if (!pixel) continue;
      for (const Eigen::Vector3d& step :
           {Eigen::Vector3d(texel_m_, 0, 0), Eigen::Vector3d(0, texel_m_, 0)})
        if (const auto next = camera_.Project(camera_from_target * (at + step)))
          most = std::max(most, options_.rays * (*next - *pixel).norm());
    }
  std::size_t level = 0;
  *texel_m = texel_m_;
  for (; level + 1 < levels_.size() && 2 * most <= 1; ++level) {
    most *= 2;
    *texel_m *= 2;
  }
  return levels_[level];
}

void TargetRenderer::DrawTarget(const Eigen::Isometry3d& camera_from_target,
                                std::vector<float>* shades) const {
  const Eigen::Isometry3d target_from_camera = camera_from_target.inverse();
  const Eigen::Vector3d eye = target_from_camera.translation();
  // Seen from its back, it is a piece of cardboard; that nobody calibrates with.
  const float side = printed_towards_z_ ? -1.f : 1.f;
  if (!(side * eye.z() < 0)) return;
  double texel = 0;
  const Level& level = LevelAt(camera_from_target, &texel);
  // A ray d (in the target's frame) from the eye meets the plane z = 0 at eye - d eye.z / d.z; in
  // texels, times d.z.
  Eigen::Matrix3d hit = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 2; ++i) {
    hit(i, i) = -eye.z() / texel;
    hit(i, 2) = (eye[i] - extent_[static_cast<std::size_t>(i)]) / texel;
  }
  hit(2, 2) = 1;
  const Eigen::Matrix3f m = (hit * target_from_camera.linear()).cast<float>();
  const auto width = static_cast<float>(level.width), height = static_cast<float>(level.height);
  const std::size_t n = static_cast<std::size_t>(options_.rays * options_.rays);
  const auto wall_share = 1 / static_cast<float>(n);
  const std::array<float, 3>* ray = rays_.data();
  for (std::size_t pixel = 0; pixel < shades->size(); ++pixel) {
    const float wall = room_[pixel];
    float sum = 0;
    for (std::size_t i = 0; i < n; ++i, ++ray) {
      const float x = (*ray)[0], y = (*ray)[1], z = (*ray)[2];
      const float w = m(2, 0) * x + m(2, 1) * y + m(2, 2) * z;
      // Not `side * w <= 0`: a pixel without a ray has w = 0.
      if (!(side * w > 0)) {
        sum += wall;
        continue;
      }
      const float u = (m(0, 0) * x + m(0, 1) * y + m(0, 2) * z) / w;
      const float v = (m(1, 0) * x + m(1, 1) * y + m(1, 2) * z) / w;
      if (!(u >= 0 && v >= 0 && u < width && v < height)) {
        sum += wall;
        continue;
      }
      const float across = std::min(std::max(u - 0.5f, 0.f), width - 1.001f);
      const float down = std::min(std::max(v - 0.5f, 0.f), height - 1.001f);
      const int column = static_cast<int>(across), row = static_cast<int>(down);
      const float a = across - static_cast<float>(column), b = down - static_cast<float>(row);
      const std::uint8_t* texels =
          &level.shades[static_cast<std::size_t>(row * level.width + column)];
      const float top =
          static_cast<float>(texels[0]) + a * static_cast<float>(texels[1] - texels[0]);
      const std::uint8_t* below = texels + level.width;
      const float bottom =
          static_cast<float>(below[0]) + a * static_cast<float>(below[1] - below[0]);
      sum += top + b * (bottom - top);
    }
    (*shades)[pixel] = sum * wall_share;
  }
}

GreyImage TargetRenderer::Render(const std::optional<Se3Array>& camera_from_target,
                                 RandomNumbers* random) const {
  std::vector<float> shades = room_;
  if (camera_from_target) DrawTarget(IsometryOf(*camera_from_target), &shades);
  if (options_.blur_px > 0) {
    cv::Mat view(camera_.Height(), camera_.Width(), CV_32F, shades.data());
    cv::GaussianBlur(view, view, {0, 0}, options_.blur_px, options_.blur_px, cv::BORDER_REPLICATE);
  }
  GreyImage image;
  image.width = static_cast<std::size_t>(camera_.Width());
  image.height = static_cast<std::size_t>(camera_.Height());
  image.shades.resize(shades.size());
  const auto noise = static_cast<float>(options_.noise);
  for (std::size_t i = 0; i < shades.size(); i += 2) {
    const Pair pair = noise > 0 ? NearlyNormal(random) : Pair{0, 0};
    const auto shade = [&](float value, float by) {
      return static_cast<std::uint8_t>(std::clamp(value + noise * by + 0.5f, 0.f, 255.f));
    };
    image.shades[i] = shade(shades[i], pair.first);
    if (i + 1 < shades.size()) image.shades[i + 1] = shade(shades[i + 1], pair.second);
  }
  return image;
}

}  // namespace graticule
