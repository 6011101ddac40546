#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/problems/attenuation/pair_kernel.hpp"

namespace graticule {

/// A Gaussian process on what the log-fit leaves over.
struct GaussianProcessOptions {
  std::string name = "pair-gp";
  bool is_pair = true;  ///< PairSimilarity; false: ThesisSimilarity
  PlaceKernel place{2, 1, 0, 3};
  double sigma_f_db = 5;    ///< of the process
  double sigma_d_db = 4.5;  ///< of a measurement
  /// Of the measurements this share is kept, and no more than so many: the newest half of them, and
  /// the rest evenly over all that is older.
  double share = 1;
  std::size_t max_points = 600;
  bool learn = true;  ///< both deviations and the length by marginal likelihood, as data doubles

  /// As in the thesis (Table 3.1's caption): 5 % of the points (30 to 600), support 20 m, taper 3,
  /// length 28.75 m, deviations 1 and 1.5 dB, fixed.  Its kernel is not positive definite.
  static GaussianProcessOptions Mrgp();

  /// Throws Error (kUsage): a deviation, a length, ... that is not above zero.
  void Check() const;
};

/// MRGP and its cure (thesis 3.2.1): Gaussian-process regression over pairs of places; by sparse
/// Cholesky where the kernel has a support, else dense.
class GaussianProcess : public SignalPredictor {
 public:
  explicit GaussianProcess(GaussianProcessOptions options);

  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override;
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return options_.name; }

  const GaussianProcessOptions& Options() const { return options_; }
  std::size_t PointCount() const { return points_.size(); }
  /// What had to be added to the diagonal [dB^2] so that the matrix could be factorised.
  double JitterDb2() const { return jitter_; }

 private:
  double Covariance(const SignalLink& a, const SignalLink& b) const;
  void ChoosePoints();
  void Factorise();
  void Learn();
  double LogLikelihood(const std::vector<std::size_t>& some, const Eigen::VectorXd& residuals);

  GaussianProcessOptions options_;
  LogFit mean_;
  std::vector<SignalMeasurement> all_, points_;
  std::size_t learnt_at_ = 0;
  double jitter_ = 0;
  bool is_sparse_ = false;  // which of the factors below is in use
  Eigen::VectorXd weights_;
  Eigen::LLT<Eigen::MatrixXd> dense_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> sparse_;
};

}  // namespace graticule
