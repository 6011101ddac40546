#include "graticule/problems/attenuation/ray.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// One axis of a walk over a lattice: where the next line is crossed, in parts of the ray.
struct Axis {
  double from, per_line;    // where the ray begins; parts of the ray from line to line
  double lines;             // crossed by the whole ray, about
  std::int64_t cell, step;  // where it is; +1 or -1
  std::int64_t left;        // lines still to cross
  double next;              // where the next is crossed

  /// `begin` and `end`: the cells of both ends.
  Axis(double from_at, double to, std::int64_t begin, std::int64_t end)
      : from(from_at),
        per_line(1 / std::abs(to - from_at)),
        lines(std::abs(to - from_at)),
        cell(begin),
        step(end >= begin ? 1 : -1),
        left(std::abs(end - begin)) {
    Aim();
  }
  void Aim() { next = left > 0 ? At(0) : kNever; }
  /// Where the line `ahead` of the next is crossed.
  double At(std::int64_t ahead) const {
    const std::int64_t line = step > 0 ? cell + 1 + ahead : cell - ahead;
    return (static_cast<double>(line) - from) * static_cast<double>(step) * per_line;
  }
};

/// Lines of `axis` that lie before `t`, of at most `most`.
std::int64_t LinesBefore(const Axis& axis, double t, std::int64_t most) {
  if (!(axis.next < t)) return 0;
  const auto lines = static_cast<std::int64_t>((t - axis.next) * axis.lines) + 1;
  return std::min(lines, most);
}

std::int64_t CellOf(double at, std::int64_t count) {
  return std::clamp(static_cast<std::int64_t>(std::floor(at)), std::int64_t{0}, count - 1);
}

/// Shortens [begin, end] to where 0 <= from + t (to - from) <= size.  False where nothing is left.
bool Clip(double from, double to, double size, double* begin, double* end) {
  const double by = to - from;
  if (by == 0) return from >= 0 && from <= size;
  double in = -from / by, out = (size - from) / by;
  if (in > out) std::swap(in, out);
  *begin = std::max(*begin, in);
  *end = std::min(*end, out);
  return *begin < *end;
}

}  // namespace

ClassMap::ClassMap(double resolution, const PlanarPose& map_from_grid, std::size_t width,
                   std::size_t height, const std::vector<std::uint8_t>& classes,
                   std::uint8_t outside)
    : resolution_(resolution),
      per_cell_(1 / resolution),
      map_from_grid_(map_from_grid),
      cos_(std::cos(map_from_grid.yaw)),
      sin_(std::sin(map_from_grid.yaw)),
      width_(static_cast<std::int64_t>(width)),
      height_(static_cast<std::int64_t>(height)),
      outside_(outside) {
  if (!(resolution > 0) || !std::isfinite(resolution))
    throw Error("a map's resolution is " + Shown(resolution) + " m; expected above zero");
  if (width == 0 || height == 0 || classes.size() != width * height)
    throw Error("a map of " + std::to_string(width) + " x " + std::to_string(height) +
                " cells has " + std::to_string(classes.size()) + " of them");
  if (outside == kMixed || std::find(classes.begin(), classes.end(), kMixed) != classes.end())
    throw Error("a map has a cell of class 255; expected classes of 0 to 254");
  Fill(classes.data());
}

ClassMap::ClassMap(const OccupancyGrid& grid, const std::array<std::uint8_t, 3>& class_of)
    : ClassMap(
          grid.resolution, grid.map_from_grid, grid.width, grid.height,
          [&] {
            std::vector<std::uint8_t> classes(grid.cells.size());
            std::transform(
                grid.cells.begin(), grid.cells.end(), classes.begin(),
                [&](Occupancy cell) { return class_of[static_cast<std::size_t>(cell)]; });
            return classes;
          }(),
          class_of[static_cast<std::size_t>(Occupancy::kUnknown)]) {
  class_count_ = 1 + *std::max_element(class_of.begin(), class_of.end());
}

void ClassMap::Fill(const std::uint8_t* classes) {
  tiles_x_ = (width_ + kTile - 1) / kTile;
  tiles_y_ = (height_ + kTile - 1) / kTile;
  cells_.assign(static_cast<std::size_t>(tiles_x_ * tiles_y_ * kTile * kTile), outside_);
  tiles_.resize(static_cast<std::size_t>(tiles_x_ * tiles_y_));
  std::uint8_t highest = outside_;
  for (std::int64_t ty = 0; ty < tiles_y_; ++ty)
    for (std::int64_t tx = 0; tx < tiles_x_; ++tx) {
      const std::int64_t x0 = tx * kTile, y0 = ty * kTile;
      const std::int64_t columns = std::min<std::int64_t>(kTile, width_ - x0);
      const std::int64_t rows = std::min<std::int64_t>(kTile, height_ - y0);
      std::uint8_t* to = cells_.data() + (ty * tiles_x_ + tx) * (kTile * kTile);
      const std::uint8_t first = classes[y0 * width_ + x0];
      bool uniform = true;  // cells beyond the map's edge are never looked at
      for (std::int64_t y = 0; y < rows; ++y)
        for (std::int64_t x = 0; x < columns; ++x) {
          const std::uint8_t c = classes[(y0 + y) * width_ + x0 + x];
          to[y * kTile + x] = c;
          uniform = uniform && c == first;
          highest = std::max(highest, c);
        }
      tiles_[static_cast<std::size_t>(ty * tiles_x_ + tx)] = uniform ? first : kMixed;
    }
  class_count_ = highest + 1;
  FindReach();
}

/// Chessboard distance to the nearest tile of another class, less one: two sweeps (Rosenfeld and
/// Pfaltz 1966).  Beyond the map's edge nothing is other.
void ClassMap::FindReach() {
  constexpr int kFar = 250;
  reach_.assign(tiles_.size(), 0);
  const auto sweep = [&](std::int64_t tx, std::int64_t ty, std::int64_t by) {
    const auto at = static_cast<std::size_t>(ty * tiles_x_ + tx);
    if (tiles_[at] == kMixed) return;
    int reach = by > 0 ? kFar : reach_[at];
    const auto look = [&](std::int64_t x, std::int64_t y) {
      if (x < 0 || y < 0 || x >= tiles_x_ || y >= tiles_y_) return;
      const auto other = static_cast<std::size_t>(y * tiles_x_ + x);
      reach = std::min(reach, tiles_[other] == tiles_[at] ? reach_[other] + 1 : 0);
    };
    look(tx - by, ty);
    for (std::int64_t x = tx - 1; x <= tx + 1; ++x) look(x, ty - by);
    reach_[at] = static_cast<std::uint8_t>(reach);
  };
  for (std::int64_t ty = 0; ty < tiles_y_; ++ty)
    for (std::int64_t tx = 0; tx < tiles_x_; ++tx) sweep(tx, ty, 1);
  for (std::int64_t ty = tiles_y_ - 1; ty >= 0; --ty)
    for (std::int64_t tx = tiles_x_ - 1; tx >= 0; --tx) sweep(tx, ty, -1);
}

double ClassMap::DistanceOutside(const Eigen::Vector2d& in_map_m) const {
  const Eigen::Vector2d at = ToCells(in_map_m);
  const auto beyond = [](double value, std::int64_t size) {
    return std::max({0.0, -value, value - static_cast<double>(size)});
  };
  return resolution_ * std::hypot(beyond(at.x(), width_), beyond(at.y(), height_));
}

RayTracer::RayTracer(const ClassMap* map, double coarse_m)
    : map_(map), coarse_m_(coarse_m), class_count_(map ? map->ClassCount() : 1) {
  part_.assign(static_cast<std::size_t>(class_count_), 0);
}

const std::vector<RayPiece>& RayTracer::Trace(const Eigen::Vector3d& a_m,
                                              const Eigen::Vector3d& b_m) {
  pieces_.clear();
  runs_.clear();
  cells_crossed_ = 0;
  const bool swapped =
      std::lexicographical_compare(b_m.data(), b_m.data() + 3, a_m.data(), a_m.data() + 3);
  const Eigen::Vector3d& from = swapped ? b_m : a_m;
  const Eigen::Vector3d& to = swapped ? a_m : b_m;
  const double length_m = (to - from).norm();
  if (length_m == 0) return pieces_;
  WalkMap(from.head<2>(), to.head<2>());
  runs_.back().end = 1;
  WalkCoarse(from.head<2>(), to.head<2>(), length_m);
  return pieces_;
}

void RayTracer::WalkMap(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  if (!map_) return EndRun(1, 0);
  const Eigen::Vector2d from = map_->ToCells(a_m), to = map_->ToCells(b_m);
  double begin = 0, end = 1;
  if (!Clip(from.x(), to.x(), static_cast<double>(map_->Width()), &begin, &end) ||
      !Clip(from.y(), to.y(), static_cast<double>(map_->Height()), &begin, &end))
    return EndRun(1, map_->Outside());
  if (begin > 0) EndRun(begin, map_->Outside());
  WalkCells(from, to, begin, end);
  if (end < 1) EndRun(1, map_->Outside());
}

void RayTracer::WalkCells(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double begin,
                          double end) {
  constexpr std::int64_t kTile = ClassMap::kTile, kInTile = kTile - 1, kTileBits = 3;
  static_assert(kTile == 1 << kTileBits);
  const Eigen::Vector2d by = to - from, first = from + begin * by, last = from + end * by;
  Axis x(from.x(), to.x(), CellOf(first.x(), map_->Width()), CellOf(last.x(), map_->Width()));
  Axis y(from.y(), to.y(), CellOf(first.y(), map_->Height()), CellOf(last.y(), map_->Height()));
  cells_crossed_ = x.left + y.left + 1;
  double crossed = begin;
  std::uint8_t material = ClassMap::kMixed;  // of the run that is being followed; none yet
  for (;;) {
    // Lines to cross until the ray has left the tile.
    const std::int64_t in_x = x.cell & kInTile, in_y = y.cell & kInTile;
    std::int64_t out_x = x.step > 0 ? kTile - in_x : in_x + 1;
    std::int64_t out_y = y.step > 0 ? kTile - in_y : in_y + 1;
    const std::uint8_t tile = map_->TileClass(x.cell >> kTileBits, y.cell >> kTileBits);
    const std::uint8_t* cell =
        map_->TileCells(x.cell >> kTileBits, y.cell >> kTileBits) + in_y * kTile + in_x;
    // A tile of one class is not looked into.
    const std::uint8_t here = tile != ClassMap::kMixed ? tile : *cell;
    if (here != material) {
      if (material != ClassMap::kMixed) EndRun(crossed, material);
      material = here;
    }
    if (tile != ClassMap::kMixed) {
      const std::int64_t more = kTile * map_->TileReach(x.cell >> kTileBits, y.cell >> kTileBits);
      out_x += more;
      out_y += more;
      const double leaves_x = out_x <= x.left ? x.At(out_x - 1) : kNever;
      const double leaves_y = out_y <= y.left ? y.At(out_y - 1) : kNever;
      if (leaves_x == kNever && leaves_y == kNever) break;
      const bool by_x = leaves_x < leaves_y;
      crossed = by_x ? leaves_x : leaves_y;
      // Of the other axis: lines crossed on the way, which do not leave the tile.
      const std::int64_t lines_x =
          by_x ? out_x : LinesBefore(x, crossed, std::min(out_x - 1, x.left));
      const std::int64_t lines_y =
          by_x ? LinesBefore(y, crossed, std::min(out_y - 1, y.left)) : out_y;
      x.cell += x.step * lines_x;
      y.cell += y.step * lines_y;
      x.left -= lines_x;
      y.left -= lines_y;
      x.Aim();
      y.Aim();
      continue;
    }
    const std::int64_t step_y = y.step * kTile;
    bool is_done = false;
    std::int64_t done_x = 0, done_y = 0;
    for (;;) {
      if (x.next < y.next) {
        crossed = x.next;
        ++done_x;
        x.next = done_x < x.left ? x.next + x.per_line : kNever;
        if (done_x == out_x) break;
        cell += x.step;
      } else {
        if (y.next == kNever) {
          is_done = true;
          break;
        }
        crossed = y.next;
        ++done_y;
        y.next = done_y < y.left ? y.next + y.per_line : kNever;
        if (done_y == out_y) break;
        cell += step_y;
      }
      if (*cell != material) {
        EndRun(crossed, material);
        material = *cell;
      }
    }
    if (is_done) break;
    x.cell += x.step * done_x;
    y.cell += y.step * done_y;
    x.left -= done_x;
    y.left -= done_y;
    x.Aim();
    y.Aim();
  }
  EndRun(end, material);
}

void RayTracer::WalkCoarse(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
                           double length_m) {
  double at = 0;
  std::size_t run = 0;
  const auto advance = [&](double to) {
    for (; runs_[run].end < to; ++run) {
      part_[runs_[run].material] += std::max(0.0, runs_[run].end - at);
      at = std::max(at, runs_[run].end);
    }
    part_[runs_[run].material] += std::max(0.0, to - at);
    at = std::max(at, to);
  };
  if (coarse_m_ <= 0) {
    advance(1);
    return AddPieces(0, 0, length_m);
  }
  const Eigen::Vector2d from = a_m / coarse_m_, to = b_m / coarse_m_;
  const auto floor_of = [](double value) { return static_cast<std::int64_t>(std::floor(value)); };
  Axis x(from.x(), to.x(), floor_of(from.x()), floor_of(to.x()));
  Axis y(from.y(), to.y(), floor_of(from.y()), floor_of(to.y()));
  for (;;) {
    Axis& next = x.next < y.next ? x : y;
    const bool is_last = next.left == 0;
    const double end = is_last ? 1 : std::min(1.0, next.next);
    const auto cell_x = static_cast<std::int32_t>(x.cell),
               cell_y = static_cast<std::int32_t>(y.cell);
    if (runs_[run].end >= end) {  // one class: nothing to sort by class
      if (end > at) pieces_.push_back({cell_x, cell_y, runs_[run].material, (end - at) * length_m});
      at = std::max(at, end);
    } else {
      advance(end);
      AddPieces(cell_x, cell_y, length_m);
    }
    if (is_last) return;
    next.cell += next.step;
    --next.left;
    next.Aim();
  }
}

void RayTracer::AddPieces(std::int32_t x, std::int32_t y, double length_m) {
  for (int c = 0; c < class_count_; ++c) {
    double& part = part_[static_cast<std::size_t>(c)];
    if (part > 0) pieces_.push_back({x, y, static_cast<std::uint32_t>(c), part * length_m});
    part = 0;
  }
}

}  // namespace graticule
