#include "graticule/problems/mapping/cover.hpp"

#include <algorithm>

namespace graticule {

void Footprint::FindBox() {
  if (tiles.empty()) {
    low = {0, 0};
    high = {-1, -1};
    return;
  }
  low = high = tiles.front().index;
  for (const ScanTile& tile : tiles) {
    low.x = std::min(low.x, tile.index.x);
    high.x = std::max(high.x, tile.index.x);
  }
  high.y = tiles.back().index.y;
}

CoverTest::CoverTest(const CoverOptions& options, const Footprint& candidate)
    : candidate_(candidate), views_(options.views), seen_(candidate.tiles.size()) {
  if (candidate.tiles.empty()) return;
  const std::int32_t width = candidate.high.x - candidate.low.x + 1;
  place_.assign(static_cast<std::size_t>(width) *
                    static_cast<std::size_t>(candidate.high.y - candidate.low.y + 1),
                -1);
  int cells = 0;
  for (std::size_t i = 0; i < candidate.tiles.size(); ++i) {
    const ScanTile& tile = candidate.tiles[i];
    place_[static_cast<std::size_t>((tile.index.y - candidate.low.y) * width + tile.index.x -
                                    candidate.low.x)] = static_cast<std::int16_t>(i);
    cells += (tile.passed | tile.hit).Count();
  }
  news_ = cells;
  allowed_ = options.news * cells;
}

bool CoverTest::StillAdds(const Footprint& member) {
  if (!Adds() || !candidate_.Meets(member)) return Adds();
  const std::int32_t width = candidate_.high.x - candidate_.low.x + 1;
  for (const ScanTile& tile : member.tiles) {
    if (tile.index.y < candidate_.low.y || tile.index.x < candidate_.low.x ||
        tile.index.x > candidate_.high.x)
      continue;
    if (tile.index.y > candidate_.high.y) break;
    const int place = place_[static_cast<std::size_t>((tile.index.y - candidate_.low.y) * width +
                                                      tile.index.x - candidate_.low.x)];
    if (place < 0) continue;
    const ScanTile& own = candidate_.tiles[static_cast<std::size_t>(place)];
    Seen& seen = seen_[static_cast<std::size_t>(place)];
    const CellBits sees = (tile.passed | tile.hit) & (own.passed | own.hit);
    const CellBits enough = seen.at_least[views_ - 1];
    for (int i = views_ - 1; i > 0; --i)
      seen.at_least[i] = seen.at_least[i] | (seen.at_least[i - 1] & sees);
    seen.at_least[0] = seen.at_least[0] | sees;
    news_ -= (seen.at_least[views_ - 1] & ~enough).Count();
  }
  return Adds();
}

}  // namespace graticule
