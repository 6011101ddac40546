#include "graticule/solver/nearest.hpp"

#include <algorithm>
#include <numeric>

namespace graticule {
namespace {

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

}  // namespace

std::string DidYouMean(std::string_view wrong, const std::vector<std::string_view>& names) {
  wrong = wrong.substr(0, 64);
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(2, wrong.size() / 2);
  for (const std::string_view name : names) {
    const std::size_t distance = EditDistance(wrong, name);
    if (distance < best_distance || (distance == best_distance && best.empty())) {
      best = name;
      best_distance = distance;
    }
  }
  return best.empty() ? "" : " (did you mean '" + std::string(best) + "'?)";
}

}  // namespace graticule
