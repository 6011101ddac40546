#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace graticule {

/// Points of the plane in square cells: who is near, in time that does not depend on how many there
/// are.  A range is never larger than a cell.
class Neighbours {
 public:
  explicit Neighbours(double cell_m) : cell_m_(cell_m) {}

  void Add(double x_m, double y_m, std::uint32_t id) { entries_.push_back({Cell(x_m, y_m), id}); }

  /// After the last Add.
  void Build() {
    std::sort(entries_.begin(), entries_.end());
    for (std::uint32_t i = 0; i < entries_.size(); ++i) {
      auto& range = cells_.emplace(entries_[i].first, std::pair(i, i)).first->second;
      range.second = i + 1;
    }
  }

  /// Calls found(cell's first, cell's last) for the cell of the point and its eight neighbours, in
  /// a fixed order; between them are entries for At.
  template <class Found>
  void Around(double x_m, double y_m, Found found) const {
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const auto it = cells_.find(Cell(x_m + dx * cell_m_, y_m + dy * cell_m_));
        if (it != cells_.end()) found(it->second.first, it->second.second);
      }
  }

  std::uint32_t At(std::size_t entry) const { return entries_[entry].second; }

 private:
  std::uint64_t Cell(double x_m, double y_m) const {
    const auto x = static_cast<std::int32_t>(std::floor(x_m / cell_m_));
    const auto y = static_cast<std::int32_t>(std::floor(y_m / cell_m_));
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) |
           static_cast<std::uint32_t>(y);
  }

  double cell_m_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, std::uint32_t>> cells_;
};

}  // namespace graticule
