#include "graticule/solver/front.hpp"

#include <algorithm>
#include <cmath>

// Fortran's BLAS and LAPACK, as CHOLMOD calls them.  Column-major.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b,
            const int* ldb);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a,
            const int* lda, double* x, const int* incx);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a,
            const int* lda, const double* x, const int* incx, const double* beta, double* y,
            const int* incy);
}

namespace graticule {
namespace {

// A pivot that cancelled to less than this share of its diagonal is rounding.
constexpr double kRounding = 1e-13;
// Below this size a plain loop is quicker than BLAS' preparations.
constexpr int kSmall = 16;

}  // namespace

void Front::Reset(int rows, int columns) {
  rows_ = rows;
  columns_ = columns;
  const auto n = static_cast<std::size_t>(rows);
  matrix_.assign(n * n, 0.0);
  rhs_.assign(n, 0.0);
}

bool Front::Eliminate() {
  const int n = rows_, f = columns_;
  double* a = matrix_.data();
  diagonal_.clear();
  for (int i = 0; i < f; ++i) diagonal_.push_back(a[i * n + i]);
  if (n <= kSmall) {
    for (int j = 0; j < f; ++j) {
      const double pivot = a[j * n + j];
      if (!(pivot > kRounding * diagonal_[static_cast<std::size_t>(j)])) return false;
      const double root = std::sqrt(pivot);
      for (int i = j; i < n; ++i) a[j * n + i] /= root;
      rhs_[static_cast<std::size_t>(j)] /= root;
      for (int k = j + 1; k < n; ++k) {
        const double factor = a[j * n + k];
        for (int i = k; i < n; ++i) a[k * n + i] -= factor * a[j * n + i];
        rhs_[static_cast<std::size_t>(k)] -= factor * rhs_[static_cast<std::size_t>(j)];
      }
    }
    return true;
  }
  int info = 0;
  dpotrf_("L", &f, a, &n, &info);
  if (info != 0) return false;
  for (int i = 0; i < f; ++i)
    if (!(a[i * n + i] * a[i * n + i] > kRounding * diagonal_[static_cast<std::size_t>(i)]))
      return false;
  EliminateFromOthers({});
  return true;
}

bool Front::EliminateHolding(std::vector<int>* held) {
  const int n = rows_, f = columns_;
  double* a = matrix_.data();
  diagonal_.clear();
  for (int i = 0; i < f; ++i) diagonal_.push_back(a[i * n + i]);
  for (int j = 0; j < f; ++j) {
    const double pivot = a[j * n + j];
    if (!std::isfinite(pivot)) return false;
    if (!(pivot > kRounding * diagonal_[static_cast<std::size_t>(j)])) {
      held->push_back(j);
      a[j * n + j] = 1;
      std::fill(a + j * n + j + 1, a + j * n + f, 0.0);
      continue;
    }
    const double root = std::sqrt(pivot);
    for (int i = j; i < f; ++i) a[j * n + i] /= root;
    for (int k = j + 1; k < f; ++k) {
      const double factor = a[j * n + k];
      for (int i = k; i < f; ++i) a[k * n + i] -= factor * a[j * n + i];
    }
  }
  EliminateFromOthers(*held);
  return true;
}

// The right-hand side, and the rows of the others.
void Front::EliminateFromOthers(const std::vector<int>& held) {
  const int n = rows_, f = columns_, s = n - f, one_step = 1;
  const double one = 1, minus_one = -1;
  double* a = matrix_.data();
  dtrsv_("L", "N", "N", &f, a, &n, rhs_.data(), &one_step);
  for (const int j : held) rhs_[static_cast<std::size_t>(j)] = 0;
  if (s == 0) return;
  dtrsm_("R", "L", "T", "N", &s, &f, &one, a, &n, a + f, &n);
  for (const int j : held) std::fill(a + j * n + f, a + j * n + n, 0.0);
  dsyrk_("L", "N", &s, &f, &minus_one, a + f, &n, &one, a + f * n + f, &n);
  dgemv_("N", &s, &f, &minus_one, a + f, &n, rhs_.data(), &one_step, &one, rhs_.data() + f,
         &one_step);
}

void Front::CopyRemainder(std::vector<double>* matrix, std::vector<double>* rhs) const {
  const auto n = static_cast<std::size_t>(rows_), f = static_cast<std::size_t>(columns_);
  const std::size_t s = n - f;
  matrix->resize(s * s);
  for (std::size_t c = 0; c < s; ++c)
    std::copy(matrix_.data() + (f + c) * n + f + c, matrix_.data() + (f + c) * n + n,
              matrix->data() + c * s + c);
  rhs->assign(rhs_.begin() + columns_, rhs_.end());
}

void Front::Square(const double* j, const double* r, int rows, int columns,
                   std::vector<double>* matrix, std::vector<double>* rhs) {
  const auto n = static_cast<std::size_t>(columns);
  matrix->assign(n * n, 0.0);
  rhs->assign(n, 0.0);
  const double one = 1, minus_one = -1;
  const int one_step = 1;
  // By columns, J is its transpose.  A few rows at a time, from the first column that they have:
  // of a triangle a third of the products are left.
  constexpr int kPanel = 32;
  for (int row = 0; row < rows; row += kPanel) {
    const int count = std::min(kPanel, rows - row);
    const double* panel = j + row * columns;
    int begin = columns;
    for (int k = 0; k < count; ++k) {
      int column = 0;
      while (column < begin && panel[k * columns + column] == 0) ++column;
      begin = column;
    }
    const int width = columns - begin;
    if (width == 0) continue;
    dsyrk_("L", "N", &width, &count, &one, panel + begin, &columns, &one,
           matrix->data() + begin * columns + begin, &columns);
    dgemv_("N", &width, &count, &minus_one, panel + begin, &columns, r + row, &one_step, &one,
           rhs->data() + begin, &one_step);
  }
}

void Front::BackSubstitute(const double* l, const double* y, int rows, int columns, const double* s,
                           double* x) {
  std::copy(y, y + columns, x);
  const int others = rows - columns, one_step = 1;
  const double one = 1, minus_one = -1;
  if (rows <= kSmall) {
    for (int j = columns - 1; j >= 0; --j) {
      const double* column = l + j * rows;
      double sum = x[j];
      for (int i = j + 1; i < columns; ++i) sum -= column[i] * x[i];
      for (int i = 0; i < others; ++i) sum -= column[columns + i] * s[i];
      x[j] = sum / column[j];
    }
    return;
  }
  if (others > 0)
    dgemv_("T", &others, &columns, &minus_one, l + columns, &rows, s, &one_step, &one, x,
           &one_step);
  dtrsv_("L", "T", "N", &columns, l, &rows, x, &one_step);
}

}  // namespace graticule
