#include "graticule/problems/mapping/route.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace graticule {
namespace {

constexpr int kX[8] = {1, 0, -1, 0, 1, -1, -1, 1}, kY[8] = {0, 1, 0, -1, 1, 1, -1, -1};

}  // namespace

RoutePlanner::RoutePlanner(const OccupancyGrid& grid, double clearance_m, double cell_m,
                           bool all_regions)
    : cell_m_(cell_m), left_(grid.map_from_grid.x), bottom_(grid.map_from_grid.y) {
  const auto cells = [&](std::size_t count) {
    return static_cast<std::size_t>(static_cast<double>(count) * grid.resolution / cell_m_);
  };
  width_ = cells(grid.width);
  height_ = cells(grid.height);
  open_.assign(width_ * height_, 1);
  // Every cell of structure closes the coarse cells whose centres are too near.
  const double reach = clearance_m + grid.resolution / 2;
  const auto span = static_cast<long>(std::ceil(reach / cell_m_)) + 1;
  for (std::size_t y = 0; y < grid.height; ++y)
    for (std::size_t x = 0; x < grid.width; ++x) {
      if (grid.At(x, y) != Occupancy::kStructure) continue;
      const double px = (static_cast<double>(x) + 0.5) * grid.resolution;
      const double py = (static_cast<double>(y) + 0.5) * grid.resolution;
      const auto column = static_cast<long>(px / cell_m_), row = static_cast<long>(py / cell_m_);
      for (long j = row - span; j <= row + span; ++j)
        for (long i = column - span; i <= column + span; ++i) {
          if (i < 0 || j < 0 || i >= static_cast<long>(width_) || j >= static_cast<long>(height_))
            continue;
          const double dx = (static_cast<double>(i) + 0.5) * cell_m_ - px;
          const double dy = (static_cast<double>(j) + 0.5) * cell_m_ - py;
          if (dx * dx + dy * dy < reach * reach)
            open_[static_cast<std::size_t>(j) * width_ + static_cast<std::size_t>(i)] = 0;
        }
    }
  // The largest region: others cannot be driven to.
  std::vector<int> region(open_.size(), -1);
  std::vector<std::size_t> sizes, stack;
  for (std::size_t seed = 0; seed < open_.size(); ++seed) {
    if (!IsOpen(seed) || region[seed] >= 0) continue;
    const int name = static_cast<int>(sizes.size());
    sizes.push_back(0);
    stack.assign(1, seed);
    region[seed] = name;
    while (!stack.empty()) {
      const std::size_t cell = stack.back();
      stack.pop_back();
      ++sizes.back();
      const long x = static_cast<long>(cell % width_), y = static_cast<long>(cell / width_);
      for (int k = 0; k < 4; ++k) {
        const long i = x + kX[k], j = y + kY[k];
        if (i < 0 || j < 0 || i >= static_cast<long>(width_) || j >= static_cast<long>(height_))
          continue;
        const std::size_t next = static_cast<std::size_t>(j) * width_ + static_cast<std::size_t>(i);
        if (!IsOpen(next) || region[next] >= 0) continue;
        region[next] = name;
        stack.push_back(next);
      }
    }
  }
  const auto largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  for (std::size_t cell = 0; cell < open_.size(); ++cell) {
    if (!all_regions && region[cell] != largest) open_[cell] = 0;
    if (IsOpen(cell)) places_.push_back(CentreOf(cell));
  }
}

std::size_t RoutePlanner::CellOf(const Point& point) const {
  const auto index = [&](double metres, std::size_t count) {
    const double at = std::floor(metres / cell_m_);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)));
  };
  const std::size_t x = index(point.x - left_, width_), y = index(point.y - bottom_, height_);
  const std::size_t cell = y * width_ + x;
  if (IsOpen(cell)) return cell;
  std::size_t nearest = cell;
  double least = std::numeric_limits<double>::infinity();
  for (const Point& place : places_) {
    const double away = std::hypot(place.x - point.x, place.y - point.y);
    if (away >= least) continue;
    least = away;
    nearest = index(place.y - bottom_, height_) * width_ + index(place.x - left_, width_);
  }
  return nearest;
}

RoutePlanner::Point RoutePlanner::CentreOf(std::size_t cell) const {
  return {left_ + (static_cast<double>(cell % width_) + 0.5) * cell_m_,
          bottom_ + (static_cast<double>(cell / width_) + 0.5) * cell_m_};
}

bool RoutePlanner::CanStand(const Point& point) const {
  const double x = std::floor((point.x - left_) / cell_m_);
  const double y = std::floor((point.y - bottom_) / cell_m_);
  return x >= 0 && y >= 0 && x < static_cast<double>(width_) && y < static_cast<double>(height_) &&
         IsOpen(static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x));
}

std::pair<std::size_t, std::size_t> RoutePlanner::Reach(std::size_t at, std::size_t count,
                                                        double most_m) const {
  const double cells = std::min(most_m / cell_m_ + 1, static_cast<double>(count));
  const auto reach = static_cast<std::size_t>(cells);
  return {at - std::min(at, reach), std::min(at + reach, count - 1)};
}

bool RoutePlanner::IsClear(const Point& from, const Point& to) const {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  const int steps = static_cast<int>(std::ceil(length / (0.25 * cell_m_)));
  for (int i = 0; i <= steps; ++i) {
    const double share = steps == 0 ? 0 : static_cast<double>(i) / steps;
    const auto x = static_cast<std::size_t>((from.x + share * (to.x - from.x) - left_) / cell_m_);
    const auto y = static_cast<std::size_t>((from.y + share * (to.y - from.y) - bottom_) / cell_m_);
    if (x >= width_ || y >= height_ || !IsOpen(y * width_ + x)) return false;
  }
  return true;
}

// A*, then corners that can be cut are.
std::vector<RoutePlanner::Point> RoutePlanner::Route(const Point& from, const Point& to,
                                                     double most_m) const {
  if (places_.empty()) return {};
  const std::size_t start = CellOf(from), goal = CellOf(to);
  // No way leaves the box that it could not come back from.
  const auto [first_x, last_x] = Reach(start % width_, width_, most_m);
  const auto [first_y, last_y] = Reach(start / width_, height_, most_m);
  const std::size_t columns = last_x - first_x + 1;
  const auto inside = [&, first_x = first_x, first_y = first_y](std::size_t cell) {
    return (cell / width_ - first_y) * columns + cell % width_ - first_x;
  };
  constexpr double kFar = std::numeric_limits<double>::infinity();
  constexpr std::uint8_t kNone = 8;
  std::vector<double> cost(columns * (last_y - first_y + 1), kFar);
  std::vector<std::uint8_t> came(cost.size(), kNone);  // by which of the eight steps
  const Point end = CentreOf(goal);
  const auto estimate = [&](std::size_t cell) {
    const Point at = CentreOf(cell);
    return std::hypot(at.x - end.x, at.y - end.y);
  };
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  cost[inside(start)] = 0;
  queue.emplace(estimate(start), start);
  bool found = false;
  while (!queue.empty() && !found) {
    const auto [total, cell] = queue.top();
    queue.pop();
    found = cell == goal;
    const double so_far = cost[inside(cell)];
    if (found || total > so_far + estimate(cell) + 1e-9) continue;
    const std::size_t x = cell % width_, y = cell / width_;
    for (std::uint8_t k = 0; k < 8; ++k) {
      // Below zero it is larger than any.
      const std::size_t i = x + static_cast<std::size_t>(kX[k]);
      const std::size_t j = y + static_cast<std::size_t>(kY[k]);
      if (i < first_x || i > last_x || j < first_y || j > last_y) continue;
      const std::size_t next = j * width_ + i;
      if (!IsOpen(next)) continue;
      // Not across a corner.
      if (k >= 4 && (!IsOpen(y * width_ + i) || !IsOpen(j * width_ + x))) continue;
      const double there = so_far + cell_m_ * (k < 4 ? 1 : std::sqrt(2.0));
      if (there >= cost[inside(next)] || there + estimate(next) > most_m) continue;
      cost[inside(next)] = there;
      came[inside(next)] = k;
      queue.emplace(there + estimate(next), next);
    }
  }
  if (!found) return {};
  std::vector<Point> cells(1, CentreOf(goal));
  for (std::size_t cell = goal; cell != start;) {
    const std::uint8_t k = came[inside(cell)];
    cell -= static_cast<std::size_t>(kY[k]) * width_ + static_cast<std::size_t>(kX[k]);
    cells.push_back(CentreOf(cell));
  }
  std::reverse(cells.begin(), cells.end());
  std::vector<Point> route(1, cells.front());
  for (std::size_t i = 0; i + 1 < cells.size();) {
    std::size_t next = i + 1;
    for (std::size_t j = i + 2; j < cells.size() && IsClear(cells[i], cells[j]); ++j) next = j;
    route.push_back(cells[next]);
    i = next;
  }
  return route;
}

}  // namespace graticule
