#include "graticule/problems/calibration/jackknife.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "graticule/problems/calibration/posterior_sums.hpp"

namespace graticule {

double RaiseByJackknife(const Detections& detections, const CalibrationState& state,
                        const CornerUse& use, const PosteriorOptions& options,
                        Posterior* posterior) {
  constexpr std::size_t kFewest = 4;
  std::vector<PosteriorBlock> blocks;
  const PosteriorPlaces places = PlaceUnknowns(detections, state, options, &blocks);
  // The numbers that are raised come first.
  int size = 0;
  for (const PosteriorBlock& block : blocks)
    if (block.key.rfind("corner:", 0) != 0) size = std::max(size, block.offset + block.Size());

  std::vector<Eigen::VectorXd> changes;
  for (std::size_t e = 0; e < state.rig_from_target.size(); ++e) {
    PosteriorSums one(detections, state, use, options, places);
    if (!one.AddExposure(e) || one.information.isZero(0)) continue;
    one.Whiten();
    // Scaled, so that what this exposure alone told stays solvable: as ClampedInverse does it.
    const Eigen::VectorXd& s = posterior->scales;
    Eigen::MatrixXd rest =
        s.asDiagonal() * (posterior->information - one.information) * s.asDiagonal();
    rest.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(rest);
    if (factor.info() != Eigen::Success) continue;
    const Eigen::VectorXd step = s.cwiseProduct(factor.solve(s.cwiseProduct(one.gradient)));
    changes.push_back(step.head(size));
  }
  if (changes.size() < kFewest) return 1;
  const auto count = static_cast<double>(changes.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
  for (const Eigen::VectorXd& change : changes) mean += change / count;
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(size, size);
  for (const Eigen::VectorXd& change : changes)
    spread += (change - mean) * (change - mean).transpose();
  spread *= (count - 1) / count;

  // In the metric of the posterior, where its own variance is one in every direction.
  const Eigen::MatrixXd own = posterior->covariance.topLeftCorner(size, size);
  const Eigen::LLT<Eigen::MatrixXd> root(own);
  if (root.info() != Eigen::Success) return 1;
  const Eigen::MatrixXd half = root.matrixL().solve(spread);
  const Eigen::MatrixXd relative = root.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen((relative + relative.transpose()) / 2);
  const Eigen::VectorXd raised = eigen.eigenvalues().cwiseMax(1.0);
  const Eigen::MatrixXd turned = Eigen::MatrixXd(root.matrixL()) * eigen.eigenvectors();
  posterior->covariance.topLeftCorner(size, size) =
      turned * raised.asDiagonal() * turned.transpose();
  return raised.mean();
}

}  // namespace graticule
