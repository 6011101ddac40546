#include "graticule/problems/mapping/cover.hpp"

namespace graticule {
namespace {

// The cells whose count is at least a number.
CellBits AtLeast(int number, const PageCounts& counts, int tile) {
  if (number >> counts.Planes()) return {};
  CellBits at_least = ~CellBits();
  for (int i = 0; i < counts.Planes(); ++i) {
    const CellBits& plane = counts.At(i, tile);
    at_least = (number >> i) & 1 ? plane & at_least : plane | at_least;
  }
  return at_least;
}

}  // namespace

void CoverSight::Replace(const ScanTile& before, const ScanTile& after) {
  const CellBits saw = before.passed | before.hit, sees = after.passed | after.hit;
  if (saw == sees) return;
  const TileIndex index = PageOf(after.index);
  if (!last_ || !(last_index_ == index)) {
    std::unique_ptr<PageCounts>& page = pages_.At(index);
    if (!page) page = std::make_unique<PageCounts>();
    last_ = page.get();
    last_index_ = index;
  }
  last_->Add(PlaceInPage(after.index), sees & ~saw, saw & ~sees);
}

bool CoverSight::Adds(const std::vector<ScanTile>& scan, const CoverOptions& options) const {
  int cells = 0, news = 0;
  for (const ScanTile& tile : scan) {
    const CellBits sees = tile.passed | tile.hit;
    const int count = sees.Count();
    cells += count;
    const std::unique_ptr<PageCounts>* page = pages_.Find(PageOf(tile.index));
    if (!page || !*page) {
      news += count;
      continue;
    }
    const CellBits unseen = sees & ~AtLeast(options.views, **page, PlaceInPage(tile.index));
    if (unseen.Any()) news += unseen.Count();
  }
  return news > options.news * cells;
}

}  // namespace graticule
