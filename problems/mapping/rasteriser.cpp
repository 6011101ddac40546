#include "graticule/problems/mapping/rasteriser.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kOne = 4294967296.0;  // a cell
// Beyond this a beam is level but for the row it may graze: rows gain nothing from more.
constexpr double kMaxSlope = 1 << 20;
constexpr int kFan = 8;  // beams

std::int32_t RoundDown(double value, int multiple) {
  return static_cast<std::int32_t>(std::floor(value / multiple)) * multiple;
}

// The 16 rows of one quarter of a column, as a tile.
CellBits Quarter(const std::uint64_t* rows, int quarter) {
  CellBits bits;
  for (int w = 0; w < 4; ++w)
    for (int r = 0; r < 4; ++r)
      bits.words[w] |= ((rows[4 * w + r] >> (16 * quarter)) & 0xffff) << (16 * r);
  return bits;
}

}  // namespace

void Rasteriser::PlaceBeams(const ScanPoints& points, const PlanarPose& world_from_robot) {
  const std::size_t count = points.Size();
  const double c = cells_per_metre_ * std::cos(world_from_robot.yaw);
  const double s = cells_per_metre_ * std::sin(world_from_robot.yaw);
  const double origin_x = cells_per_metre_ * world_from_robot.x;
  const double origin_y = cells_per_metre_ * world_from_robot.y;
  const double start_x = origin_x + c * points.laser_x - s * points.laser_y;
  const double start_y = origin_y + s * points.laser_x + c * points.laser_y;
  end_x_.resize(count);
  end_y_.resize(count);
  double min_x = start_x, max_x = start_x, min_y = start_y, max_y = start_y;
  for (std::size_t i = 0; i < count; ++i) {
    end_x_[i] = origin_x + c * points.x[i] - s * points.y[i];
    end_y_[i] = origin_y + s * points.x[i] + c * points.y[i];
    min_x = std::min(min_x, end_x_[i]);
    max_x = std::max(max_x, end_x_[i]);
    min_y = std::min(min_y, end_y_[i]);
    max_y = std::max(max_y, end_y_[i]);
  }
  // A cell to spare at the sides: runs are rounded by 2^-32 cells a row.
  left_ = RoundDown(min_x - 1, 64);
  bottom_ = RoundDown(min_y, kTileSide);
  columns_ = (RoundDown(max_x + 1, 64) - left_) / 64 + 1;
  height_ = RoundDown(max_y, kTileSide) - bottom_ + kTileSide;
  const std::size_t words = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(height_);
  if (passed_.size() < words) {
    passed_.resize(words);
    hit_.resize(words);
  }

  // Numbers in the window are not negative: to cut them off is to round them down.
  start_x_ = static_cast<std::int64_t>((start_x - left_) * kOne);
  const double start_row = start_y - bottom_;
  start_row_ = static_cast<std::int32_t>(start_row);
  const double to_upper_row = start_row_ + 1 - start_row, to_lower_row = start_row - start_row_;
  beams_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = end_x_[i] - start_x, dy = end_y_[i] - start_y;
    const double slope =
        std::max(-kMaxSlope, std::min(kMaxSlope, dx / std::max(std::abs(dy), 1e-9)));
    const auto end_row = static_cast<std::int32_t>(end_y_[i] - bottom_);
    Beam& beam = beams_[i];
    beam.up = dy >= 0;
    beam.end_x = static_cast<std::int64_t>((end_x_[i] - left_) * kOne);
    beam.slope = static_cast<std::int64_t>(slope * kOne);
    beam.first = start_x_ +
                 static_cast<std::int64_t>(slope * (beam.up ? to_upper_row : to_lower_row) * kOne);
    beam.rows = std::abs(end_row - start_row_);
    if (points.hit[i]) {
      const auto end_column = static_cast<std::int32_t>(beam.end_x >> 32);
      hit_[static_cast<std::size_t>(end_row * columns_ + (end_column >> 6))] |=
          std::uint64_t{1} << (end_column & 63);
    }
  }
}

// What drawing needs of the window, in registers: the compiler must take it that what is drawn
// might change members and beams, which have words of 64 bits too.
struct Rasteriser::Canvas {
  std::uint64_t* words;
  std::ptrdiff_t columns;

  // low <= high.
  static void DrawRun(std::uint64_t* row, std::int64_t low, std::int64_t high) {
    const auto first = static_cast<std::int32_t>(low >> 32);
    const auto last = static_cast<std::int32_t>(high >> 32);
    std::uint64_t* word = row + (first >> 6);
    const std::uint64_t right_of = ~std::uint64_t{0} << (first & 63);
    const std::uint64_t left_of = ~std::uint64_t{0} >> (~last & 63);
    int columns_on = (last >> 6) - (first >> 6);
    if (columns_on == 0) {
      *word |= right_of & left_of;
      return;
    }
    *word++ |= right_of;
    for (; --columns_on > 0; ++word) *word = ~std::uint64_t{0};
    *word |= left_of;
  }
};

void Rasteriser::DrawFan(const Canvas& shared_canvas, const Beam* begin, const Beam* end) const {
  const Canvas canvas = shared_canvas;
  const std::int64_t start_x = start_x_;
  const std::ptrdiff_t next_row = begin->up ? canvas.columns : -canvas.columns;
  std::uint64_t* const start_row = canvas.words + start_row_ * canvas.columns;

  // Rows that all of them cross from edge to edge, and where no two neighbours' runs leave a cell
  // between them: there their runs are one run, from the lowest slope's to the highest's.
  std::int32_t shared = 0;
  if (end - begin > 1) {
    std::int32_t crossed = begin->rows;
    std::int64_t apart = 0, spread = 0;
    const Beam *lowest = begin, *highest = begin;
    for (const Beam* beam = begin + 1; beam < end; ++beam) {
      crossed = std::min(crossed, beam->rows);
      apart = std::max(apart, std::abs(beam->first - beam[-1].first));
      spread = std::max(spread, std::abs(beam->slope - beam[-1].slope));
      if (beam->slope < lowest->slope) lowest = beam;
      if (beam->slope > highest->slope) highest = beam;
    }
    const std::int64_t low_slope = lowest->slope, high_slope = highest->slope;
    // A run is as long as its slope: beams that lean to one side may be that far apart, and a cell,
    // where they enter a row.  They enter the first at one place, and leave it no farther apart
    // than other rows take them.
    constexpr std::int64_t kCell = std::int64_t{1} << 32;
    const std::int64_t near = kCell + std::max({low_slope, -high_slope, std::int64_t{0}});
    apart -= spread;
    std::int64_t low = start_x, next_low = lowest->first;
    std::int64_t high = start_x, next_high = highest->first;
    for (std::uint64_t* row = start_row; shared < crossed && apart <= near; ++shared) {
      Canvas::DrawRun(row, std::min(low, next_low), std::max(high, next_high));
      low = next_low;
      high = next_high;
      next_low += low_slope;
      next_high += high_slope;
      apart += spread;
      row += next_row;
    }
  }

  for (; begin < end; ++begin) {
    const Beam beam = *begin;
    std::uint64_t* row = start_row + shared * next_row;
    std::int64_t x = shared == 0 ? start_x : beam.first + (shared - 1) * beam.slope;
    std::int64_t next = beam.first + shared * beam.slope;
    if (beam.slope >= 0)
      for (std::int32_t k = shared; k < beam.rows; ++k) {
        Canvas::DrawRun(row, x, next);
        x = next;
        next += beam.slope;
        row += next_row;
      }
    else
      for (std::int32_t k = shared; k < beam.rows; ++k) {
        Canvas::DrawRun(row, next, x);
        x = next;
        next += beam.slope;
        row += next_row;
      }
    Canvas::DrawRun(row, std::min(x, beam.end_x), std::max(x, beam.end_x));
  }
}

void Rasteriser::Draw(const ScanPoints& points, const PlanarPose& world_from_robot,
                      std::vector<ScanTile>* tiles) {
  tiles->clear();
  if (points.Size() == 0) return;
  PlaceBeams(points, world_from_robot);
  const Canvas canvas{passed_.data(), columns_};
  for (const Beam *beam = beams_.data(), *last = beam + beams_.size(); beam != last;) {
    const Beam* end = beam + 1;
    while (end < last && end - beam < kFan && end->up == beam->up) ++end;
    DrawFan(canvas, beam, end);
    beam = end;
  }
  Collect(tiles);
}

void Rasteriser::Collect(std::vector<ScanTile>* tiles) {
  std::uint64_t passed[kTileSide], hit[kTileSide];
  const auto width = static_cast<std::size_t>(columns_);
  for (std::int32_t row = 0; row < height_; row += kTileSide)
    for (std::int32_t column = 0; column < columns_; ++column) {
      const auto at = static_cast<std::size_t>(row * columns_ + column);
      std::uint64_t *all_passed = passed_.data() + at, *all_hit = hit_.data() + at;
      std::uint64_t any = 0, any_hit = 0;
      for (std::size_t r = 0; r < kTileSide; ++r) {
        any |= all_passed[r * width];
        any_hit |= all_hit[r * width];
      }
      any |= any_hit;
      if (any == 0) continue;
      for (std::size_t r = 0; r < kTileSide; ++r) {
        hit[r] = all_hit[r * width];
        passed[r] = all_passed[r * width] & ~hit[r];
        all_passed[r * width] = all_hit[r * width] = 0;
      }
      for (int quarter = 0; quarter < 4; ++quarter) {
        if (((any >> (16 * quarter)) & 0xffff) == 0) continue;
        tiles->emplace_back();
        ScanTile& tile = tiles->back();
        tile.index = {left_ / kTileSide + 4 * column + quarter, (bottom_ + row) / kTileSide};
        tile.passed = Quarter(passed, quarter);
        if ((any_hit >> (16 * quarter)) & 0xffff) tile.hit = Quarter(hit, quarter);
      }
    }
}

}  // namespace graticule
