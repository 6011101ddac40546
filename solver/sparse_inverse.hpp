#pragma once

#include <cholmod.h>

#include <vector>

namespace graticule {

/// The entries of A^-1 on the pattern of A's Cholesky factor, by Takahashi's recursion (Takahashi,
/// Fagan, Chin 1973; Erisman, Tinney 1975), a supernode at a time: all blocks on the diagonal for
/// about the price of two factorisations, where solving for columns would cost one solve each.
class SparseInverse {
 public:
  /// `factor` is a supernodal L L' of A, as CHOLMOD makes it; it is only read.
  explicit SparseInverse(const cholmod_factor& factor);

  /// Entry (row, column) of A^-1 in A's own order, which must lie on the pattern of the factor:
  /// wherever A itself is not zero.  Throws Error (kOther) otherwise.
  double At(int row, int column) const;

 private:
  struct Supernode {
    int first = 0;    ///< its first column
    int columns = 0;  ///< how many
    const int* rows;  ///< their rows: the columns themselves, then what is below, ascending
    int row_count = 0;
    std::size_t values = 0;  ///< where its row_count x columns numbers begin, column-major
  };

  void Solve(const Supernode& node, const double* factor_values);
  void GatherBelow(const Supernode& node);

  std::vector<Supernode> nodes_;
  std::vector<int> rows_;
  std::vector<int> node_of_;   // by column
  std::vector<int> position_;  // in the factor's order, by A's
  std::vector<double> inverse_;
  std::vector<double> below_, scaled_;  // workspace
};

}  // namespace graticule
