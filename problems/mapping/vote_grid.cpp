#include "graticule/problems/mapping/vote_grid.hpp"

#include <algorithm>

namespace graticule {
namespace {

constexpr std::uint64_t kColumn0 = 0x0001000100010001;  // of each row
constexpr std::uint64_t kColumn15 = 0x8000800080008000;

CellBits Unknown(const MapTile& tile) { return ~(tile.structure | tile.free); }

// Cells of a tile that have an unknown one beside them.
CellBits BesideUnknown(const CellBits& own, const CellBits& left, const CellBits& right,
                       const CellBits& below, const CellBits& above) {
  CellBits beside;
  for (int i = 0; i < 4; ++i) {
    const std::uint64_t word = own.words[i];
    const std::uint64_t from_left =
        ((word & ~kColumn15) << 1) | ((left.words[i] & kColumn15) >> 15);
    const std::uint64_t from_right =
        ((word & ~kColumn0) >> 1) | ((right.words[i] & kColumn0) << 15);
    const std::uint64_t under = i > 0 ? own.words[i - 1] : below.words[3];
    const std::uint64_t over = i < 3 ? own.words[i + 1] : above.words[0];
    beside.words[i] =
        from_left | from_right | (word << 16) | (under >> 48) | (word >> 16) | (over << 48);
  }
  return beside;
}

// A version of the map in the making: pages are copied when they are first written to.
class Draft {
 public:
  explicit Draft(const OccupancyMap& before)
      : version_(before.Version() + 1), pages_(before.AllPages()) {}

  const MapTile& At(TileIndex tile) const {
    static const MapTile empty;
    const std::shared_ptr<const MapPage>* page = pages_.Find(PageOf(tile));
    return page && *page ? (*page)->tiles[PlaceInPage(tile)] : empty;
  }

  MapTile& Write(TileIndex tile) {
    std::shared_ptr<const MapPage>& shared = pages_.At(PageOf(tile));
    MapPage* page;
    if (shared && shared->newest == version_) {
      // Only this draft makes pages of this version, and nobody has seen them yet.
      page = const_cast<MapPage*>(shared.get());
    } else {
      auto copy = shared ? std::make_shared<MapPage>(*shared) : std::make_shared<MapPage>();
      page = copy.get();
      page->newest = version_;
      shared = std::move(copy);
    }
    page->changed_in[PlaceInPage(tile)] = version_;
    return page->tiles[PlaceInPage(tile)];
  }

  std::shared_ptr<const OccupancyMap> Finish(double resolution) {
    return std::make_shared<const OccupancyMap>(resolution, version_, std::move(pages_));
  }

 private:
  std::uint64_t version_;
  OccupancyMap::Pages pages_;
};

// The tiles whose frontier may change as a tile's labels do: its own, and those beside an edge with
// a cell that has become known, or unknown.
void AppendAffected(TileIndex index, const MapTile& before, const TileLabels& after,
                    std::vector<TileIndex>* affected) {
  affected->push_back(index);
  const CellBits changed = (before.structure | before.free) ^ (after.structure | after.free);
  if (!changed.Any()) return;
  const std::uint64_t any =
      changed.words[0] | changed.words[1] | changed.words[2] | changed.words[3];
  if (any & kColumn0) affected->push_back({index.x - 1, index.y});
  if (any & kColumn15) affected->push_back({index.x + 1, index.y});
  if (changed.words[0] & 0xffff) affected->push_back({index.x, index.y - 1});
  if (changed.words[3] >> 48) affected->push_back({index.x, index.y + 1});
}

CellIndex CellOf(TileIndex tile, int column, int row) {
  return {kTileSide * tile.x + column, kTileSide * tile.y + row};
}

void AppendFlips(TileIndex index, const MapTile& before, const TileLabels& after,
                 std::vector<CellFlip>* flips) {
  const auto label = [](const CellBits& structure, const CellBits& free, int x, int y) {
    return structure.Test(x, y) ? Occupancy::kStructure
           : free.Test(x, y)    ? Occupancy::kFree
                                : Occupancy::kUnknown;
  };
  ForEachCell((before.structure ^ after.structure) | (before.free ^ after.free), [&](int x, int y) {
    flips->push_back({CellOf(index, x, y), label(before.structure, before.free, x, y),
                      label(after.structure, after.free, x, y)});
  });
}

void UpdateFrontier(TileIndex index, Draft* draft, MapChange* change) {
  const MapTile& tile = draft->At(index);
  const auto unknown = [&](int dx, int dy) {
    return Unknown(draft->At({index.x + dx, index.y + dy}));
  };
  const CellBits frontier =
      tile.free.Any() ? tile.free & BesideUnknown(Unknown(tile), unknown(-1, 0), unknown(1, 0),
                                                  unknown(0, -1), unknown(0, 1))
                      : CellBits();
  const CellBits before = tile.frontier;
  if (frontier == before) return;
  draft->Write(index).frontier = frontier;
  ForEachCell(frontier & ~before,
              [&](int x, int y) { change->frontier_came.push_back(CellOf(index, x, y)); });
  ForEachCell(before & ~frontier,
              [&](int x, int y) { change->frontier_went.push_back(CellOf(index, x, y)); });
}

}  // namespace

VoteGrid::Page& VoteGrid::PageAt(TileIndex index) {
  std::unique_ptr<Page>& page = pages_.At(index);
  if (!page) {
    page = std::make_unique<Page>();
    page->index = index;
  }
  return *page;
}

VoteGrid::Page& VoteGrid::Dirty(TileIndex tile) {
  const TileIndex index = PageOf(tile);
  if (!last_ || !(last_->index == index)) last_ = &PageAt(index);
  const std::uint64_t bit = std::uint64_t{1} << PlaceInPage(tile);
  if (!(last_->dirty & bit)) {
    if (!last_->dirty) dirty_pages_.push_back(last_);
    last_->dirty |= bit;
    ++dirty_tiles_;
  }
  last_->used |= bit;
  return *last_;
}

void VoteGrid::Replace(const ScanTile& before, const ScanTile& after) {
  Page& page = Dirty(after.index);
  const int place = PlaceInPage(after.index);
  page.passes.Add(place, after.passed & ~before.passed, before.passed & ~after.passed);
  page.hits.Add(place, after.hit & ~before.hit, before.hit & ~after.hit);
}

void VoteGrid::Add(TileIndex index, const CellBits* passes, const CellBits* hits, int planes) {
  Page& page = Dirty(index);
  page.passes.Add(PlaceInPage(index), passes, planes);
  page.hits.Add(PlaceInPage(index), hits, planes);
}

void VoteGrid::Clear() {
  pages_.ForEach([this](TileIndex, std::unique_ptr<Page>& page) {
    if (!page || !page->used) return;
    if (!page->dirty) dirty_pages_.push_back(page.get());
    dirty_tiles_ += static_cast<std::size_t>(__builtin_popcountll(page->used & ~page->dirty));
    page->dirty |= page->used;
    page->used = 0;
    page->hits.Clear();
    page->passes.Clear();
  });
}

std::shared_ptr<const OccupancyMap> VoteGrid::Publish(
    const std::shared_ptr<const OccupancyMap>& before, MapChange* change) {
  *change = {};
  change->dirty_tiles = dirty_tiles_;
  if (dirty_tiles_ == 0) return before;
  Draft draft(*before);
  bool any = false;
  std::vector<TileIndex> affected;
  for (Page* page : dirty_pages_) {
    for (std::uint64_t dirty = page->dirty; dirty; dirty &= dirty - 1) {
      const int place = __builtin_ctzll(dirty);
      const TileIndex index = TileOfPage(page->index, place);
      const MapTile& old = before->TileAt(index);
      const TileLabels labels = LabelTile(page->hits, page->passes, place, rule_);
      const bool relabelled = labels.structure != old.structure || labels.free != old.free;
      if (!relabelled && labels.removed == old.removed) continue;
      if (relabelled) {
        change->changed_tiles.push_back(index);
        AppendFlips(index, old, labels, &change->flips);
        AppendAffected(index, old, labels, &affected);
      }
      MapTile& tile = draft.Write(index);
      tile.structure = labels.structure;
      tile.free = labels.free;
      tile.removed = labels.removed;
      any = true;
    }
    page->dirty = 0;
  }
  dirty_pages_.clear();
  dirty_tiles_ = 0;
  if (!any) return before;

  std::sort(affected.begin(), affected.end());
  affected.erase(std::unique(affected.begin(), affected.end()), affected.end());
  for (const TileIndex tile : affected) UpdateFrontier(tile, &draft, change);
  std::sort(change->changed_tiles.begin(), change->changed_tiles.end());
  return draft.Finish(before->Resolution());
}

}  // namespace graticule
