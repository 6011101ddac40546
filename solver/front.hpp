#pragma once

#include <vector>

namespace graticule {

/// A dense symmetric system whose first numbers are eliminated, and what is then left of the
/// others: one node of a multifrontal Cholesky factorisation (Duff, Reid 1983).
class Front {
 public:
  /// Of `rows` numbers the first `columns` are eliminated.  All zero.
  void Reset(int rows, int columns);

  int Rows() const { return rows_; }
  int Columns() const { return columns_; }

  /// Before elimination: the lower triangle, by columns, Rows() from one to the next, and the
  /// right-hand side.
  double* Matrix() { return matrix_.data(); }
  double* Rhs() { return rhs_.data(); }

  /// False where the eliminated part is not positive definite, or so nearly that its pivots are
  /// rounding; then the front must be made anew.
  bool Eliminate();
  /// The same where that fails: numbers whose pivots are rounding are not determined, and held at
  /// zero.  Appends their columns to `held`; what their rows of L say of the others is kept.  False
  /// where the system is not finite.
  bool EliminateHolding(std::vector<int>* held);

  /// After it, with L the factor's columns and y its solved right-hand side: Rows() x Columns()
  /// numbers, and Columns().
  const double* L() const { return matrix_.data(); }
  const double* Y() const { return rhs_.data(); }
  /// ... and the others' remaining system: a triangle as before, and a right-hand side.
  void CopyRemainder(std::vector<double>* matrix, std::vector<double>* rhs) const;

  /// x = inv(L_ff') (y - L_sf' s): the eliminated numbers, from the others'.
  static void BackSubstitute(const double* l, const double* y, int rows, int columns,
                             const double* s, double* x);

  /// What CopyRemainder would give of equations J x + r that nothing is eliminated from: J'J and
  /// -J'r.  J is rows x columns, row-major.
  static void Square(const double* j, const double* r, int rows, int columns,
                     std::vector<double>* matrix, std::vector<double>* rhs);

 private:
  void EliminateFromOthers(const std::vector<int>& held);

  int rows_ = 0, columns_ = 0;
  std::vector<double> matrix_, rhs_, diagonal_;
};

}  // namespace graticule
