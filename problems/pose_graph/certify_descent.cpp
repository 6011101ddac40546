#include "graticule/problems/pose_graph/certify_descent.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

// Newton's systems at poses of one rank.
template <int kDim, int kRank>
class Tangents {
 public:
  Tangents(const Program<kDim>& program)
      : program_(program),
        pins_(program.Pins()),
        system_(kSize, program.NodeCount(), program.Links()),
        basis_(program.is_point.size()) {}

  // The step against the gradient, and what it promises; false where the damped Hessian is not
  // positive definite.
  bool Step(const Quadratic<kDim>& quadratic, const Dual<kDim>& dual, const Poses<kDim>& poses,
            double damping, Poses<kDim>* step, double* promised) {
    system_.Clear();
    std::vector<double> rhs(kSize * basis_.size());
    for (std::size_t node = 0; node < basis_.size(); ++node) {
      const auto column = static_cast<Eigen::Index>((kDim + 1) * node);
      FindBasis(node, poses.template middleCols<kDim>(column + 1));
      Square block = Product(node, dual.diagonal[node], node);
      for (int i = 0; i < kSize; ++i) {
        double& entry = block(i, i);
        if (program_.is_point[node] && i >= kRank) entry = 1;
        entry += damping * std::abs(entry);
      }
      // The whole may be moved so that this node stays: any weight will do.
      if (pins_[node]) block.diagonal().array() += block.diagonal().cwiseAbs().maxCoeff() + 1e-9;
      system_.AddToNode(static_cast<int>(node), block);
      const Place gradient = dual.gradient.template middleCols<kDim + 1>(column);
      Part(&rhs, node) = -basis_[node].transpose() * Eigen::Map<const Stacked>(gradient.data());
    }
    for (std::size_t i = 0; i < quadratic.terms.size(); ++i) {
      const auto& term = quadratic.terms[i];
      system_.AddToLink(
          i, Product(static_cast<std::size_t>(term.a), term.ab, static_cast<std::size_t>(term.b)));
    }
    const std::vector<double> downhill = rhs;
    if (!system_.Solve(&rhs, 1)) return false;
    *promised = 0;
    step->resize(poses.rows(), poses.cols());
    for (std::size_t i = 0; i < rhs.size(); ++i) *promised += 0.5 * rhs[i] * downhill[i];
    for (std::size_t node = 0; node < basis_.size(); ++node) {
      const Stacked move = basis_[node] * Part(&rhs, node);
      step->template middleCols<kDim + 1>(static_cast<Eigen::Index>((kDim + 1) * node)) =
          Eigen::Map<const Place>(move.data());
    }
    return true;
  }

  // Onto R' R = 1 again.
  void Retract(Poses<kDim>* poses) const {
    for (std::size_t node = 0; node < basis_.size(); ++node) {
      if (program_.is_point[node]) continue;
      auto rotation =
          poses->template middleCols<kDim>(static_cast<Eigen::Index>((kDim + 1) * node + 1));
      const Eigen::Matrix<double, kDim, kDim> square = rotation.transpose() * rotation;
      rotation =
          (rotation * Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kDim, kDim>>(square)
                          .operatorInverseSqrt())
              .eval();
    }
  }

 private:
  static constexpr int kSize = kRank + kDim * (kDim - 1) / 2 + (kRank - kDim) * kDim;
  static constexpr int kNumbers = kRank * (kDim + 1);
  using Place = Eigen::Matrix<double, kRank, kDim + 1>;
  using Stacked = Eigen::Matrix<double, kNumbers, 1>;
  using Basis = Eigen::Matrix<double, kNumbers, kSize>;
  using Square = Eigen::Matrix<double, kSize, kSize>;

  static Eigen::Map<Eigen::Matrix<double, kSize, 1>> Part(std::vector<double>* all,
                                                          std::size_t node) {
    return Eigen::Map<Eigen::Matrix<double, kSize, 1>>(all->data() + kSize * node);
  }

  // Tangents at [t R] as columns of stacked numbers: every t; R times skew; across R.
  void FindBasis(std::size_t node, const Eigen::Matrix<double, kRank, kDim>& rotation) {
    Basis& basis = basis_[node];
    basis.setZero();
    basis.template topLeftCorner<kRank, kRank>().setIdentity();
    if (program_.is_point[node]) return;
    int column = kRank;
    for (int i = 0; i < kDim; ++i)
      for (int j = i + 1; j < kDim; ++j, ++column) {
        basis.col(column).template segment<kRank>(kRank * (1 + i)) = rotation.col(j);
        basis.col(column).template segment<kRank>(kRank * (1 + j)) = -rotation.col(i);
      }
    if constexpr (kRank > kDim) {
      const Eigen::Matrix<double, kRank, kRank> whole =
          Eigen::HouseholderQR<Eigen::Matrix<double, kRank, kDim>>(rotation).householderQ();
      for (int i = 0; i < kDim; ++i)
        for (int j = kDim; j < kRank; ++j, ++column)
          basis.col(column).template segment<kRank>(kRank * (1 + i)) = whole.col(j);
    }
  }

  // <V_a S, V_b> for the tangents of two nodes.
  Square Product(std::size_t a, const typename Quadratic<kDim>::Block& block, std::size_t b) const {
    Basis moved = Basis::Zero();
    for (int i = 0; i <= kDim; ++i)
      for (int j = 0; j <= kDim; ++j)
        moved.template middleRows<kRank>(kRank * j) +=
            block(i, j) * basis_[a].template middleRows<kRank>(kRank * i);
    return moved.transpose() * basis_[b];
  }

  const Program<kDim>& program_;
  std::vector<bool> pins_;
  BlockSystem system_;
  std::vector<Basis> basis_;
};

template <int kDim, int kRank>
Descent DescendAtRank(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                      const DescentOptions& options, Poses<kDim>* poses) {
  Descent descent;
  Tangents<kDim, kRank> tangents(program);
  double damping = options.damping;
  Poses<kDim> step, product = quadratic.Times(*poses);
  Dual<kDim> dual = DualAt(program, quadratic, *poses);
  for (int tries = 0; descent.steps < options.max_steps && tries < 4 * options.max_steps; ++tries) {
    const bool solved = tangents.Step(quadratic, dual, *poses, damping, &step, &descent.promised);
    if (solved && descent.promised <= options.tolerance) {
      descent.converged = true;
      break;
    }
    if (solved) {
      Poses<kDim> next = *poses + step;
      tangents.Retract(&next);
      Poses<kDim> next_product = quadratic.Times(next);
      const double drop = 0.5 * (*poses - next).cwiseProduct(next_product + product).sum();
      Dual<kDim> next_dual = DualAt(program, quadratic, next);
      // Close to the end a drop is rounding, and the gradient says more.
      const bool better = options.damping > 0
                              ? drop > 0
                              : next_dual.gradient.squaredNorm() < dual.gradient.squaredNorm();
      if (better) {
        descent.drop += drop;
        ++descent.steps;
        *poses = std::move(next);
        product = std::move(next_product);
        dual = std::move(next_dual);
        if (drop > 0.5 * descent.promised) damping = damping < 1e-7 ? 0 : damping / 10;
        continue;
      }
    }
    if (options.damping == 0 || damping > 1e6) break;
    damping = std::max(10 * damping, 1e-6);
  }
  return descent;
}

}  // namespace

template <int kDim>
Descent Descend(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                const DescentOptions& options, Poses<kDim>* poses) {
  switch (poses->rows() - kDim) {
    case 0:
      return DescendAtRank<kDim, kDim>(program, quadratic, options, poses);
    case 1:
      return DescendAtRank<kDim, kDim + 1>(program, quadratic, options, poses);
    case 2:
      return DescendAtRank<kDim, kDim + 2>(program, quadratic, options, poses);
    default:
      return {};
  }
}

template Descent Descend<2>(const Program<2>&, const Quadratic<2>&, const DescentOptions&,
                            Poses<2>*);
template Descent Descend<3>(const Program<3>&, const Quadratic<3>&, const DescentOptions&,
                            Poses<3>*);

}  // namespace graticule
