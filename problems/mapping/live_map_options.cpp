#include "graticule/problems/mapping/live_map_options.hpp"

#include <cmath>
#include <string>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr int kMaxWeight = 15;
constexpr int kMaxConstant = 1 << 20;
constexpr double kMaxRangeInCells = 8192;

void Refuse(const char* what, int found, const char* expected) {
  throw Error(std::string("map votes: expected ") + what + " " + expected + ", found " +
                  std::to_string(found),
              ErrorKind::kUsage);
}

void Check(bool good, const std::string& expected, double found) {
  if (!good)
    throw Error("live map: expected " + expected + ", found " + Shown(found), ErrorKind::kUsage);
}

}  // namespace

const std::vector<std::pair<std::string, MapMethod>>& MapMethodNames() {
  static const std::vector<std::pair<std::string, MapMethod>> names = {
      {"naive", MapMethod::kNaive},
      {"naive-cover", MapMethod::kNaiveCover},
      {"cover-composite", MapMethod::kCoverComposite},
      {"incremental", MapMethod::kIncremental}};
  return names;
}

MapMethod MapMethodOf(std::string_view name) {
  std::string known;
  for (const auto& [word, method] : MapMethodNames()) {
    if (name == word) return method;
    known += (known.empty() ? "" : ", ") + word;
  }
  throw Error("there is no method '" + std::string(name) + "': expected one of " + known,
              ErrorKind::kUsage);
}

void CheckVoteRule(const VoteRule& rule) {
  if (rule.hit_votes < 1 || rule.hit_votes > kMaxWeight)
    Refuse("hit_votes", rule.hit_votes, "from 1 to 15");
  if (rule.pass_votes < 1 || rule.pass_votes > kMaxWeight)
    Refuse("pass_votes", rule.pass_votes, "from 1 to 15");
  for (const int constant : {rule.bias, rule.structure_from, rule.free_to})
    if (constant < -kMaxConstant || constant > kMaxConstant)
      Refuse("a bias or threshold", constant, "within a million");
  if (rule.free_to >= rule.structure_from) Refuse("free_to", rule.free_to, "below structure_from");
  if (rule.saturation < 0 || rule.saturation > kMaxConstant ||
      (rule.saturation & (rule.saturation + 1)) != 0)
    Refuse("saturation", rule.saturation, "2^n - 1, or 0");
}

void CheckLiveMapOptions(const LiveMapOptions& options) {
  CheckVoteRule(options.votes);
  Check(options.resolution > 0 && std::isfinite(options.resolution), "a resolution above 0",
        options.resolution);
  Check(options.ranges.max_range > 0 &&
            options.ranges.max_range <= kMaxRangeInCells * options.resolution,
        "a max_range above 0 and of at most 8192 cells", options.ranges.max_range);
  Check(options.slice_size > 0, "a slice_size of 1 or more",
        static_cast<double>(options.slice_size));
  Check(options.regenerate_above >= 0, "regenerate_above of 0 cells or more",
        options.regenerate_above);
  Check(options.cover.news >= 0 && options.cover.news <= 1, "cover.news from 0 to 1",
        options.cover.news);
  Check(options.cover.views >= 1 && options.cover.views <= 7, "cover.views from 1 to 7",
        options.cover.views);
  Check(options.threads >= 1 && options.threads <= 256, "threads from 1 to 256", options.threads);
}

}  // namespace graticule
