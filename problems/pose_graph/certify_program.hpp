#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "graticule/solver/graph.hpp"

namespace graticule {

/// A rigid transform of the plane (2) or of space (3).
template <int kDim>
struct Frame {
  Eigen::Matrix<double, kDim, kDim> rotation = Eigen::Matrix<double, kDim, kDim>::Identity();
  Eigen::Matrix<double, kDim, 1> translation = Eigen::Matrix<double, kDim, 1>::Zero();

  friend Frame operator*(const Frame& a, const Frame& b) {
    return {a.rotation * b.rotation, a.translation + a.rotation * b.translation};
  }
};

/// Node by node a translation and a rotation, [t R], side by side.  More rows than the space has
/// dimensions: the same lifted, R' R = 1 still (Boumal 2016).  The rotation of a point is zero.
template <int kDim>
using Poses = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2 * kDim + 2>;

/// A pose graph as statements between nodes, all of one form: the frame b' = b * b_offset, seen
/// from a' = a * a_offset, is where `measured` says.  Its residual is r = [e, turn] with
///   e = R_m' (R_a'' (t_b' - t_a') - t_m),   turn of R_m' R_a'' R_b',
/// and its cost 0.5 r' W r: factor for factor the graph's own.
///
/// A node is a free pose, a free point, or the world, which all fixed poses and points are offsets
/// of, and which priors are seen from.
template <int kDim>
struct Program {
  static constexpr int kTurn = kDim == 2 ? 1 : 3;
  using Matrix = Eigen::Matrix<double, kDim, kDim>;
  using Vector = Eigen::Matrix<double, kDim, 1>;
  using Residual = Eigen::Matrix<double, kDim + kTurn, 1>;
  using Information = Eigen::Matrix<double, kDim + kTurn, kDim + kTurn>;

  enum class Turn : std::uint8_t {
    kNone,        ///< not measured
    kAngle,       ///< the angle in the plane, the rotation vector in space
    kQuaternion,  ///< the vector part of the quaternion
  };
  struct Statement {
    int a = 0, b = 0;
    Frame<kDim> a_offset, b_offset, measured;
    Information w = Information::Zero();  ///< of the turn: zero where that is not measured
    Turn turn = Turn::kNone;
    bool couples = false;  ///< w between e and turn is not zero
  };

  /// `origin`: of the world's coordinates, so that they are small.
  std::vector<Statement> statements;
  std::vector<bool> is_point;                     ///< by node
  std::vector<std::pair<VariableId, int>> nodes;  ///< the free variables and theirs
  int world = -1;                                 ///< its node, if there is one
  Vector origin = Vector::Zero();
  double constant = 0;  ///< cost of the factors that touch only what is fixed

  int NodeCount() const { return static_cast<int>(is_point.size()); }
  std::vector<std::pair<int, int>> Links() const;
  /// By node, whether it is what its piece is held at: one node a piece that statements join.
  std::vector<bool> Pins() const;

  Poses<kDim> Read(const Values& values) const;
  /// Rotations must be rotations.  The world is brought to where it was.
  void Write(const Poses<kDim>& poses, Values* values) const;
};

/// Whether the graph has poses of the plane (2), of space (3).
bool HasPoses(const Graph& graph, int dimension);

/// The graph as a program, all of it.  Where it cannot be said so, `reasons` gets a line each with
/// counts, and the program is not to be used.
template <int kDim>
Program<kDim> ReadProgram(const Graph& graph, std::vector<std::string>* reasons);

/// The statement's residual at these poses, which are not lifted.
template <int kDim>
typename Program<kDim>::Residual ResidualOf(const typename Program<kDim>::Statement& statement,
                                            const Poses<kDim>& poses);

}  // namespace graticule
