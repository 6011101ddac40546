#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace graticule {

/// L L' of a symmetric sparse matrix of square blocks, all of one size: up-looking by rows (Davis,
/// Direct Methods for Sparse Linear Systems, 2006, section 4.8), with blocks for numbers.
///
/// For factors that are too thin for supernodes, as those of most pose graphs are: a block costs
/// one index instead of one a number, and its products stay in registers.
///
/// The matrix is in order of elimination already; of each block column, what lies on and below the
/// diagonal is given, blocks on top of each other.
class BlockCholesky {
 public:
  /// Block columns: `begins` (columns + 1) into `rows`, which ascend and begin with the diagonal.
  /// Null where CHOLMOD's supernodes are quicker: blocks of other sizes than 2, 3 and 6, and
  /// factors with long columns.
  static std::unique_ptr<BlockCholesky> Analyse(int block_size, const std::vector<int>& begins,
                                                const std::vector<int>& rows);
  virtual ~BlockCholesky() = default;

  /// `values`: one block column after the other, its numbers by columns.  Above the diagonal of a
  /// diagonal block nothing is read.  False where the matrix is not positive definite.
  virtual bool Factorise(const double* values) = 0;
  /// Solves for one right-hand side, in place.
  virtual void Solve(double* x) = 0;
};

}  // namespace graticule
