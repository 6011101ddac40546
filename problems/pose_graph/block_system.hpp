#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

namespace graticule {

/// Symmetric linear systems of square blocks, with one pattern and changing numbers: ordered and
/// analysed once, on the pattern of the blocks, and factorised by CHOLMOD as often as it is asked.
class BlockSystem {
 public:
  /// `links`: pairs of different nodes, in any order and any number, whose blocks are not zero.
  /// `ordered_like`: a system of the same nodes and links, to be eliminated in the same order.
  BlockSystem(int block_size, int nodes, const std::vector<std::pair<int, int>>& links,
              const BlockSystem* ordered_like = nullptr);
  ~BlockSystem();
  BlockSystem(const BlockSystem&) = delete;
  BlockSystem& operator=(const BlockSystem&) = delete;

  /// All blocks zero.
  void Clear();

  template <class Matrix>
  void AddToNode(int node, const Matrix& block) {
    View<Matrix>(node_slots_[static_cast<std::size_t>(node)]) += block;
  }
  /// To the block in the row of the link's first node and the column of its second.
  template <class Matrix>
  void AddToLink(std::size_t link, const Matrix& block) {
    const Slot& slot = link_slots_[link];
    if (slot.transposed)
      View<Matrix>(slot) += block.transpose();
    else
      View<Matrix>(slot) += block;
  }

  /// Solves for `columns` right-hand sides, column by column, in place.  False, and `rhs` as it
  /// was, where the matrix is not positive definite or the solution is not finite.
  bool Solve(std::vector<double>* rhs, int columns);

 private:
  // Where a block lies among the values of a matrix by columns, on or below its diagonal.
  struct Slot {
    std::size_t first = 0;
    int stride = 0;  // from column to column
    bool transposed = false;
  };
  struct Cholesky;

  template <class Matrix>
  auto View(const Slot& slot) {
    return Eigen::Map<Eigen::Matrix<double, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>,
                      0, Eigen::OuterStride<>>(values_.data() + slot.first, size_, size_,
                                               Eigen::OuterStride<>(slot.stride));
  }

  int size_ = 0;                    // of a block
  std::vector<int> place_;          // of a node, in the order of elimination
  std::vector<int> begins_, rows_;  // of numbers: the blocks on and below the diagonal
  std::vector<double> values_;
  std::vector<Slot> node_slots_, link_slots_;
  std::unique_ptr<Cholesky> cholesky_;
};

}  // namespace graticule
