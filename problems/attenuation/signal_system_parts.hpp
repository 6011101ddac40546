#pragma once

// What the files of SignalSystem share, and nobody else includes.

#include <cstddef>
#include <vector>

#include "graticule/problems/attenuation/signal_system.hpp"

namespace graticule {

// One right-hand side or sixteen, by the same lines.
inline double Scalar(double, double value) { return value; }
inline float Scalar(const SignalSystem::Lanes&, double value) { return static_cast<float>(value); }
inline void SetZero(double* v) { *v = 0; }
inline void SetZero(SignalSystem::Lanes* v) { v->setZero(); }

template <class V>
std::vector<V> Zeros(std::size_t size) {
  V zero;
  SetZero(&zero);
  return std::vector<V>(size, zero);
}

/// Adds a row's terms, times `pull`.
template <class V>
void SignalSystem::AddTerms(const SignalEquation& row, const V& pull, std::vector<V>* to) const {
  std::vector<V>& sums = *to;
  sums[0] += pull;
  sums[1] -= pull * Scalar(pull, row.log_distance);
  if (row.receiver >= 0) {
    sums[static_cast<std::size_t>(row.receiver)] += pull;
    sums[static_cast<std::size_t>(row.transmitter)] += pull;
  }
  const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
  const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
  for (std::size_t k = 0; k < row.size; ++k)
    sums[head_ + static_cast<std::size_t>(cell[k])] -= pull * Scalar(pull, length[k]);
}

/// Calls f(first, second, which) for neighbours of whom one is a cell numbered `from` or above;
/// `which` is 1 where the second is to the right of the first, 2 where it is above.
template <class F>
void SignalSystem::ForNewPairs(std::size_t from, const F& f) const {
  const AttenuationCells& cells = rows_->Cells();
  for (std::size_t i = from; i < cells.Count(); ++i) {
    const AttenuationCell& cell = cells.At(i);
    const std::int32_t ahead[] = {cells.Right(i), cells.Up(i)};
    const std::int32_t behind[] = {cells.Find(cell.material, cell.x - 1, cell.y),
                                   cells.Find(cell.material, cell.x, cell.y - 1)};
    for (std::uint64_t k = 0; k < 2; ++k) {
      if (ahead[k] >= 0) f(i, static_cast<std::size_t>(ahead[k]), k + 1);
      // Of a new one it was that one's neighbour ahead.
      if (behind[k] >= 0 && static_cast<std::size_t>(behind[k]) < from)
        f(static_cast<std::size_t>(behind[k]), i, k + 1);
    }
  }
}

}  // namespace graticule
