#include "graticule/problems/mapping/dense_slice.hpp"

#include <algorithm>

namespace graticule {

void DenseSlice::Draw(const std::vector<const std::vector<ScanTile>*>& drawings) {
  bool any = false;
  for (const std::vector<ScanTile>* drawing : drawings)
    for (const ScanTile& tile : *drawing) {
      low_.x = any ? std::min(low_.x, tile.index.x) : tile.index.x;
      low_.y = any ? std::min(low_.y, tile.index.y) : tile.index.y;
      high_.x = any ? std::max(high_.x, tile.index.x) : tile.index.x;
      high_.y = any ? std::max(high_.y, tile.index.y) : tile.index.y;
      any = true;
    }
  if (!any) high_ = {low_.x - 1, low_.y - 1};
  planes_ = 0;
  while (drawings.size() >> planes_) ++planes_;
  const auto width = static_cast<std::size_t>(high_.x - low_.x + 1);
  const auto planes = static_cast<std::size_t>(planes_);
  const std::size_t size = width * static_cast<std::size_t>(high_.y - low_.y + 1) * planes;
  passes_.assign(size, {});
  hits_.assign(size, {});
  for (const std::vector<ScanTile>* drawing : drawings)
    for (const ScanTile& tile : *drawing) {
      const std::size_t at = (static_cast<std::size_t>(tile.index.y - low_.y) * width +
                              static_cast<std::size_t>(tile.index.x - low_.x)) *
                             planes;
      const auto i = [at](int plane) { return at + static_cast<std::size_t>(plane); };
      Count(tile.passed, {}, [&](int plane) -> CellBits& { return passes_[i(plane)]; });
      Count(tile.hit, {}, [&](int plane) -> CellBits& { return hits_[i(plane)]; });
    }
}

void DenseSlice::CompositeOnto(VoteGrid* grid) const {
  std::size_t at = 0;
  for (std::int32_t y = low_.y; y <= high_.y; ++y)
    for (std::int32_t x = low_.x; x <= high_.x; ++x, at += static_cast<std::size_t>(planes_))
      grid->Add({x, y}, &passes_[at], &hits_[at], planes_);
}

}  // namespace graticule
