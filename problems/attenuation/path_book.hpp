#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "graticule/problems/attenuation/signal_rows.hpp"

namespace graticule {

/// Rays of links that are predicted again and again, each followed once, both ways alike.
class PathBook {
 public:
  struct Path {
    double log_distance = 0;  ///< as SignalRows::LogDistance
    std::vector<RayPiece> pieces;
  };
  static constexpr std::size_t kNone = SIZE_MAX;

  /// Follows those of `links` that are not known yet, and forgets what is not among them.  Without
  /// `with_pieces` only distances are kept.  Throws as SignalRows::CheckLink.
  void Keep(Span<const SignalLink> links, const SignalRows& rows, bool with_pieces);
  void Clear();

  /// The number of a link's path, below Count(); or kNone.  `*next`, 0 at first and then left
  /// alone, makes it quick for links that come in the order of the last Keep.
  std::size_t Find(const SignalLink& link, std::size_t* next) const;
  std::size_t Count() const { return entries_.size(); }
  const Path& At(std::size_t number) const { return entries_[number].path; }

 private:
  /// Radios, the lower first, and where each of them is.
  struct Name {
    std::uint32_t low, high;
    std::array<double, 6> at_m;
    bool operator==(const Name& other) const {
      return low == other.low && high == other.high && at_m == other.at_m;
    }
  };
  struct Hash {
    std::size_t operator()(const Name& name) const;
  };
  struct Entry {
    Path path;
    Name name = {};
    std::size_t wanted = 0;  // by which Keep last; 0: free
    std::size_t turn = 0;    // the last time in order_
  };
  static Name NameOf(const SignalLink& link);

  std::unordered_map<Name, std::size_t, Hash> numbers_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> order_;  // the last Keep's links
  std::size_t keeps_ = 0;
};

}  // namespace graticule
