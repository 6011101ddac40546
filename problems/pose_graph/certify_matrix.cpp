#include "graticule/problems/pose_graph/certify_matrix.hpp"

#include <Spectra/SymEigsShiftSolver.h>

#include <algorithm>
#include <cmath>

namespace graticule {
namespace {

// D^1/2 (S - sigma D)^-1 D^1/2 on the rotations, with the translations eliminated, from a factor of
// S - sigma D: what Spectra wants.
template <int kDim>
class Inverse {
 public:
  using Scalar = double;

  Inverse(BlockSystem* system, const std::vector<double>& weights)
      : system_(system), full_(weights.size() * (kDim + 1)) {
    for (std::size_t node = 0; node < weights.size(); ++node)
      for (std::size_t i = 1; i <= kDim && weights[node] > 0; ++i) {
        place_.push_back(node * (kDim + 1) + i);
        root_.push_back(std::sqrt(weights[node]));
      }
  }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(place_.size()); }
  Eigen::Index cols() const { return rows(); }
  void set_shift(double) {}  // it is in the factor
  void perform_op(const double* in, double* out) const {
    std::fill(full_.begin(), full_.end(), 0.0);
    for (std::size_t i = 0; i < place_.size(); ++i) full_[place_[i]] = root_[i] * in[i];
    failed_ |= !system_->SolveFactorised(full_.data(), 1);
    for (std::size_t i = 0; i < place_.size(); ++i) out[i] = root_[i] * full_[place_[i]];
  }
  /// What the latest solve gave, translations included.
  const std::vector<double>& Full() const { return full_; }
  bool Failed() const { return failed_; }

 private:
  BlockSystem* system_;
  std::vector<std::size_t> place_;  // of a rotation's number among all
  std::vector<double> root_;        // of its weight
  mutable std::vector<double> full_;
  mutable bool failed_ = false;
};

}  // namespace

template <int kDim>
Dual<kDim> DualAt(const Program<kDim>& program, const Quadratic<kDim>& quadratic,
                  const Poses<kDim>& poses) {
  Dual<kDim> dual;
  dual.gradient = quadratic.Times(poses);
  dual.diagonal = quadratic.Diagonal(program.is_point.size());
  for (std::size_t node = 0; node < dual.diagonal.size(); ++node) {
    const auto column = static_cast<Eigen::Index>((kDim + 1) * node);
    dual.remainder += 0.5 * poses.col(column).dot(dual.gradient.col(column));
    if (program.is_point[node]) continue;
    const auto rotation = poses.template middleCols<kDim>(column + 1);
    auto gradient = dual.gradient.template middleCols<kDim>(column + 1);
    const Eigen::Matrix<double, kDim, kDim> product = rotation.transpose() * gradient;
    const Eigen::Matrix<double, kDim, kDim> multiplier = 0.5 * (product + product.transpose());
    dual.diagonal[node].template bottomRightCorner<kDim, kDim>() -= multiplier;
    gradient -= rotation * multiplier;
  }
  return dual;
}

template <int kDim>
CertificateMatrix<kDim>::CertificateMatrix(const Program<kDim>& program)
    : program_(program),
      system_(kDim + 1, program.NodeCount(), program.Links()),
      pins_(program.Pins()) {}

template <int kDim>
void CertificateMatrix<kDim>::Load(const Quadratic<kDim>& quadratic, const Dual<kDim>& dual) {
  system_.Clear();
  shift_ = allowance_ = 0;
  weights_.assign(dual.diagonal.size(), 0);
  double largest = 0;
  for (std::size_t node = 0; node < weights_.size(); ++node) {
    if (program_.is_point[node]) continue;
    weights_[node] = dual.diagonal[node].diagonal().template tail<kDim>().cwiseAbs().maxCoeff();
    largest = std::max(largest, weights_[node]);
  }
  if (!(largest > 0)) largest = 1;
  for (std::size_t node = 0; node < weights_.size(); ++node) {
    auto block = dual.diagonal[node];
    // X may be moved so that this translation is zero: any weight will do.
    if (pins_[node]) block(0, 0) += block(0, 0) > 0 ? block(0, 0) : largest;
    if (program_.is_point[node]) {
      block.diagonal().template tail<kDim>().setConstant(largest);
    } else {
      weights_[node] = std::max(weights_[node], 1e-12 * largest);
      allowance_ += 0.5 * kDim * weights_[node];
    }
    system_.AddToNode(static_cast<int>(node), block);
  }
  for (std::size_t i = 0; i < quadratic.terms.size(); ++i)
    system_.AddToLink(i, quadratic.terms[i].ab);
}

template <int kDim>
bool CertificateMatrix<kDim>::IsPositive(double shift) {
  typename Quadratic<kDim>::Block more = Quadratic<kDim>::Block::Zero();
  for (std::size_t node = 0; node < weights_.size(); ++node) {
    more.diagonal().template tail<kDim>().setConstant((shift - shift_) * weights_[node]);
    system_.AddToNode(static_cast<int>(node), more);
  }
  shift_ = shift;
  return system_.Factorise();
}

template <int kDim>
std::optional<typename CertificateMatrix<kDim>::Direction>
CertificateMatrix<kDim>::SmallestEigenvalue(double from) {
  // Near the eigenvalue Lanczos needs few steps: halve the shift as long as it is accepted.
  double accepted = from;
  while (accepted > 1e-15 && IsPositive(accepted / 2)) accepted /= 2;
  if (!IsPositive(accepted)) return std::nullopt;
  Inverse<kDim> inverse(&system_, weights_);
  const Eigen::Index size = inverse.rows(), vectors = std::min<Eigen::Index>(size, 20);
  if (vectors < 3) return std::nullopt;
  Spectra::SymEigsShiftSolver<Inverse<kDim>> solver(inverse, 1, vectors, -accepted);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, 100, 1e-6);
  if (inverse.Failed() || solver.info() != Spectra::CompInfo::Successful) return std::nullopt;
  Direction direction;
  direction.eigenvalue = solver.eigenvalues()[0];
  // Solved once more, for the translations that belong to it.
  const Eigen::VectorXd vector = solver.eigenvectors().col(0);
  Eigen::VectorXd again(size);
  inverse.perform_op(vector.data(), again.data());
  const std::vector<double>& full = inverse.Full();
  direction.row =
      Eigen::Map<const Eigen::RowVectorXd>(full.data(), static_cast<Eigen::Index>(full.size())) /
      again.norm();
  return direction;
}

template struct Dual<2>;
template struct Dual<3>;
template Dual<2> DualAt<2>(const Program<2>&, const Quadratic<2>&, const Poses<2>&);
template Dual<3> DualAt<3>(const Program<3>&, const Quadratic<3>&, const Poses<3>&);
template class CertificateMatrix<2>;
template class CertificateMatrix<3>;

}  // namespace graticule
