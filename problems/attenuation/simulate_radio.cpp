#include "graticule/problems/attenuation/simulate_radio.hpp"

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

/// A field's covariance is exp(-r^2 / (4 length^2)); links that share an end and are `apart` at the
/// other then correlate by sqrt(pi) length / apart erf(apart / (2 length)).  These weights fit the
/// curve measured on recorded links (docs/signal_simulation.md).
struct Scale {
  double length_m, weight;
};
constexpr Scale kScales[] = {{0.2, 0.65}, {1, 0.10}, {5, 0.25}};

/// Moves white noise of a grid to a Gaussian field of the same deviation: along x, then along y.
void Blur(std::vector<float>* grid, std::size_t width, std::size_t height, double sigma_cells) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma_cells));
  std::vector<float> kernel;
  double squares = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_cells * sigma_cells))));
    squares += kernel.back() * kernel.back();
  }
  for (float& k : kernel) k = static_cast<float>(k / std::sqrt(squares));
  std::vector<float> out(grid->size());
  // The grid's edges are joined, so that the deviation is the same everywhere.
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      float sum = 0;
      for (int i = -reach; i <= reach; ++i) {
        const auto at = static_cast<std::ptrdiff_t>(x) + i, w = static_cast<std::ptrdiff_t>(width);
        sum += kernel[static_cast<std::size_t>(i + reach)] *
               (*grid)[y * width + static_cast<std::size_t>(((at % w) + w) % w)];
      }
      out[y * width + x] = sum;
    }
  std::fill(grid->begin(), grid->end(), 0.0f);
  for (std::size_t y = 0; y < height; ++y)
    for (int i = -reach; i <= reach; ++i) {
      const auto at = static_cast<std::ptrdiff_t>(y) + i, h = static_cast<std::ptrdiff_t>(height);
      const std::size_t from = static_cast<std::size_t>(((at % h) + h) % h) * width;
      const float k = kernel[static_cast<std::size_t>(i + reach)];
      for (std::size_t x = 0; x < width; ++x) (*grid)[y * width + x] += k * out[from + x];
    }
}

}  // namespace

ShadowField::ShadowField(double width_m, double height_m, double sigma_db, std::uint64_t seed)
    : width_(static_cast<std::size_t>(std::ceil(width_m / cell_m_)) + 1),
      height_(static_cast<std::size_t>(std::ceil(height_m / cell_m_)) + 1),
      field_(width_ * height_, 0) {
  std::uint64_t stream = 10;
  for (const Scale& scale : kScales) {
    RandomNumbers random(seed, stream++);
    const double step = std::max(cell_m_, scale.length_m / 4);
    const double sigma_cells = scale.length_m / step;
    const auto size = [&](double m) {
      return static_cast<std::size_t>(std::ceil(m / step + 4 * sigma_cells)) + 2;
    };
    const std::size_t width = size(width_m), height = size(height_m);
    std::vector<float> grid(width * height);
    for (float& value : grid) value = static_cast<float>(random.Normal());
    Blur(&grid, width, height, sigma_cells);
    // The integral of the covariance along a line is 2 length sqrt(pi).
    const double amplitude =
        sigma_db * std::sqrt(scale.weight / (2 * scale.length_m * std::sqrt(M_PI)));
    for (std::size_t y = 0; y < height_; ++y) {
      const double v = static_cast<double>(y) * cell_m_ / step;
      const auto below = static_cast<std::size_t>(v);
      const double fy = v - static_cast<double>(below);
      for (std::size_t x = 0; x < width_; ++x) {
        const double u = static_cast<double>(x) * cell_m_ / step;
        const auto left = static_cast<std::size_t>(u);
        const double fx = u - static_cast<double>(left);
        const float* at = grid.data() + below * width + left;
        const double value = (1 - fy) * ((1 - fx) * at[0] + fx * at[1]) +
                             fy * ((1 - fx) * at[width] + fx * at[width + 1]);
        field_[y * width_ + x] += static_cast<float>(amplitude * value);
      }
    }
  }
}

double ShadowField::LossDb(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  const double length = (b_m - a_m).norm();
  if (!(length > 0)) return 0;
  const auto steps = static_cast<int>(std::ceil(length / cell_m_));
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector2d at = (a_m + (b_m - a_m) * ((i + 0.5) / steps)) / cell_m_;
    const double x = std::clamp(std::round(at.x()), 0.0, static_cast<double>(width_ - 1));
    const double y = std::clamp(std::round(at.y()), 0.0, static_cast<double>(height_ - 1));
    sum += field_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)];
  }
  return sum * length / steps / std::sqrt(length);
}

RadioWorld::RadioWorld(const FloorPlan& plan, const RadioOptions& options, std::uint64_t seed)
    : options_(options),
      exponent_(plan.exponent),
      map_([&] {
        std::vector<std::uint8_t> classes;
        for (const Filling filling : plan.cells)
          classes.push_back(static_cast<std::uint8_t>(filling));
        return std::make_unique<ClassMap>(plan.resolution, PlanarPose{}, plan.width, plan.height,
                                          classes, static_cast<std::uint8_t>(Filling::kAir));
      }()),
      tracer_(map_.get(), 0),
      shadows_(static_cast<double>(plan.width) * plan.resolution,
               static_cast<double>(plan.height) * plan.resolution, options.shadowing_db, seed) {}

double RadioWorld::MaterialLossDb(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
  double loss = 0;
  for (const RayPiece& piece : tracer_.Trace(a_m, b_m))
    loss += piece.length_m * LossOf(static_cast<Filling>(piece.material)).db_per_m;
  return loss;
}

double RadioWorld::CountedLossDb(double material_loss_db) const {
  return options_.ceiling_db * (1 - std::exp(-material_loss_db / options_.ceiling_db));
}

double RadioWorld::MeanDbm(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                           double material_loss_db) const {
  const double distance = std::max(0.1, (a_m - b_m).norm());
  return options_.l0_dbm - 10 * exponent_ * std::log10(distance) - CountedLossDb(material_loss_db) -
         shadows_.LossDb(a_m.head<2>(), b_m.head<2>());
}

LinkFading::LinkFading(const RadioOptions& options, RandomNumbers* random)
    : options_(options), random_(random) {
  for (int i = 0; i < options.diversity; ++i)
    scattered_.emplace_back(random_->Normal(), random_->Normal());
}

double LinkFading::Next(double moved_m, double elapsed_s, double material_loss_db) {
  const double kept = std::exp(-moved_m / options_.fading_m - elapsed_s / options_.fading_s);
  const double fresh = std::sqrt(1 - kept * kept);
  const double hidden = std::clamp(material_loss_db / 10, 0.0, 1.0);
  const double k = std::pow(10, 0.1 * (options_.k_in_sight_db +
                                       hidden * (options_.k_hidden_db - options_.k_in_sight_db)));
  const double direct = std::sqrt(k / (k + 1)), deviation = std::sqrt(0.5 / (k + 1));
  double power = 0;
  for (std::complex<double>& amplitude : scattered_) {
    amplitude =
        kept * amplitude + fresh * std::complex<double>(random_->Normal(), random_->Normal());
    power += std::norm(direct + deviation * amplitude);
  }
  return 10 * std::log10(std::max(power / static_cast<double>(scattered_.size()), 1e-9));
}

}  // namespace graticule
