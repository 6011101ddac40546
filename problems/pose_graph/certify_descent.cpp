#include "graticule/problems/pose_graph/certify_descent.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

// Newton's systems at poses of one rank: kRank, or Dynamic for any.
template <int kDim, int kRank>
class Tangents {
 public:
  Tangents(const Program<kDim>& program, Eigen::Index rank)
      : program_(program),
        rank_(rank),
        size_(rank + kDim * (kDim - 1) / 2 + (rank - kDim) * kDim),
        pins_(program.Pins()),
        system_(static_cast<int>(size_), program.NodeCount(), program.Links()),
        basis_(program.is_point.size()) {}

  // The step against the gradient, and what it promises; false where the damped Hessian, of these
  // blocks on its diagonal, is not positive definite.
  bool Step(const Quadratic<kDim>& quadratic, const Dual<kDim>& dual,
            const std::vector<typename Quadratic<kDim>::Block>& diagonal, const Poses<kDim>& poses,
            double damping, Poses<kDim>* step, double* promised) {
    system_.Clear();
    std::vector<double> rhs(static_cast<std::size_t>(size_) * basis_.size());
    for (std::size_t node = 0; node < basis_.size(); ++node) {
      const auto column = static_cast<Eigen::Index>((kDim + 1) * node);
      FindBasis(node, poses.template middleCols<kDim>(column + 1));
      Square block = Product(node, diagonal[node], node);
      for (Eigen::Index i = 0; i < size_; ++i) {
        double& entry = block(i, i);
        if (program_.is_point[node] && i >= rank_) entry = 1;
        entry += damping * std::abs(entry);
      }
      // The whole may be moved so that this node stays: any weight will do.
      if (pins_[node]) block.diagonal().array() += block.diagonal().cwiseAbs().maxCoeff() + 1e-9;
      system_.AddToNode(static_cast<int>(node), block);
      const Place gradient = dual.gradient.template middleCols<kDim + 1>(column);
      Part(&rhs, node) =
          -basis_[node].transpose() * Eigen::Map<const Stacked>(gradient.data(), gradient.size());
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
          Eigen::Map<const Place>(move.data(), rank_, kDim + 1);
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
  static constexpr bool kFixed = kRank != Eigen::Dynamic;
  static constexpr int kSize =
      kFixed ? kRank + kDim * (kDim - 1) / 2 + (kRank - kDim) * kDim : Eigen::Dynamic;
  static constexpr int kNumbers = kFixed ? kRank * (kDim + 1) : Eigen::Dynamic;
  using Place = Eigen::Matrix<double, kRank, kDim + 1>;
  using Stacked = Eigen::Matrix<double, kNumbers, 1>;
  using Basis = Eigen::Matrix<double, kNumbers, kSize>;
  using Square = Eigen::Matrix<double, kSize, kSize>;
  using Numbers = Eigen::Matrix<double, kSize, 1>;

  Eigen::Map<Numbers> Part(std::vector<double>* all, std::size_t node) const {
    return {all->data() + static_cast<std::size_t>(size_) * node, size_};
  }

  // Tangents at [t R] as columns of stacked numbers: every t; R times skew; across R.
  void FindBasis(std::size_t node, const Eigen::Matrix<double, kRank, kDim>& rotation) {
    Basis& basis = basis_[node];
    basis.setZero(rank_ * (kDim + 1), size_);
    basis.topLeftCorner(rank_, rank_).setIdentity();
    if (program_.is_point[node]) return;
    Eigen::Index column = rank_;
    for (int i = 0; i < kDim; ++i)
      for (int j = i + 1; j < kDim; ++j, ++column) {
        basis.col(column).segment(rank_ * (1 + i), rank_) = rotation.col(j);
        basis.col(column).segment(rank_ * (1 + j), rank_) = -rotation.col(i);
      }
    if constexpr (!kFixed) {
      const Eigen::MatrixXd whole = Eigen::HouseholderQR<Eigen::MatrixXd>(rotation).householderQ();
      for (int i = 0; i < kDim; ++i)
        for (Eigen::Index j = kDim; j < rank_; ++j, ++column)
          basis.col(column).segment(rank_ * (1 + i), rank_) = whole.col(j);
    }
  }

  // <V_a S, V_b> for the tangents of two nodes.
  Square Product(std::size_t a, const typename Quadratic<kDim>::Block& block, std::size_t b) const {
    Basis moved = Basis::Zero(rank_ * (kDim + 1), size_);
    for (int i = 0; i <= kDim; ++i)
      for (int j = 0; j <= kDim; ++j)
        moved.middleRows(rank_ * j, rank_) += block(i, j) * basis_[a].middleRows(rank_ * i, rank_);
    return moved.transpose() * basis_[b];
  }

  const Program<kDim>& program_;
  Eigen::Index rank_, size_;
  std::vector<bool> pins_;
  BlockSystem system_;
  std::vector<Basis> basis_;
};

// One descent, step by step.
template <int kDim, int kRank>
class Walk {
 public:
  Walk(const Program<kDim>& program, const Quadratic<kDim>& quadratic, Poses<kDim>* poses)
      : program_(program),
        quadratic_(quadratic),
        poses_(*poses),
        tangents_(program, poses->rows()),
        product_(quadratic.Times(*poses)),
        dual_(DualAt(program, quadratic, *poses)),
        convex_(quadratic.Diagonal(program.is_point.size())) {}

  Descent Run(const DescentOptions& options) {
    double damping = options.damping;
    bool near = damping == 0;
    while (descent_.steps < options.max_steps) {
      // Far off Newton's Hessian is seldom positive definite; that of a sum of squares always is.
      bool solved = near && Solve(dual_.diagonal, damping);
      if (!solved && options.damping > 0) solved = Solve(convex_, damping);
      if (solved && descent_.promised <= options.tolerance) {
        descent_.converged = true;
        break;
      }
      const double drop = solved ? Take(options.damping > 0) : 0;
      if (took_) {
        if (drop < options.least_drop * Value()) break;
        if (options.go_on && !options.go_on(Value())) break;
        near = near || drop < 0.1 * Value();
        if (drop > 0.5 * descent_.promised) damping = damping < 1e-7 ? 0 : damping / 10;
        continue;
      }
      if (options.damping == 0 || damping > 1e6) break;
      damping = std::max(10 * damping, 1e-6);
    }
    return descent_;
  }

 private:
  double Value() const { return 0.5 * poses_.cwiseProduct(product_).sum(); }

  bool Solve(const std::vector<typename Quadratic<kDim>::Block>& diagonal, double damping) {
    took_ = false;
    return tangents_.Step(quadratic_, dual_, diagonal, poses_, damping, &step_, &descent_.promised);
  }

  // Close to the end a drop is rounding, and the gradient says more.
  double Take(bool by_value) {
    Poses<kDim> next = poses_ + step_;
    tangents_.Retract(&next);
    Poses<kDim> product = quadratic_.Times(next);
    const double drop = 0.5 * (poses_ - next).cwiseProduct(product + product_).sum();
    Dual<kDim> dual = DualAt(program_, quadratic_, next);
    took_ = by_value ? drop > 0 : dual.gradient.squaredNorm() < dual_.gradient.squaredNorm();
    if (!took_) return 0;
    descent_.drop += drop;
    ++descent_.steps;
    poses_ = std::move(next);
    product_ = std::move(product);
    dual_ = std::move(dual);
    return drop;
  }

  const Program<kDim>& program_;
  const Quadratic<kDim>& quadratic_;
  Poses<kDim>& poses_;
  Tangents<kDim, kRank> tangents_;
  Poses<kDim> product_, step_;
  Dual<kDim> dual_;
  std::vector<typename Quadratic<kDim>::Block> convex_;
  Descent descent_;
  bool took_ = false;
};

}  // namespace

template <int kDim>
Descent Descend(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                const DescentOptions& options, Poses<kDim>* poses) {
  if (poses->rows() == kDim) return Walk<kDim, kDim>(program, quadratic, poses).Run(options);
  return Walk<kDim, Eigen::Dynamic>(program, quadratic, poses).Run(options);
}

template Descent Descend<2>(const Program<2>&, const Quadratic<2>&, const DescentOptions&,
                            Poses<2>*);
template Descent Descend<3>(const Program<3>&, const Quadratic<3>&, const DescentOptions&,
                            Poses<3>*);

}  // namespace graticule
