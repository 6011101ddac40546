#include <cmath>

#include "graticule/problems/attenuation/signal_system_parts.hpp"

namespace graticule {
namespace {

using Lanes = SignalSystem::Lanes;

/// Sixteen signs (Steele, Lea, Flood 2014, as in problems/random.hpp) for one term.
Lanes Signs(std::uint64_t seed, std::uint64_t kind, std::uint64_t index) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + kind * 0xd1342543de82ef95u + index + 1;
  for (int i = 0; i < 2; ++i) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    z += 0x9e3779b97f4a7c15u;
  }
  Lanes signs;
  for (int lane = 0; lane < 16; ++lane) signs[lane] = (z >> (lane + 20)) & 1 ? 1.f : -1.f;
  return signs;
}

}  // namespace

void SignalSystem::Perturb(std::uint64_t seed, std::vector<Lanes>* b) const {
  const auto pull = [&](std::size_t row, double weight) -> Lanes {
    return Signs(seed, 0, row) * static_cast<float>(std::sqrt(weight));
  };
  const bool all = is_anew_ || b->empty();
  if (all) b->clear();
  b->resize(Size(), Lanes::Zero());
  if (all) {
    for (std::size_t i = 0; i < equations_.size(); ++i)
      AddTerms(equations_[i], pull(i, equations_[i].weight), b);
  }
  for (std::size_t c = 0; !all && c < changes_.size(); ++c) {
    const std::size_t row = changes_[c].row;
    if (changes_[c].before.weight > 0)
      AddTerms<Lanes>(changes_[c].before, -pull(row, changes_[c].before.weight), b);
    AddTerms(equations_[row], pull(row, equations_[row].weight), b);
  }
  const auto smooth = static_cast<float>(std::sqrt(SmoothWeight()));
  ForNewPairs(all ? 0 : cells_before_, [&](std::size_t from, std::size_t to, std::uint64_t which) {
    const Lanes off = Signs(seed, which, from) * smooth;
    (*b)[head_ + from] += off;
    (*b)[head_ + to] -= off;
  });
  for (std::size_t i = all ? 0 : head_ + cells_before_; i < Size(); ++i)
    (*b)[i] += Signs(seed, 3, i) * static_cast<float>(std::sqrt(prior_[i]));
}

double SignalSystem::DegreesOfFreedom(std::uint64_t seed, const std::vector<Lanes>& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    const SignalEquation& row = equations_[i];
    Lanes off = x[0] - x[1] * static_cast<float>(row.log_distance);
    if (row.receiver >= 0)
      off +=
          x[static_cast<std::size_t>(row.receiver)] + x[static_cast<std::size_t>(row.transmitter)];
    const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
    const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
    for (std::size_t k = 0; k < row.size; ++k)
      off -= x[head_ + static_cast<std::size_t>(cell[k])] * static_cast<float>(length[k]);
    sum += std::sqrt(row.weight) * static_cast<double>((off * Signs(seed, 0, i)).mean());
  }
  return sum;
}

}  // namespace graticule
