#include "graticule/problems/calibration/guess_target.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <thread>

#include "graticule/problems/calibration/chessboard.hpp"
#include "graticule/problems/calibration/detect.hpp"
#include "graticule/problems/calibration/marker_layout.hpp"
#include "graticule/problems/parallel_for.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostImages = 12;
constexpr std::size_t kLeastPairs = 6;

std::size_t Threads() { return std::max(1u, std::thread::hardware_concurrency()); }

std::optional<Target> GuessChessboard(const std::vector<const GreyImage*>& images) {
  std::vector<std::optional<SeenChessboard>> boards(images.size());
  ParallelFor(images.size(), Threads(),
              [&](std::size_t, std::size_t i) { boards[i] = FindAnyChessboard(*images[i]); });
  std::map<std::pair<int, int>, std::size_t> counts;
  for (const auto& board : boards)
    if (board) ++counts[{board->columns, board->rows}];
  // What is seen most often; of two, the larger: a board that is partly hidden looks smaller.
  std::pair<int, int> size = {0, 0};
  std::size_t most = 0;
  for (const auto& [known, count] : counts)
    if (count > most || (count == most && known.first * known.second > size.first * size.second)) {
      size = known;
      most = count;
    }
  if (most == 0 || 3 * most < images.size()) return std::nullopt;
  Target target;
  target.kind = TargetKind::kChessboard;
  target.columns = size.first;
  target.rows = size.second;
  target.pitch_m = kNominalPitch_m;
  return target;
}

/// How many corners of the last row are in these pictures.
std::size_t CornersInLastRow(const Target& target, const std::vector<const GreyImage*>& images) {
  const TargetDetector detector(target);
  const std::vector<TargetCorner> all = CornersOf(target);
  double last = 0;
  for (const TargetCorner& corner : all) last = std::max(last, corner.in_target[1]);
  std::vector<std::size_t> counts(images.size());
  ParallelFor(images.size(), Threads(), [&](std::size_t, std::size_t i) {
    for (const DetectedCorner& corner : detector.Detect(*images[i]))
      counts[i] += corner.in_target[1] > last - 1e-3 * target.pitch_m;
  });
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

/// A last row whose markers were nowhere read may still show its corners.
void AddUnreadRows(const std::vector<const GreyImage*>& images, Target* target) {
  constexpr int kMostAdded = 3;
  if (target->kind != TargetKind::kAprilGrid && target->kind != TargetKind::kCharuco) return;
  for (int i = 0; i < kMostAdded; ++i) {
    Target larger = *target;
    // A legacy board has an even number of rows.
    larger.rows += target->is_legacy ? 2 : 1;
    try {
      CheckTarget(larger);
    } catch (const Error&) {
      return;  // the family has no more markers
    }
    if (CornersInLastRow(larger, images) < static_cast<std::size_t>(target->columns)) return;
    *target = larger;
  }
}

}  // namespace

std::optional<Target> GuessTarget(const std::vector<GreyImage>& all) {
  std::vector<const GreyImage*> images;
  const std::size_t count = std::min(all.size(), kMostImages);
  for (std::size_t i = 0; i < count; ++i) images.push_back(&all[i * all.size() / count]);

  struct Search {
    const char* family;
    int border_cells;
    bool is_charuco;
  };
  constexpr Search kSearches[] = {
      {"tag36h11", 2, false},    {"tag36h11", 1, false},    {"tag36h10", 1, false},
      {"tag25h9", 1, false},     {"DICT_4X4_250", 1, true}, {"DICT_5X5_250", 1, true},
      {"DICT_6X6_250", 1, true}, {"DICT_7X7_250", 1, true}, {"tag36h11", 1, true},
  };
  LayoutGuess best;
  for (const Search& search : kSearches) {
    MarkerFamily family = MarkerFamilyOf(search.family);
    family.correctable = 0;  // whether a target is there at all is asked here
    const MarkerDetector detector(family, {search.border_cells, 1, search.border_cells == 2});
    std::vector<std::vector<MarkerPair>> seen(images.size());
    ParallelFor(images.size(), Threads(), [&](std::size_t, std::size_t i) {
      seen[i] = PairsOf(detector.Detect(*images[i]));
    });
    std::vector<MarkerPair> pairs;
    for (const auto& own : seen) pairs.insert(pairs.end(), own.begin(), own.end());
    if (pairs.size() < kLeastPairs) continue;
    const LayoutGuess guess = search.is_charuco
                                  ? GuessCharucoLayout(pairs, family)
                                  : GuessTagLayout(pairs, family, search.border_cells);
    // Walls have tags, too; but then they are not the larger part.
    if (guess.fitting > best.fitting && 3 * guess.fitting > pairs.size()) best = guess;
  }
  if (best.fitting >= kLeastPairs) {
    AddUnreadRows(images, &best.target);
    return best.target;
  }
  return GuessChessboard(images);
}

}  // namespace graticule
