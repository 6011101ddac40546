#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "graticule/problems/mapping/cell_bits.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

/// A page is 8 x 8 tiles.
constexpr int kPageSide = 8;
constexpr int kPageTiles = kPageSide * kPageSide;

inline TileIndex PageOf(TileIndex tile) { return {tile.x >> 3, tile.y >> 3}; }
inline int PlaceInPage(TileIndex tile) { return 8 * (tile.y & 7) + (tile.x & 7); }
inline TileIndex TileOfPage(TileIndex page, int place) {
  return {8 * page.x + (place & 7), 8 * page.y + (place >> 3)};
}

/// Something a page, in a rectangle of pages that grows as it is asked for more.
template <class T>
class PageGrid {
 public:
  /// More pages than these (6.5 x 6.5 km at 0.1 m) are refused: one pose far off would otherwise
  /// take all memory.
  static constexpr std::int64_t kMaxPages = 1 << 18;

  /// Null where outside.
  const T* Find(TileIndex page) const {
    const std::int64_t x = std::int64_t{page.x} - left_, y = std::int64_t{page.y} - bottom_;
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return nullptr;
    return &items_[static_cast<std::size_t>(y * width_ + x)];
  }
  T* Find(TileIndex page) { return const_cast<T*>(static_cast<const PageGrid*>(this)->Find(page)); }

  /// Grows, by more than it has to, so that growing seldom is needed.
  /// Throws Error: too many pages.
  T& At(TileIndex page) {
    T* found = Find(page);
    if (!found) {
      Grow(page);
      found = Find(page);
    }
    return *found;
  }

  template <class F>
  void ForEach(F f) const {
    for (std::size_t i = 0; i < items_.size(); ++i) f(PageAt(i), items_[i]);
  }
  template <class F>
  void ForEach(F f) {
    for (std::size_t i = 0; i < items_.size(); ++i) f(PageAt(i), items_[i]);
  }

 private:
  TileIndex PageAt(std::size_t i) const {
    const auto width = static_cast<std::size_t>(width_);
    return {left_ + static_cast<std::int32_t>(i % width),
            bottom_ + static_cast<std::int32_t>(i / width)};
  }

  void Grow(TileIndex page) {
    PageGrid grown;
    std::int64_t right = std::int64_t{left_} + width_, top = std::int64_t{bottom_} + height_;
    std::int64_t left = left_, bottom = bottom_;
    if (items_.empty()) {
      left = page.x, right = page.x + 1;
      bottom = page.y, top = page.y + 1;
    }
    const std::int64_t spare_x = width_ / 4, spare_y = height_ / 4;
    if (page.x < left) left = page.x - spare_x;
    if (page.x >= right) right = page.x + 1 + spare_x;
    if (page.y < bottom) bottom = page.y - spare_y;
    if (page.y >= top) top = page.y + 1 + spare_y;
    const std::int64_t width = right - left, height = top - bottom;
    if (width > kMaxPages || height > kMaxPages || width * height > kMaxPages)
      throw Error("the map would have more than " + std::to_string(kMaxPages) +
                  " pages of 128 x 128 cells: is a pose far from all others?");
    grown.left_ = static_cast<std::int32_t>(left);
    grown.bottom_ = static_cast<std::int32_t>(bottom);
    grown.width_ = static_cast<std::int32_t>(width);
    grown.height_ = static_cast<std::int32_t>(height);
    grown.items_.resize(static_cast<std::size_t>(width * height));
    ForEach([&grown](TileIndex at, T& item) { *grown.Find(at) = std::move(item); });
    *this = std::move(grown);
  }

  std::int32_t left_ = 0, bottom_ = 0, width_ = 0, height_ = 0;
  std::vector<T> items_;
};

}  // namespace graticule
