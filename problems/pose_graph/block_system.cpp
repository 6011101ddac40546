#include "graticule/problems/pose_graph/block_system.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>

#include "graticule/solver/numeric_guard.hpp"

namespace graticule {
namespace {

cholmod_sparse LowerTriangle(std::vector<int>& begins, std::vector<int>& rows, double* values) {
  cholmod_sparse view{};
  view.nrow = view.ncol = begins.size() - 1;
  view.nzmax = rows.size();
  view.p = begins.data();
  view.i = rows.data();
  view.x = values;
  view.stype = -1;  // what lies above the diagonal, inside its blocks, is not read
  view.itype = CHOLMOD_INT;
  view.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

// The blocks of each column on and below the diagonal, rows ascending.
struct Pattern {
  std::vector<int> begins, rows;

  Pattern(const std::vector<std::pair<int, int>>& links, const std::vector<int>& place)
      : begins(place.size() + 1, 0) {
    // By row first, then by column: a bucket sort that leaves the rows in order.
    std::vector<int> row_begins(place.size() + 1, 0);
    const auto ends = [&](const std::pair<int, int>& link) {
      return std::minmax(place[static_cast<std::size_t>(link.first)],
                         place[static_cast<std::size_t>(link.second)]);
    };
    for (const auto& link : links) ++row_begins[static_cast<std::size_t>(ends(link).second) + 1];
    for (std::size_t i = 1; i < row_begins.size(); ++i) row_begins[i] += row_begins[i - 1];
    std::vector<int> columns(links.size());
    std::vector<int> next(row_begins.begin(), row_begins.end() - 1);
    for (const auto& link : links) {
      const auto [column, row] = ends(link);
      columns[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = column;
    }
    std::vector<int> last(place.size(), -1);  // the column's latest row: parallel links count once
    const auto each = [&](auto&& visit) {
      std::fill(last.begin(), last.end(), -1);
      for (std::size_t row = 0; row < place.size(); ++row) {
        for (int k = row_begins[row]; k < row_begins[row + 1]; ++k) {
          const auto column = static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]);
          if (last[column] == static_cast<int>(row)) continue;
          last[column] = static_cast<int>(row);
          visit(column, row);
        }
      }
    };
    each([&](std::size_t column, std::size_t) { ++begins[column + 1]; });
    for (std::size_t j = 0; j < place.size(); ++j) begins[j + 1] += begins[j] + 1;
    rows.resize(static_cast<std::size_t>(begins.back()));
    next.assign(begins.begin(), begins.end() - 1);
    for (std::size_t j = 0; j < place.size(); ++j)
      rows[static_cast<std::size_t>(next[j]++)] = static_cast<int>(j);
    each([&](std::size_t column, std::size_t row) {
      rows[static_cast<std::size_t>(next[column]++)] = static_cast<int>(row);
    });
  }

  // Of a block among those of its column.
  int PositionOf(int row, int column) const {
    const auto first = rows.begin() + begins[static_cast<std::size_t>(column)];
    const auto last = rows.begin() + begins[static_cast<std::size_t>(column) + 1];
    return static_cast<int>(std::lower_bound(first, last, row) - first);
  }
};

}  // namespace

struct BlockSystem::Cholesky {
  cholmod_common common;
  cholmod_factor* factor = nullptr;

  Cholesky() {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.try_catch = 1;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.postorder = 0;
    // Twice what CHOLMOD merges supernodes up to: a fifth less time in the plane, none lost in
    // space.
    common.nrelax[0] = 16;
    common.nrelax[1] = 48;
    common.nrelax[2] = 96;
    common.final_ll = 1;  // LDL' would go on past a negative pivot
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholesky() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  // The place of each node in the order of elimination: minimum degree on the blocks, then the
  // postorder of their elimination tree.  On the numbers inside the blocks it would come out the
  // same, later; and a matrix that is in order need not be permuted whenever it is factorised.
  std::vector<int> Order(int nodes, const std::vector<std::pair<int, int>>& links) {
    const auto count = static_cast<std::size_t>(nodes);
    std::vector<int> place(count), order(count), parent(count), postorder(count);
    for (std::size_t i = 0; i < count; ++i) place[i] = static_cast<int>(i);
    Pattern given(links, place);
    cholmod_sparse blocks = LowerTriangle(given.begins, given.rows, nullptr);
    if (!cholmod_amd(&blocks, nullptr, 0, order.data(), &common)) return place;
    cholmod_sparse* ordered = cholmod_ptranspose(&blocks, 0, order.data(), nullptr, 0, &common);
    const bool found =
        ordered && cholmod_etree(ordered, parent.data(), &common) &&
        cholmod_postorder(parent.data(), count, nullptr, postorder.data(), &common) == nodes;
    cholmod_free_sparse(&ordered, &common);
    for (std::size_t i = 0; i < count; ++i) {
      const auto step = found ? static_cast<std::size_t>(postorder[i]) : i;
      place[static_cast<std::size_t>(order[step])] = static_cast<int>(i);
    }
    return place;
  }
};

BlockSystem::BlockSystem(int block_size, int nodes, const std::vector<std::pair<int, int>>& links,
                         const BlockSystem* ordered_like)
    : size_(block_size), cholesky_(std::make_unique<Cholesky>()) {
  const NumericGuard guard;
  place_ = ordered_like ? ordered_like->place_ : cholesky_->Order(nodes, links);
  const Pattern pattern(links, place_);
  const auto size = static_cast<std::size_t>(size_);
  const auto slot_of = [&](int column, int position) {
    const int first = pattern.begins[static_cast<std::size_t>(column)];
    const int blocks = pattern.begins[static_cast<std::size_t>(column) + 1] - first;
    return Slot{
        size * (size * static_cast<std::size_t>(first) + static_cast<std::size_t>(position)),
        size_ * blocks, false};
  };
  begins_.reserve(place_.size() * size + 1);
  begins_.push_back(0);
  rows_.reserve(pattern.rows.size() * size * size);
  for (std::size_t j = 0; j < place_.size(); ++j)
    for (int c = 0; c < size_; ++c) {
      for (int k = pattern.begins[j]; k < pattern.begins[j + 1]; ++k)
        for (int r = 0; r < size_; ++r)
          rows_.push_back(pattern.rows[static_cast<std::size_t>(k)] * size_ + r);
      begins_.push_back(static_cast<int>(rows_.size()));
    }
  values_.assign(rows_.size(), 0);
  node_slots_.reserve(place_.size());
  for (const int place : place_) node_slots_.push_back(slot_of(place, 0));
  link_slots_.reserve(links.size());
  for (const auto& [first, second] : links) {
    const int i = place_[static_cast<std::size_t>(first)];
    const int j = place_[static_cast<std::size_t>(second)];
    const int row = std::max(i, j), column = std::min(i, j);
    link_slots_.push_back(slot_of(column, pattern.PositionOf(row, column)));
    link_slots_.back().transposed = i < j;
  }
  cholmod_sparse matrix = LowerTriangle(begins_, rows_, values_.data());
  cholesky_->factor = cholmod_analyze(&matrix, &cholesky_->common);
}

BlockSystem::~BlockSystem() = default;

void BlockSystem::Clear() { std::fill(values_.begin(), values_.end(), 0.0); }

bool BlockSystem::Solve(std::vector<double>* rhs, int columns) {
  const NumericGuard guard;
  Cholesky& cholesky = *cholesky_;
  if (!cholesky.factor) return false;
  const std::size_t size = begins_.size() - 1;
  cholmod_sparse matrix = LowerTriangle(begins_, rows_, values_.data());
  if (!cholmod_factorize(&matrix, cholesky.factor, &cholesky.common) ||
      cholesky.common.status != CHOLMOD_OK || cholesky.factor->minor < size)
    return false;

  // From the nodes' order into that of elimination, and back.
  std::vector<double> ordered(rhs->size());
  const auto each = [&](auto&& visit) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns); ++c)
      for (std::size_t node = 0; node < place_.size(); ++node)
        for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i)
          visit(c * size + node * static_cast<std::size_t>(size_) + i,
                c * size + static_cast<std::size_t>(place_[node] * size_) + i);
  };
  each([&](std::size_t outside, std::size_t inside) { ordered[inside] = (*rhs)[outside]; });
  cholmod_dense right{};
  right.nrow = right.d = size;
  right.ncol = static_cast<std::size_t>(columns);
  right.nzmax = ordered.size();
  right.x = ordered.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* solution = cholmod_solve(CHOLMOD_A, cholesky.factor, &right, &cholesky.common);
  if (!solution) return false;
  const double* x = static_cast<const double*>(solution->x);
  const bool finite =
      std::all_of(x, x + ordered.size(), [](double value) { return std::isfinite(value); });
  if (finite) each([&](std::size_t outside, std::size_t inside) { (*rhs)[outside] = x[inside]; });
  cholmod_free_dense(&solution, &cholesky.common);
  return finite;
}

}  // namespace graticule
