#pragma once

#include <cmath>
#include <cstdint>

namespace graticule {

/// Random numbers whose digits come from here, not from the standard library of the day: SplitMix64
/// (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014) and Box-Muller.
class RandomNumbers {
 public:
  /// Streams of one seed are independent: a world stays the same when its noise changes.
  explicit RandomNumbers(std::uint64_t seed, std::uint64_t stream = 0) : state_(seed) {
    state_ = Bits() ^ (stream * 0xd1342543de82ef95u);
    Bits();
  }

  std::uint64_t Bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double Unit() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  /// In [0, count), for counts far below 2^53.
  std::uint64_t Below(std::uint64_t count) {
    return static_cast<std::uint64_t>(static_cast<double>(count) * Unit());
  }
  /// Of mean 0 and standard deviation 1.
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2 * std::log(1 - Unit()));
    const double angle = 2 * M_PI * Unit();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  std::uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace graticule
