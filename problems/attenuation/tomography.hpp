#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/path_book.hpp"
#include "graticule/problems/attenuation/predictor.hpp"
#include "graticule/problems/attenuation/signal_rows.hpp"
#include "graticule/problems/attenuation/signal_system.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"

namespace graticule {

/// What was learnt of a coarse cell.
struct CellAttenuation {
  AttenuationCell cell;
  double db_per_m = 0;        ///< loss
  double sigma_db_per_m = 0;  ///< the noise's as estimated
};

/// Signal strength by path loss, biases of radios and attenuation along the ray, learnt as
/// measurements come: the log-fit, one attenuation a class, MRT and MATTE of the thesis, by options
/// (docs/attenuation.md has the model and the choices made).
///
/// The online form of BuildTomography's graph: the same rows, solved by conjugate gradients from
/// the last solution.  A cell further from every ray than the margin keeps what is believed of its
/// class, rho, in closed form.
class Tomography : public SignalPredictor {
 public:
  /// Throws Error (kUsage) as TomographyOptions::Check does.
  explicit Tomography(TomographyOptions options);

  /// Throws Error (kInput): a map without cells.  What was learnt stays, and is used through the
  /// new map from now on; the next Update traces every ray again.
  void SetMap(std::shared_ptr<const OccupancyGrid> map) override;
  /// The same for maps of other classes than an OccupancyGrid's.
  void SetClassMap(std::shared_ptr<const ClassMap> map);

  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override;
  void Expect(Span<const SignalLink> links) override;
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return options_.name; }

  /// Brings every sample of the posterior up to date; Update takes turns.
  void RefreshPosterior();

  const TomographyOptions& Options() const { return options_; }
  const SignalRows& Rows() const { return rows_; }
  double SigmaDb() const { return sigma_db_; }  ///< of one measurement
  double Correlation() const { return correlation_; }
  double L0Dbm() const { return head_[0]; }
  double SlopeDb() const { return head_[1]; }
  /// Of a radio as listener and as sender; 0 of one that was never heard of.
  double ReceiverBiasDb(std::uint32_t radio) const;
  double TransmitterBiasDb(std::uint32_t radio) const;
  /// In a fixed order: by class, row and column.
  std::vector<CellAttenuation> Cells() const;
  /// The attenuation of a class at a place [dB/m].
  double AttenuationAt(std::uint32_t material, double x_m, double y_m) const;
  int LastIterations() const { return last_iterations_; }

  /// What measurements have not determined: its posterior standard deviation is above half of
  /// what was believed before.  "slope: what was believed before is kept", "class structure: no
  /// ray".
  std::vector<std::string> NotDetermined() const;

 private:
  std::uint64_t SeedOf(std::size_t lane) const;
  void TakeRows(double now_s);
  void TakeUnknowns(bool is_anew);
  void SolveMean(double now_s, double tolerance, int most);
  void Linearise();
  /// True where weights have changed by it.
  bool EstimateNoise();
  void UpdatePosterior(bool all);
  void InvertPosterior();
  void CountDegreesOfFreedom();
  struct Terms;
  SignalPrediction PredictPath(const SignalLink& link, double log_distance,
                               const std::vector<RayPiece>& pieces, Terms* scratch) const;
  double VarianceOf(const Terms& terms) const;   // noise 1
  double VarianceOf(std::size_t unknown) const;  // noise 1
  double CellValue(std::uint32_t material, std::int32_t cell) const;

  TomographyOptions options_;
  SignalRows rows_;
  PathBook book_;
  SignalSystem system_;
  double sigma_db_, correlation_;
  // As the cells were at the last Update: what Predict uses until the next.
  AttenuationCells cells_;
  std::vector<double> head_, attenuation_;
  std::vector<double> x_;  // both
  SignalSystem::LastStep<double> last_step_;
  int last_iterations_ = 0;

  // Posterior, of noise 1: a matrix, or samples.
  bool is_exact_ = true;
  Eigen::MatrixXd covariance_;
  std::vector<std::vector<SignalSystem::Lanes>> lanes_;      // sixteen samples each
  std::vector<std::vector<SignalSystem::Lanes>> perturbed_;  // what they solve, or empty
  std::vector<SignalSystem::LastStep<SignalSystem::Lanes>> last_lane_steps_;
  std::vector<double> lane_size_;  // entries at their last refresh
  std::size_t next_lane_ = 0, fresh_lane_ = 0, updates_ = 0;
  double degrees_of_freedom_ = 0;

  // Work that is due only when rows have grown.
  double size_at_update_ = 0, size_at_noise_ = 0;
  double weight_sigma_db_, weight_correlation_;  // of the weights that rows have
};

}  // namespace graticule
