#include "graticule/problems/calibration/undistort.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kMostPixels = 1 << 28;

// So many pixels apart, all around.
std::vector<Eigen::Vector2d> BorderOf(int width, int height, double step) {
  std::vector<Eigen::Vector2d> border;
  const double right = width - 1.0, bottom = height - 1.0;
  const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const int steps = std::max(1, static_cast<int>((b - a).norm() / step));
    for (int i = 0; i < steps; ++i) border.push_back(a + (b - a) * i / steps);
  };
  add({0, 0}, {right, 0});
  add({right, 0}, {right, bottom});
  add({right, bottom}, {0, bottom});
  add({0, bottom}, {0, 0});
  return border;
}

bool Inside(const Camera& camera, const Eigen::Vector2d& pixel) {
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= camera.Width() - 1 &&
         pixel.y() <= camera.Height() - 1;
}

// Where the view's border looks, all of it must be inside the camera's image.
bool IsFilled(const Camera& camera, const CameraIntrinsics& view, double widest) {
  const std::vector<double>& p = view.parameters;
  for (const Eigen::Vector2d& pixel : BorderOf(view.width, view.height, 1)) {
    const Eigen::Vector3d ray((pixel.x() - p[2]) / p[0], (pixel.y() - p[3]) / p[1], 1);
    if (std::atan(ray.head<2>().norm()) > widest) return false;
    const auto image = camera.Project(ray);
    if (!image || !Inside(camera, *image)) return false;
  }
  return true;
}

// The focal length at which the camera's border just fits.
double FocalForAll(const Camera& camera, const CameraIntrinsics& view, double widest) {
  const double cx = view.parameters[2], cy = view.parameters[3];
  double focal = HUGE_VAL;
  const double reach = std::min(widest, camera.MaxAngle());
  for (const Eigen::Vector2d& pixel : BorderOf(camera.Width(), camera.Height(), 8)) {
    const std::vector<double>& p = camera.Intrinsics().parameters;
    const auto ray = camera.Unproject(pixel);
    const Eigen::Vector2d outward =
        ray ? Eigen::Vector2d(ray->head<2>())
            : Eigen::Vector2d((pixel.x() - p[2]) / p[0], (pixel.y() - p[3]) / p[1]);
    if (outward.norm() == 0) continue;
    const double angle = ray ? std::min(reach, std::acos(std::clamp(ray->z(), -1.0, 1.0))) : reach;
    const Eigen::Vector2d at = outward.normalized() * std::tan(angle);
    if (at.x() != 0)
      focal = std::min(focal, (at.x() < 0 ? cx : view.width - 1 - cx) / std::fabs(at.x()));
    if (at.y() != 0)
      focal = std::min(focal, (at.y() < 0 ? cy : view.height - 1 - cy) / std::fabs(at.y()));
  }
  return focal;
}

// Without the search that other models need.
std::optional<Eigen::Vector3d> RayOf(const Camera& camera, double x, double y) {
  const CameraIntrinsics& c = camera.Intrinsics();
  if (c.model != "pinhole") return camera.Unproject({x, y});
  return Eigen::Vector3d((x - c.parameters[2]) / c.parameters[0],
                         (y - c.parameters[3]) / c.parameters[1], 1);
}

int CvType(int channels) { return CV_MAKETYPE(CV_8U, channels); }

}  // namespace

CameraIntrinsics RectifiedView(const Camera& camera, const RectifyOptions& options) {
  const std::vector<double>& p = camera.Intrinsics().parameters;
  CameraIntrinsics view;
  view.name = camera.Intrinsics().name;
  view.model = "pinhole";
  view.width = options.width > 0 ? options.width : camera.Width();
  view.height = options.height > 0 ? options.height : camera.Height();
  const double widest = std::clamp(options.widest_rad, 0.01, 1.5);
  // A centre that was estimated outside of the image is no centre to look along.
  const auto centre = [](double at, int from, int to) {
    return std::clamp((at + 0.5) / from, 0.1, 0.9) * to - 0.5;
  };
  const double start = std::max(view.width, view.height);
  view.parameters = {start, start, centre(p[2], camera.Width(), view.width),
                     centre(p[3], camera.Height(), view.height)};
  const auto set = [&](double focal) { view.parameters[0] = view.parameters[1] = focal; };
  if (options.keep == RectifyKeep::kAll) {
    if (const double focal = FocalForAll(camera, view, widest); std::isfinite(focal) && focal > 0)
      set(focal);
    return view;
  }
  // The longer the focal length the narrower the view: bisection.
  double low = 0.02 * start, high = 50 * start;
  for (int i = 0; i < 60; ++i) {
    const double middle = std::sqrt(low * high);
    set(middle);
    (IsFilled(camera, view, widest) ? high : low) = middle;
  }
  set(high);
  return view;
}

Rectifier::Rectifier(const Camera& from, const Camera& to)
    : from_width_(from.Width()),
      from_height_(from.Height()),
      width_(static_cast<std::size_t>(to.Width())),
      height_(static_cast<std::size_t>(to.Height())) {
  if (static_cast<double>(width_) * static_cast<double>(height_) > kMostPixels)
    throw Error("rectify: a view of more than 2^28 pixels", ErrorKind::kUsage);
  x_.assign(width_ * height_, -1);
  y_.assign(width_ * height_, -1);
  const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
  ParallelFor(height_, threads, [&](std::size_t, std::size_t row) {
    for (std::size_t column = 0; column < width_; ++column) {
      const auto ray = RayOf(to, static_cast<double>(column), static_cast<double>(row));
      if (!ray) continue;
      const auto pixel = from.Project(*ray);
      if (!pixel || !Inside(from, *pixel)) continue;
      x_[row * width_ + column] = static_cast<float>(pixel->x());
      y_[row * width_ + column] = static_cast<float>(pixel->y());
    }
  });
}

double Rectifier::Filled() const {
  const auto filled = std::count_if(x_.begin(), x_.end(), [](float x) { return x >= 0; });
  return x_.empty() ? 0 : static_cast<double>(filled) / static_cast<double>(x_.size());
}

GreyImage Rectifier::Image(const GreyImage& image) const {
  if (image.width != static_cast<std::size_t>(from_width_) ||
      image.height != static_cast<std::size_t>(from_height_))
    throw Error("rectify: expected an image of " + std::to_string(from_width_) + " x " +
                    std::to_string(from_height_) + " pixels, found " + std::to_string(image.width) +
                    " x " + std::to_string(image.height),
                ErrorKind::kUsage);
  GreyImage out;
  out.width = width_;
  out.height = height_;
  out.shades.resize(width_ * height_);
  Image(image.shades.data(), image.width, 1, out.shades.data());
  return out;
}

void Rectifier::Image(const std::uint8_t* pixels, std::size_t row_bytes, int channels,
                      std::uint8_t* out) const {
  const auto rows = static_cast<int>(height_), columns = static_cast<int>(width_);
  // OpenCV has no view of constant pixels; it does not write to these.
  const cv::Mat from(from_height_, from_width_, CvType(channels), const_cast<std::uint8_t*>(pixels),
                     row_bytes);
  cv::Mat to(rows, columns, CvType(channels), out);
  const cv::Mat x(rows, columns, CV_32F, const_cast<float*>(x_.data()));
  const cv::Mat y(rows, columns, CV_32F, const_cast<float*>(y_.data()));
  cv::remap(from, to, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
}

}  // namespace graticule
