#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace graticule {

/// Which of n things go together, two by two: symmetric, without a diagonal.  n^2 bits.
class Compatibility {
 public:
  explicit Compatibility(std::size_t count);
  std::size_t Count() const { return count_; }
  void Set(std::size_t a, std::size_t b);
  bool Has(std::size_t a, std::size_t b) const { return Row(a)[b / 64] >> (b % 64) & 1; }
  const std::uint64_t* Row(std::size_t a) const { return bits_.data() + a * words_; }
  std::size_t Words() const { return words_; }

 private:
  std::size_t count_, words_;
  std::vector<std::uint64_t> bits_;
};

struct Clique {
  std::vector<std::uint32_t> members;  ///< in order
  bool is_largest = false;             ///< proven; else the largest that was found
};

/// A largest set of things that all go together, two by two.  First greedily from each thing
/// (Pattabiraman et al.: Fast algorithms for the maximum clique problem on massive graphs, 2015,
/// algorithm 2), then by branch and bound with colourings (Tomita and Seki: An efficient
/// branch-and-bound algorithm, 2003).  The search ends after `work` words of bits have been looked
/// at, about a nanosecond each: the problem is NP-hard.  A count, not a time, so that the answer is
/// the same every time.
Clique FindLargestClique(const Compatibility& graph, std::uint64_t work = 2000000000);

}  // namespace graticule
