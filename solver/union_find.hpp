#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace graticule {

/// Who hangs together, as pairs are told.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size = 0) { Reset(size); }
  /// Each a set of its own; memory is used again.
  void Reset(std::size_t size) {
    parent_.resize(size);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  /// One of the set of i; the same for all of it until the next Join.
  std::uint32_t Root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// False if they were one set already.
  bool Join(std::uint32_t a, std::uint32_t b) {
    a = Root(a);
    b = Root(b);
    Hang(a, b);
    return a != b;
  }
  /// Makes `root` the root of a set whose root was `below`: for who has found both, and says which
  /// stays.
  void Hang(std::uint32_t below, std::uint32_t root) { parent_[below] = root; }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace graticule
