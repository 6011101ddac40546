#include "graticule/solver/sparse_inverse.hpp"

#include <algorithm>

#include "graticule/solver/error.hpp"

// Fortran's BLAS and LAPACK, as CHOLMOD calls them.  Column-major.
extern "C" {
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b,
            const int* ldb);
void dsymm_(const char* side, const char* uplo, const int* m, const int* n, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta,
            double* c, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace graticule {

SparseInverse::SparseInverse(const cholmod_factor& factor) {
  if (!factor.is_super || !factor.is_ll || factor.xtype != CHOLMOD_REAL)
    throw Error("expected a supernodal factor", ErrorKind::kOther);
  const auto n = factor.n, count = factor.nsuper;
  const int* first = static_cast<const int*>(factor.super);
  const int* row_begin = static_cast<const int*>(factor.pi);
  const int* value_begin = static_cast<const int*>(factor.px);
  const int* rows = static_cast<const int*>(factor.s);
  rows_.assign(rows, rows + factor.ssize);
  node_of_.resize(n);
  nodes_.resize(count);
  for (std::size_t s = 0; s < count; ++s) {
    nodes_[s] = {first[s], first[s + 1] - first[s], rows_.data() + row_begin[s],
                 row_begin[s + 1] - row_begin[s], static_cast<std::size_t>(value_begin[s])};
    std::fill(node_of_.begin() + first[s], node_of_.begin() + first[s + 1], static_cast<int>(s));
  }
  position_.resize(n);
  const int* permutation = static_cast<const int*>(factor.Perm);
  for (std::size_t i = 0; i < n; ++i)
    position_[static_cast<std::size_t>(permutation[i])] = static_cast<int>(i);

  inverse_.assign(factor.xsize, 0.0);
  // From the last supernode to the first: each needs only entries of those after it.
  for (std::size_t s = count; s-- > 0;) Solve(nodes_[s], static_cast<const double*>(factor.x));
}

// With J the supernode's columns, S its rows below, and Y = L_SJ inv(L_JJ):
//   Z_SJ = -Z_SS Y,   Z_JJ = inv(L_JJ L_JJ') - Y' Z_SJ.
void SparseInverse::Solve(const Supernode& node, const double* factor_values) {
  const int columns = node.columns, rows = node.row_count, below = rows - columns;
  const double* l = factor_values + node.values;
  double* z = inverse_.data() + node.values;
  const double one = 1, minus_one = -1, zero = 0;

  for (int c = 0; c < columns; ++c)
    std::copy(l + c * rows + c, l + c * rows + columns, z + c * rows + c);
  int info = 0;
  dpotri_("L", &columns, z, &rows, &info);
  if (info != 0) throw Error("the factor is singular", ErrorKind::kOther);
  if (below == 0) return;

  GatherBelow(node);
  scaled_.resize(static_cast<std::size_t>(below) * columns);
  for (int c = 0; c < columns; ++c)
    std::copy(l + c * rows + columns, l + (c + 1) * rows, scaled_.data() + c * below);
  dtrsm_("R", "L", "N", "N", &below, &columns, &one, l, &rows, scaled_.data(), &below);
  dsymm_("L", "L", &below, &columns, &minus_one, below_.data(), &below, scaled_.data(), &below,
         &zero, z + columns, &rows);
  // The upper triangle of Z_JJ is written too; nobody reads it.
  dgemm_("T", "N", &columns, &columns, &below, &minus_one, scaled_.data(), &below, z + columns,
         &rows, &one, z, &rows);
}

// Z_SS, its lower triangle, from the supernodes that own the columns of S.
void SparseInverse::GatherBelow(const Supernode& node) {
  const int below = node.row_count - node.columns;
  const int* s = node.rows + node.columns;
  below_.resize(static_cast<std::size_t>(below) * below);
  for (int begin = 0; begin < below;) {
    const Supernode& owner =
        nodes_[static_cast<std::size_t>(node_of_[static_cast<std::size_t>(s[begin])])];
    int end = begin;
    while (end < below && s[end] < owner.first + owner.columns) ++end;
    // Both lists of rows ascend, and the owner's has all of ours from `begin` on.
    int at = 0;
    for (int i = begin; i < below; ++i) {
      while (owner.rows[at] < s[i]) ++at;
      const int last = std::min(i, end - 1);
      for (int k = begin; k <= last; ++k)
        below_[static_cast<std::size_t>(k) * below + i] =
            inverse_[owner.values + static_cast<std::size_t>(s[k] - owner.first) * owner.row_count +
                     at];
    }
    begin = end;
  }
}

double SparseInverse::At(int row, int column) const {
  int i = position_[static_cast<std::size_t>(row)], j = position_[static_cast<std::size_t>(column)];
  if (i < j) std::swap(i, j);
  const Supernode& node = nodes_[static_cast<std::size_t>(node_of_[static_cast<std::size_t>(j)])];
  const int* end = node.rows + node.row_count;
  const int* found = std::lower_bound(node.rows, end, i);
  if (found == end || *found != i)
    throw Error("this entry of the inverse is not on the pattern of the factor", ErrorKind::kOther);
  return inverse_[node.values + static_cast<std::size_t>(j - node.first) * node.row_count +
                  static_cast<std::size_t>(found - node.rows)];
}

}  // namespace graticule
