#include "graticule/solver/block_system.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/solver/block_cholesky.hpp"
#include "graticule/solver/error.hpp"
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

  Pattern(const BlockSystem::Links& links, const std::vector<int>& place)
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
  std::unique_ptr<BlockCholesky> blocks;  // where it is quicker; else CHOLMOD's
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;  // kept for the next
  std::vector<double> ordered;
  bool is_factorised = false;

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
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  // The place of each node in the order of elimination: minimum degree on the blocks, then the
  // postorder of their elimination tree.  On the numbers inside the blocks it would come out the
  // same, later; and a matrix that is in order need not be permuted whenever it is factorised.
  std::vector<int> Order(int nodes, const BlockSystem::Links& links) {
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

BlockSystem::BlockSystem(int block_size, int nodes, const Links& links,
                         const BlockSystem* ordered_like)
    : BlockSystem(std::vector<int>(static_cast<std::size_t>(nodes), block_size), links,
                  ordered_like) {}

BlockSystem::BlockSystem(std::vector<int> sizes, const Links& links,
                         const BlockSystem* ordered_like)
    : sizes_(std::move(sizes)), cholesky_(std::make_unique<Cholesky>()) {
  const NumericGuard guard;
  const std::size_t nodes = sizes_.size();
  place_ = ordered_like ? ordered_like->place_ : cholesky_->Order(static_cast<int>(nodes), links);
  const Pattern pattern(links, place_);
  std::vector<int> node_at(nodes);
  for (std::size_t node = 0; node < nodes; ++node)
    node_at[static_cast<std::size_t>(place_[node])] = static_cast<int>(node);
  const auto size_at = [&](int place) {
    return sizes_[static_cast<std::size_t>(node_at[static_cast<std::size_t>(place)])];
  };
  firsts_.reserve(nodes);
  int size = 0;
  for (const int numbers : sizes_) {
    firsts_.push_back(size);
    size += numbers;
  }

  std::vector<int> number_of(nodes);       // by place: its first number
  std::vector<int> row_offset;             // by block: numbers of its column above it
  std::vector<std::size_t> column(nodes);  // by place: where its values begin
  std::vector<int> heights(nodes);         // by place: numbers of each of its columns
  row_offset.reserve(pattern.rows.size());
  std::size_t values = 0;
  int number = 0;
  for (std::size_t j = 0; j < nodes; ++j) {
    number_of[j] = number;
    number += size_at(static_cast<int>(j));
    int height = 0;
    for (int k = pattern.begins[j]; k < pattern.begins[j + 1]; ++k) {
      row_offset.push_back(height);
      height += size_at(pattern.rows[static_cast<std::size_t>(k)]);
    }
    column[j] = values;
    heights[j] = height;
    values +=
        static_cast<std::size_t>(height) * static_cast<std::size_t>(size_at(static_cast<int>(j)));
  }
  if (values > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error("the linear system is too large for 32-bit sparse matrices", ErrorKind::kOther);
  begins_.reserve(static_cast<std::size_t>(size) + 1);
  begins_.push_back(0);
  from_.reserve(static_cast<std::size_t>(size));
  rows_.reserve(values);
  for (std::size_t j = 0; j < nodes; ++j)
    for (int c = 0; c < size_at(static_cast<int>(j)); ++c) {
      for (int k = pattern.begins[j]; k < pattern.begins[j + 1]; ++k) {
        const int place = pattern.rows[static_cast<std::size_t>(k)];
        for (int r = 0; r < size_at(place); ++r)
          rows_.push_back(number_of[static_cast<std::size_t>(place)] + r);
      }
      begins_.push_back(static_cast<int>(rows_.size()));
      from_.push_back(firsts_[static_cast<std::size_t>(node_at[j])] + c);
    }
  values_.assign(values, 0);
  const auto slot_of = [&](int place, int position) {
    const auto j = static_cast<std::size_t>(place);
    return Slot{column[j] + static_cast<std::size_t>(
                                row_offset[static_cast<std::size_t>(pattern.begins[j] + position)]),
                heights[j], false};
  };
  node_slots_.reserve(nodes);
  for (const int place : place_) node_slots_.push_back(slot_of(place, 0));
  link_slots_.reserve(links.size());
  for (const auto& [first, second] : links) {
    const int i = place_[static_cast<std::size_t>(first)];
    const int j = place_[static_cast<std::size_t>(second)];
    const int row = std::max(i, j), below = std::min(i, j);
    link_slots_.push_back(slot_of(below, pattern.PositionOf(row, below)));
    link_slots_.back().transposed = i < j;
  }
  const bool alike = std::all_of(sizes_.begin(), sizes_.end(),
                                 [&](int numbers) { return numbers == sizes_.front(); });
  if (alike && nodes > 0)
    cholesky_->blocks = BlockCholesky::Analyse(sizes_.front(), pattern.begins, pattern.rows);
  if (cholesky_->blocks) return;
  cholmod_sparse matrix = LowerTriangle(begins_, rows_, values_.data());
  cholesky_->factor = cholmod_analyze(&matrix, &cholesky_->common);
}

BlockSystem::~BlockSystem() = default;

const char* BlockSystem::Factoriser() const { return cholesky_->blocks ? "blocks" : "cholmod"; }

void BlockSystem::Clear() { std::fill(values_.begin(), values_.end(), 0.0); }

void BlockSystem::CopyDiagonal(std::vector<double>* diagonal) const {
  diagonal->resize(from_.size());
  for (std::size_t node = 0; node < sizes_.size(); ++node)
    for (int i = 0; i < sizes_[node]; ++i)
      (*diagonal)[static_cast<std::size_t>(firsts_[node] + i)] =
          values_[node_slots_[node].first +
                  static_cast<std::size_t>(i * (node_slots_[node].stride + 1))];
}

void BlockSystem::SetDiagonal(Span<const double> diagonal) {
  for (std::size_t node = 0; node < sizes_.size(); ++node)
    for (int i = 0; i < sizes_[node]; ++i)
      values_[node_slots_[node].first +
              static_cast<std::size_t>(i * (node_slots_[node].stride + 1))] =
          diagonal[static_cast<std::size_t>(firsts_[node] + i)];
}

void BlockSystem::Multiply(const std::vector<double>& vector, std::vector<double>* product) const {
  product->assign(vector.size(), 0.0);
  for (std::size_t j = 0; j < from_.size(); ++j) {
    const auto column = static_cast<std::size_t>(from_[j]);
    double sum = 0;
    for (int k = begins_[j]; k < begins_[j + 1]; ++k) {
      const int i = rows_[static_cast<std::size_t>(k)];
      if (i < static_cast<int>(j)) continue;
      const auto row = static_cast<std::size_t>(from_[static_cast<std::size_t>(i)]);
      const double value = values_[static_cast<std::size_t>(k)];
      sum += value * vector[row];
      if (row != column) (*product)[row] += value * vector[column];
    }
    (*product)[column] += sum;
  }
}

bool BlockSystem::Factorise() {
  const NumericGuard guard;
  Cholesky& cholesky = *cholesky_;
  cholesky.is_factorised = false;
  if (cholesky.blocks) return cholesky.is_factorised = cholesky.blocks->Factorise(values_.data());
  if (!cholesky.factor) return false;
  cholmod_sparse matrix = LowerTriangle(begins_, rows_, values_.data());
  cholesky.is_factorised = cholmod_factorize(&matrix, cholesky.factor, &cholesky.common) &&
                           cholesky.common.status == CHOLMOD_OK &&
                           cholesky.factor->minor == from_.size();
  return cholesky.is_factorised;
}

bool BlockSystem::SolveFactorised(double* rhs, int columns) {
  const NumericGuard guard;
  Cholesky& cholesky = *cholesky_;
  if (!cholesky.is_factorised) return false;
  const std::size_t size = from_.size();
  std::vector<double>& ordered = cholesky.ordered;
  ordered.resize(size * static_cast<std::size_t>(columns));
  // From the nodes' order into that of elimination, and back.
  const auto each = [&](auto&& visit) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns); ++c)
      for (std::size_t i = 0; i < size; ++i)
        visit(c * size + static_cast<std::size_t>(from_[i]), c * size + i);
  };
  const auto is_finite = [&](const double* x) {
    return std::all_of(x, x + ordered.size(), [](double value) { return std::isfinite(value); });
  };
  each([&](std::size_t outside, std::size_t inside) { ordered[inside] = rhs[outside]; });
  if (cholesky.blocks) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(columns); ++c)
      cholesky.blocks->Solve(ordered.data() + c * size);
    if (!is_finite(ordered.data())) return false;
    each([&](std::size_t outside, std::size_t inside) { rhs[outside] = ordered[inside]; });
    return true;
  }
  cholmod_dense right{};
  right.nrow = right.d = size;
  right.ncol = static_cast<std::size_t>(columns);
  right.nzmax = ordered.size();
  right.x = ordered.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, cholesky.factor, &right, nullptr, &cholesky.solution, nullptr,
                      &cholesky.work_y, &cholesky.work_e, &cholesky.common))
    return false;
  const double* x = static_cast<const double*>(cholesky.solution->x);
  if (!is_finite(x)) return false;
  each([&](std::size_t outside, std::size_t inside) { rhs[outside] = x[inside]; });
  return true;
}

}  // namespace graticule
