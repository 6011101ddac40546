#include "graticule/problems/clique.hpp"

#include <algorithm>
#include <numeric>

namespace graticule {
namespace {

using Bits = std::vector<std::uint64_t>;

std::size_t CountBits(const std::uint64_t* words, std::size_t count) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += static_cast<std::size_t>(__builtin_popcountll(words[i]));
  return sum;
}

std::uint32_t LowestBit(std::uint64_t word) {
  return static_cast<std::uint32_t>(__builtin_ctzll(word));
}

void Clear(Bits* bits, std::uint32_t i) { (*bits)[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

class Search {
 public:
  Search(const Compatibility& graph, std::uint64_t work)
      : graph_(graph), words_(graph.Words()), work_(work), degree_(graph.Count()) {
    for (std::size_t i = 0; i < graph.Count(); ++i) degree_[i] = CountBits(graph.Row(i), words_);
  }

  Clique Run() {
    order_.resize(graph_.Count());
    std::iota(order_.begin(), order_.end(), 0u);
    std::stable_sort(order_.begin(), order_.end(),
                     [this](std::uint32_t a, std::uint32_t b) { return degree_[a] > degree_[b]; });
    Bits all(words_);
    for (const std::uint32_t i : order_) all[i / 64] |= std::uint64_t{1} << (i % 64);
    for (const std::uint32_t i : order_) {
      if (degree_[i] + 1 <= best_.size()) break;
      if (spent_ > work_ / 2) break;
      GrowFrom(i);
    }
    Branch(std::move(all));
    std::sort(best_.begin(), best_.end());
    return {best_, spent_ <= work_};
  }

 private:
  // Always the neighbour with the most neighbours of its own.
  void GrowFrom(std::uint32_t first) {
    std::vector<std::uint32_t> clique = {first};
    Bits left(graph_.Row(first), graph_.Row(first) + words_);
    for (const std::uint32_t i : order_) {
      if (!(left[i / 64] >> (i % 64) & 1)) continue;
      clique.push_back(i);
      for (std::size_t w = 0; w < words_; ++w) left[w] &= graph_.Row(i)[w];
      spent_ += words_;
    }
    spent_ += order_.size() / 8;
    if (clique.size() > best_.size()) best_ = std::move(clique);
  }

  // Vertices of `left` in the order of their colours, as far as a clique that is larger than the
  // best could end with them; a set with k colours holds no clique of more than k.
  void Colour(const Bits& left, std::vector<std::uint32_t>* vertices,
              std::vector<std::uint32_t>* colours) {
    const std::size_t needed = best_.size() >= current_.size() ? best_.size() - current_.size() : 0;
    Bits uncoloured = left, same(words_);
    for (std::uint32_t colour = 1; spent_ <= work_; ++colour) {
      same = uncoloured;
      bool any = false;
      for (std::size_t w = 0; w < words_; ++w)
        while (same[w]) {
          const std::uint32_t i = static_cast<std::uint32_t>(64 * w) + LowestBit(same[w]);
          any = true;
          Clear(&same, i);
          Clear(&uncoloured, i);
          for (std::size_t v = w; v < words_; ++v) same[v] &= ~graph_.Row(i)[v];
          spent_ += words_ - w;
          if (colour <= needed) continue;
          vertices->push_back(i);
          colours->push_back(colour);
        }
      spent_ += words_;
      if (!any) return;
    }
  }

  // Depth first, without recursion: a clique may have thousands of members.
  void Branch(Bits all) {
    struct Level {
      Bits left;
      std::vector<std::uint32_t> vertices, colours;
    };
    std::vector<Level> levels;
    const auto enter = [&](Bits left) {
      levels.emplace_back();
      levels.back().left = std::move(left);
      Colour(levels.back().left, &levels.back().vertices, &levels.back().colours);
    };
    enter(std::move(all));
    while (!levels.empty() && spent_ <= work_) {
      Level& level = levels.back();
      if (level.vertices.empty() || current_.size() + level.colours.back() <= best_.size()) {
        levels.pop_back();
        if (!current_.empty() && !levels.empty()) current_.pop_back();
        continue;
      }
      const std::uint32_t vertex = level.vertices.back();
      level.vertices.pop_back();
      level.colours.pop_back();
      Bits next(words_);
      for (std::size_t w = 0; w < words_; ++w) next[w] = level.left[w] & graph_.Row(vertex)[w];
      Clear(&level.left, vertex);
      spent_ += words_;
      current_.push_back(vertex);
      if (current_.size() > best_.size()) best_ = current_;
      enter(std::move(next));
    }
  }

  const Compatibility& graph_;
  const std::size_t words_;
  const std::uint64_t work_;
  std::uint64_t spent_ = 0;
  std::vector<std::size_t> degree_;
  std::vector<std::uint32_t> order_, current_, best_;
};

}  // namespace

Compatibility::Compatibility(std::size_t count)
    : count_(count), words_((count + 63) / 64), bits_(count * words_) {}

void Compatibility::Set(std::size_t a, std::size_t b) {
  bits_[a * words_ + b / 64] |= std::uint64_t{1} << (b % 64);
  bits_[b * words_ + a / 64] |= std::uint64_t{1} << (a % 64);
}

Clique FindLargestClique(const Compatibility& graph, std::uint64_t work) {
  return Search(graph, work).Run();
}

}  // namespace graticule
