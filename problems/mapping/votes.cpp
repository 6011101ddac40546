#include "graticule/problems/mapping/votes.hpp"

#include <algorithm>
#include <cstdlib>

namespace graticule {
namespace {

// A weighted count plus a constant.
constexpr unsigned kSumPlanes = kVotePlanes + 6;

struct Sum {
  CellBits planes[kSumPlanes];  // from `used` on: not set
  unsigned used = 0;
};

// sum += counts * 2^shift.
void AddShifted(const CellBits* counts, unsigned planes, unsigned shift, Sum* sum) {
  for (; sum->used < shift; ++sum->used) sum->planes[sum->used] = CellBits();
  CellBits carry;
  for (unsigned i = shift; i < kSumPlanes && (i - shift < planes || carry.Any()); ++i) {
    const CellBits a = i < sum->used ? sum->planes[i] : CellBits();
    const CellBits b = i - shift < planes ? counts[i - shift] : CellBits();
    const CellBits half = a ^ b;
    sum->planes[i] = half ^ carry;
    carry = (a & b) | (half & carry);
    sum->used = std::max(sum->used, i + 1);
  }
}

void AddConstant(unsigned constant, Sum* sum) {
  static const CellBits all = ~CellBits();
  for (unsigned bit = 0; constant >> bit; ++bit)
    if ((constant >> bit) & 1) AddShifted(&all, 1, bit, sum);
}

// Counts as the rule sees them: weighted, and no more than the saturation.  Returns where they are
// not zero.
CellBits Weigh(const PageCounts& page, int tile, unsigned weight, unsigned saturation, Sum* sum) {
  CellBits counts[kVotePlanes], any;
  unsigned planes = 0;
  for (int i = 0; i < page.Planes(); ++i) {
    counts[i] = page.At(i, tile);
    if (!counts[i].Any()) continue;
    any = any | counts[i];
    planes = static_cast<unsigned>(i) + 1;
  }
  unsigned bits = 0;
  while (saturation >> bits) ++bits;
  if (saturation > 0 && planes > bits) {
    CellBits over;
    for (unsigned i = bits; i < planes; ++i) over = over | counts[i];
    for (unsigned i = 0; i < bits; ++i) counts[i] = counts[i] | over;
    planes = bits;
  }
  for (unsigned shift = 0; weight >> shift; ++shift)
    if ((weight >> shift) & 1) AddShifted(counts, planes, shift, sum);
  return any;
}

// Where a >= b + constant.
CellBits AtLeast(const Sum& a, const Sum& b, int constant) {
  // a >= b + 1 is a > b: nothing to add for the usual rule.
  if (constant != 0 && constant != 1) {
    Sum raised;
    const Sum& from = constant > 0 ? b : a;
    raised.used = from.used;
    std::copy_n(from.planes, from.used, raised.planes);
    AddConstant(static_cast<unsigned>(std::abs(constant)), &raised);
    return constant > 0 ? AtLeast(a, raised, 0) : AtLeast(raised, b, 0);
  }
  CellBits at_least = constant == 0 ? ~CellBits() : CellBits();
  for (unsigned i = 0; i < std::max(a.used, b.used); ++i) {
    const CellBits in_a = i < a.used ? a.planes[i] : CellBits();
    const CellBits differ = i < b.used ? in_a ^ b.planes[i] : in_a;
    at_least = (in_a & differ) | (at_least & ~differ);
  }
  return at_least;
}

}  // namespace

void PageCounts::Grow() { planes_[used_++] = std::make_unique<Plane>(); }

void PageCounts::Add(int tile, const CellBits* plus, int count) {
  CellBits carry;
  for (int i = 0; i < count || carry.Any(); ++i) {
    const CellBits b = i < count ? plus[i] : CellBits();
    if (i >= used_ && !(b | carry).Any()) continue;
    CellBits& bits = Writable(i, tile);
    const CellBits half = bits ^ b, next = (bits & b) | (half & carry);
    bits = half ^ carry;
    carry = next;
  }
}

void PageCounts::Clear() {
  for (int i = 0; i < used_; ++i) *planes_[i] = {};
}

TileLabels LabelTile(const PageCounts& hit_counts, const PageCounts& pass_counts, int tile,
                     const VoteRule& rule) {
  Sum hits, passes;
  const CellBits was_hit = Weigh(hit_counts, tile, static_cast<unsigned>(rule.hit_votes),
                                 static_cast<unsigned>(rule.saturation), &hits);
  const CellBits was_passed = Weigh(pass_counts, tile, static_cast<unsigned>(rule.pass_votes),
                                    static_cast<unsigned>(rule.saturation), &passes);

  TileLabels labels;
  const CellBits seen = was_hit | was_passed;
  labels.structure = AtLeast(hits, passes, rule.structure_from - rule.bias) & seen;
  const CellBits above_free = rule.free_to == rule.structure_from - 1
                                  ? labels.structure
                                  : AtLeast(hits, passes, rule.free_to + 1 - rule.bias);
  labels.free = seen & ~above_free;
  labels.removed = labels.free & was_hit;
  return labels;
}

}  // namespace graticule
