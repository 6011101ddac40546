#include "graticule/problems/mapping/cover.hpp"

namespace graticule {
namespace {

// The cells whose count is at least a number.
CellBits AtLeast(int number, const CellBits* planes, int used) {
  if (number >> used) return {};
  CellBits at_least = ~CellBits();
  for (int i = 0; i < used; ++i)
    at_least = (number >> i) & 1 ? planes[i] & at_least : planes[i] | at_least;
  return at_least;
}

}  // namespace

void CoverSight::Replace(const ScanTile& before, const ScanTile& after) {
  const CellBits saw = before.passed | before.hit, sees = after.passed | after.hit;
  if (saw == sees) return;
  const TileIndex index = PageOf(after.index);
  if (!last_ || !(last_index_ == index)) {
    std::unique_ptr<Page>& page = pages_.At(index);
    if (!page) page = std::make_unique<Page>();
    last_ = page.get();
    last_index_ = index;
  }
  Tile& tile = last_->tiles[PlaceInPage(after.index)];
  Count(sees & ~saw, saw & ~sees, tile.planes, &tile.used);
}

bool CoverSight::Adds(const std::vector<ScanTile>& scan, const CoverOptions& options) const {
  int cells = 0, news = 0;
  for (const ScanTile& tile : scan) {
    const CellBits sees = tile.passed | tile.hit;
    const int count = sees.Count();
    cells += count;
    const std::unique_ptr<Page>* page = pages_.Find(PageOf(tile.index));
    if (!page || !*page) {
      news += count;
      continue;
    }
    const Tile& seen = (*page)->tiles[PlaceInPage(tile.index)];
    const CellBits unseen = sees & ~AtLeast(options.views, seen.planes, seen.used);
    if (unseen.Any()) news += unseen.Count();
  }
  return news > options.news * cells;
}

}  // namespace graticule
