#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "graticule/problems/attenuation/predictor.hpp"
#include "graticule/problems/attenuation/signal_rows.hpp"
#include "graticule/problems/attenuation/tomography_graph.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"

namespace graticule {

/// What a recorded graph does not say of the model that it is of.
struct FittedModel {
  TomographyOptions options;  ///< sigma_db, phi and lambda as the graph was built with
  TomographyLayout layout;
};

/// The factor graph of a signal log (thesis, Algorithm 3.1) with what is needed to predict by it.
struct FittedGraph {
  Graph graph;  ///< not yet solved; its first values are Tomography's
  FittedModel model;
  std::vector<std::string> not_determined;  ///< as Tomography says it
};

/// Fits noise and correlation to a log as Tomography does, and writes its rows down as a graph with
/// them.  Throws Error as Tomography does.
FittedGraph BuildFitted(const SignalLog& log, std::shared_ptr<const OccupancyGrid> map,
                        const TomographyOptions& options);

/// Predicts by a solved graph of BuildTomography (thesis, Algorithm 3.2): means are its values,
/// deviations its posterior, by a sparse Cholesky factorisation.  Learns what comes after it in the
/// same unknowns, by rows as Tomography has them, packets not heard among them; what the graph knew
/// counts by its posterior.  Cells that the graph does not have stay as believed.
class FittedTomography : public SignalPredictor {
 public:
  /// Throws Error (kInput): a factor type or a variable that no such graph has; one that does not
  /// determine its unknowns.
  FittedTomography(const Graph& solved, FittedModel model);

  void SetMap(std::shared_ptr<const OccupancyGrid> map) override;
  void AddMeasurements(Span<const SignalMeasurement> measurements) override;
  void Update(double now_s) override;
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override;
  std::string Name() const override { return model_.options.name; }

  double SigmaDb() const { return model_.options.sigma_db; }
  /// The attenuation of a class at a place [dB/m]: of its cell, or what is believed of the class.
  double AttenuationAt(std::uint32_t material, double x_m, double y_m) const;
  const TomographyOptions& Options() const { return model_.options; }

 private:
  using Row = std::vector<std::pair<int, double>>;
  struct Traced {
    Row row;
    double offset_dbm = 0;    ///< of cells that are not in the graph
    double variance_db2 = 0;  ///< the same
  };
  void TakeFactors(const Graph& graph);
  static void AddTo(const Row& row, double weight, std::vector<Eigen::Triplet<double>>* to);
  int Find(std::uint32_t material, std::int32_t x, std::int32_t y) const;
  Traced TraceEnds(std::uint32_t receiver, std::uint32_t transmitter, double log_distance) const;
  void TraceCell(const AttenuationCell& cell, double length_m, Traced* traced) const;
  Traced Trace(const SignalLink& link, RayTracer* tracer) const;
  double Dot(const Row& row) const;  // with values_
  struct HalfSolve;
  void Factorise(const std::vector<Eigen::Triplet<double>>& triplets);

  FittedModel model_;
  SignalRows rows_;    // what came after the graph
  int path_loss_ = 0;  // the first of its two unknowns
  std::int32_t x0_ = 0, y0_ = 0, columns_ = 0, lines_ = 0;
  std::vector<int> index_;                   // class by class, row by row: the unknown, or -1
  std::vector<int> receiver_, transmitter_;  // unknowns of radios
  bool is_changed_ = false;
  std::vector<Eigen::Triplet<double>> solved_triplets_;  // the graph's information, the lower half
  Eigen::SparseMatrix<double> solved_information_;       // the same
  Eigen::VectorXd solved_, values_;                      // as the graph has them, and as they are
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace graticule
