#include "graticule/problems/pose_graph/block_system.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>

#include "graticule/solver/numeric_guard.hpp"

namespace graticule {
namespace {

cholmod_sparse UpperTriangle(int size, int* begins, int* rows, double* values) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(size);
  view.nzmax = static_cast<std::size_t>(begins[size]);
  view.p = begins;
  view.i = rows;
  view.x = values;
  view.stype = 1;  // what lies below the diagonal, inside its blocks, is not read
  view.itype = CHOLMOD_INT;
  view.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

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
    common.method[0].ordering = CHOLMOD_GIVEN;
    common.final_ll = 1;  // LDL' would go on past a negative pivot
    common.quick_return_if_not_posdef = 1;
  }
  ~Cholesky() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  // Minimum degree on the blocks: on the numbers inside them it would find the same, later.
  void Analyse(int size, std::vector<int>* block_begins, std::vector<int>* block_rows,
               cholmod_sparse matrix) {
    const int nodes = static_cast<int>(block_begins->size()) - 1;
    cholmod_sparse blocks = UpperTriangle(nodes, block_begins->data(), block_rows->data(), nullptr);
    std::vector<int> order(static_cast<std::size_t>(nodes));
    if (!cholmod_amd(&blocks, nullptr, 0, order.data(), &common)) return;
    std::vector<int> expanded;
    expanded.reserve(matrix.nrow);
    for (const int node : order)
      for (int i = 0; i < size; ++i) expanded.push_back(node * size + i);
    factor = cholmod_analyze_p(&matrix, expanded.data(), nullptr, 0, &common);
  }
};

BlockSystem::BlockSystem(int block_size, int nodes, const std::vector<std::pair<int, int>>& links)
    : size_(block_size), cholesky_(std::make_unique<Cholesky>()) {
  const auto count = static_cast<std::size_t>(nodes);
  const auto size = static_cast<std::size_t>(size_);
  // The blocks of each column, upper triangle, diagonal last.
  std::vector<std::vector<int>> above(count);
  for (const auto& [i, j] : links)
    above[static_cast<std::size_t>(std::max(i, j))].push_back(std::min(i, j));
  std::vector<int> block_begins{0}, block_rows;
  for (std::size_t j = 0; j < count; ++j) {
    std::sort(above[j].begin(), above[j].end());
    above[j].erase(std::unique(above[j].begin(), above[j].end()), above[j].end());
    above[j].push_back(static_cast<int>(j));
    block_rows.insert(block_rows.end(), above[j].begin(), above[j].end());
    block_begins.push_back(static_cast<int>(block_rows.size()));
  }

  const auto slot_of = [&](std::size_t column, std::size_t position) {
    return Slot{size * size * static_cast<std::size_t>(block_begins[column]) + size * position,
                size_ * static_cast<int>(above[column].size()), false};
  };
  begins_.reserve(count * size + 1);
  begins_.push_back(0);
  rows_.reserve(block_rows.size() * size * size);
  for (std::size_t j = 0; j < count; ++j) {
    node_slots_.push_back(slot_of(j, above[j].size() - 1));
    for (int c = 0; c < size_; ++c) {
      for (const int i : above[j])
        for (int r = 0; r < size_; ++r) rows_.push_back(i * size_ + r);
      begins_.push_back(static_cast<int>(rows_.size()));
    }
  }
  values_.assign(rows_.size(), 0);
  link_slots_.reserve(links.size());
  for (const auto& [i, j] : links) {
    const std::vector<int>& column = above[static_cast<std::size_t>(std::max(i, j))];
    const auto place = std::lower_bound(column.begin(), column.end(), std::min(i, j));
    Slot slot = slot_of(static_cast<std::size_t>(std::max(i, j)),
                        static_cast<std::size_t>(place - column.begin()));
    slot.transposed = i > j;
    link_slots_.push_back(slot);
  }
  const NumericGuard guard;
  cholesky_->Analyse(size_, &block_begins, &block_rows,
                     UpperTriangle(nodes * size_, begins_.data(), rows_.data(), values_.data()));
}

BlockSystem::~BlockSystem() = default;

void BlockSystem::Clear() { std::fill(values_.begin(), values_.end(), 0.0); }

bool BlockSystem::Solve(std::vector<double>* rhs, int columns) {
  const NumericGuard guard;
  Cholesky& cholesky = *cholesky_;
  if (!cholesky.factor) return false;
  const std::size_t size = begins_.size() - 1;
  cholmod_sparse matrix =
      UpperTriangle(static_cast<int>(size), begins_.data(), rows_.data(), values_.data());
  if (!cholmod_factorize(&matrix, cholesky.factor, &cholesky.common) ||
      cholesky.common.status != CHOLMOD_OK || cholesky.factor->minor < size)
    return false;
  cholmod_dense right{};
  right.nrow = right.d = size;
  right.ncol = static_cast<std::size_t>(columns);
  right.nzmax = rhs->size();
  right.x = rhs->data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* solution = cholmod_solve(CHOLMOD_A, cholesky.factor, &right, &cholesky.common);
  if (!solution) return false;
  const double* x = static_cast<const double*>(solution->x);
  const bool finite =
      std::all_of(x, x + rhs->size(), [](double value) { return std::isfinite(value); });
  if (finite) std::copy(x, x + rhs->size(), rhs->begin());
  cholmod_free_dense(&solution, &cholesky.common);
  return finite;
}

}  // namespace graticule
