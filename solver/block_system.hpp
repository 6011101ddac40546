#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "graticule/solver/span.hpp"

namespace graticule {

/// Symmetric linear systems of blocks, with one pattern and changing numbers: ordered and analysed
/// once, on the pattern of the blocks, and factorised as often as it is asked.
///
/// A right-hand side holds the nodes one after the other, as they are numbered.
class BlockSystem {
 public:
  /// Pairs of different nodes, in any order and any number, whose blocks are not zero.
  using Links = std::vector<std::pair<int, int>>;

  /// `sizes`: numbers of each node.  `ordered_like`: a system of the same nodes and links, whatever
  /// their sizes, to be eliminated in the same order.
  BlockSystem(std::vector<int> sizes, const Links& links,
              const BlockSystem* ordered_like = nullptr);
  /// All nodes of one size.
  BlockSystem(int block_size, int nodes, const Links& links,
              const BlockSystem* ordered_like = nullptr);
  ~BlockSystem();
  BlockSystem(const BlockSystem&) = delete;
  BlockSystem& operator=(const BlockSystem&) = delete;

  /// Who factorises: "blocks" (thin systems of equal nodes) or "cholmod".
  const char* Factoriser() const;

  /// Numbers of all nodes together.
  int Size() const { return static_cast<int>(begins_.size()) - 1; }
  /// Where a node's numbers begin in a right-hand side.
  int First(int node) const { return firsts_[static_cast<std::size_t>(node)]; }

  /// All blocks zero.
  void Clear();

  /// Matrices are whatever says rows(), cols() and (row, column).
  template <class Matrix>
  void AddToNode(int node, const Matrix& block) {
    Add(NodeBlock(node), block);
  }
  /// To the block in the row of the link's first node and the column of its second.
  template <class Matrix>
  void AddToLink(std::size_t link, const Matrix& block) {
    Add(LinkBlock(link), block);
  }

  /// Where a block lies, by columns, `stride` from one to the next.  Of a node's, what is above the
  /// diagonal is not read.  `transposed`: the link's second node has the rows.
  struct Block {
    double* values;
    int stride;
    bool transposed;
  };
  Block NodeBlock(int node) { return At(node_slots_[static_cast<std::size_t>(node)]); }
  Block LinkBlock(std::size_t link) { return At(link_slots_[link]); }

  /// The numbers on the diagonal, in the order of a right-hand side.
  void CopyDiagonal(std::vector<double>* diagonal) const;
  void SetDiagonal(Span<const double> diagonal);

  /// The matrix times a vector.
  void Multiply(const std::vector<double>& vector, std::vector<double>* product) const;

  /// False where the matrix is not positive definite.  What was factorised before is then lost.
  bool Factorise();
  /// Solves for `columns` right-hand sides, column by column, in place, by what was last
  /// factorised, whatever the numbers are now.  False, and `rhs` as it was, where the solution is
  /// not finite, or nothing was factorised.
  bool SolveFactorised(double* rhs, int columns);
  /// Both.
  bool Solve(std::vector<double>* rhs, int columns) {
    return Factorise() && SolveFactorised(rhs->data(), columns);
  }

 private:
  struct Slot {
    std::size_t first = 0;
    int stride = 0;
    bool transposed = false;
  };
  struct Cholesky;

  Block At(const Slot& slot) { return {values_.data() + slot.first, slot.stride, slot.transposed}; }
  template <class Matrix>
  static void Add(const Block& to, const Matrix& block) {
    const auto row = to.transposed ? to.stride : 1, column = to.transposed ? 1 : to.stride;
    for (int c = 0; c < static_cast<int>(block.cols()); ++c)
      for (int r = 0; r < static_cast<int>(block.rows()); ++r)
        to.values[r * row + c * column] += block(r, c);
  }

  std::vector<int> sizes_, firsts_;  // by node
  std::vector<int> place_;           // of a node, in the order of elimination
  std::vector<int> from_;            // by number in that order: its place in a right-hand side
  std::vector<int> begins_, rows_;   // of numbers: the blocks on and below the diagonal
  std::vector<double> values_;
  std::vector<Slot> node_slots_, link_slots_;
  std::unique_ptr<Cholesky> cholesky_;
};

}  // namespace graticule
