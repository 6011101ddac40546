#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace graticule {

/// Who hangs together, as pairs are told.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
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
    parent_[a] = b;
    return a != b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace graticule
