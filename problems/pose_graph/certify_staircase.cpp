#include "graticule/problems/pose_graph/certify_staircase.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "graticule/problems/pose_graph/certify_descent.hpp"

namespace graticule {
namespace {

constexpr int kMoreDimensions = 2;
// Relative to the value: what the next step may still promise, and what the certificate may leave
// open.  What follows is a solve of the graph itself, from the basin and not from the minimum.
constexpr double kGain = 1e-4, kGap = 1e-2;

template <int kDim>
class Staircase {
 public:
  Staircase(const Program<kDim>& program, const Poses<kDim>& from,
            const std::function<bool(double)>& go_on)
      : program_(program),
        go_on_(go_on),
        poses_(from),
        quadratic_(MakeStandIn(program, from, StandIn::kChordal).quadratic),
        matrix_(program) {}

  StaircaseResult<kDim> Run() {
    StaircaseResult<kDim> result;
    for (int more = 0;; ++more) {
      Settle();
      if (stopped_) break;
      result.rank = static_cast<int>(poses_.rows());
      result.is_close = IsClose();
      if (result.is_close || more == kMoreDimensions || !Lift()) break;
    }
    result.poses = Rounded();
    return result;
  }

 private:
  double Value() const { return 0.5 * poses_.cwiseProduct(quadratic_.Times(poses_)).sum(); }

  void Settle() {
    DescentOptions options;
    options.damping = 1e-3;
    options.tolerance = kGain * Value();
    // Slow below the last rank is stuck at a saddle, which one dimension more leads past.
    const auto more = poses_.rows() - kDim;
    options.least_drop = more < kMoreDimensions ? (more ? 1e-3 : 1e-2) : 0;
    options.go_on = [&](double value) {
      stopped_ = go_on_ && !go_on_(value);
      return !stopped_;
    };
    Descend(program_, quadratic_, options, &poses_);
  }

  bool IsClose() {
    matrix_.Load(quadratic_, DualAt(program_, quadratic_, poses_));
    return matrix_.IsPositive(std::max(1e-13, kGap * Value() / matrix_.Allowance()));
  }

  // Along the eigenvector, in a dimension of its own: downhill, for the gradient is zero there and
  // the curvature the eigenvalue.
  bool Lift() {
    double shift = 1e-6;
    while (shift < 1e4 && !matrix_.IsPositive(shift)) shift *= 10;
    const auto direction = matrix_.SmallestEigenvalue(shift);
    if (!direction || !(direction->eigenvalue < 0)) return false;
    const Poses<kDim> low = poses_;
    const double before = Value();
    for (double step = 0.5 * std::sqrt(2 * matrix_.Allowance()); step > 1e-6; step /= 2) {
      poses_.resize(low.rows() + 1, low.cols());
      poses_.topRows(low.rows()) = low;
      poses_.bottomRows(1) = step * direction->row;
      for (int node = 0; node < program_.NodeCount(); ++node)
        if (!program_.is_point[static_cast<std::size_t>(node)]) Normalise(node);
      if (Value() < before) return true;
    }
    poses_ = low;
    return false;
  }

  void Normalise(int node) {
    auto rotation = poses_.template middleCols<kDim>((kDim + 1) * node + 1);
    const Eigen::Matrix<double, kDim, kDim> square = rotation.transpose() * rotation;
    rotation = (rotation * Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kDim, kDim>>(square)
                               .operatorInverseSqrt())
                   .eval();
  }

  // The rows that hold most of the rotations; mirrored where most of them are; the nearest
  // rotations.
  Poses<kDim> Rounded() const {
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(poses_.rows(), poses_.rows());
    for (int node = 0; node < program_.NodeCount(); ++node) {
      const auto rotation = poses_.template middleCols<kDim>((kDim + 1) * node + 1);
      square += rotation * rotation.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(square);
    Poses<kDim> rounded = solver.eigenvectors().rightCols(kDim).transpose() * poses_;
    int mirrored = 0;
    for (int node = 0; node < program_.NodeCount(); ++node) {
      const Eigen::Matrix<double, kDim, kDim> rotation =
          rounded.template middleCols<kDim>((kDim + 1) * node + 1);
      mirrored += rotation.determinant() < 0 ? 1 : -1;
    }
    if (mirrored > 0) rounded.row(0) *= -1;
    using Matrix = Eigen::Matrix<double, kDim, kDim>;
    for (int node = 0; node < program_.NodeCount(); ++node) {
      if (program_.is_point[static_cast<std::size_t>(node)]) continue;
      auto rotation = rounded.template middleCols<kDim>((kDim + 1) * node + 1);
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rotation,
                                                  Eigen::ComputeFullU | Eigen::ComputeFullV);
      Eigen::Matrix<double, kDim, 1> signs = Eigen::Matrix<double, kDim, 1>::Ones();
      signs[kDim - 1] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
      rotation = Matrix(svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose());
    }
    return rounded;
  }

  const Program<kDim>& program_;
  const std::function<bool(double)>& go_on_;
  bool stopped_ = false;
  Poses<kDim> poses_;
  Quadratic<kDim> quadratic_;
  CertificateMatrix<kDim> matrix_;
};

}  // namespace

template <int kDim>
StaircaseResult<kDim> ClimbStaircase(const Program<kDim>& program, const Poses<kDim>& from,
                                     const std::function<bool(double)>& go_on) {
  return Staircase<kDim>(program, from, go_on).Run();
}

template StaircaseResult<2> ClimbStaircase<2>(const Program<2>&, const Poses<2>&,
                                              const std::function<bool(double)>&);
template StaircaseResult<3> ClimbStaircase<3>(const Program<3>&, const Poses<3>&,
                                              const std::function<bool(double)>&);

}  // namespace graticule
