#include "graticule/problems/attenuation/fitted.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graticule/factors/normal_tail.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

std::shared_ptr<const ClassMap> ClassesOf(const OccupancyGrid* map,
                                          const TomographyOptions& options) {
  if (map == nullptr || !options.uses_map) return nullptr;
  return std::make_shared<const ClassMap>(*map, options.class_of);
}

constexpr int kRounds = 50;
constexpr double kSmallStep = 1e-9;  // dB, dB/m

/// -log Phi(z), of a packet not heard whose floor is z deviations above the prediction: slope
/// -hazard and curvature by z, which is never quite 0 so that a row always has a weight.
struct Tail {
  double hazard, curvature;
};
Tail TailAt(double z) {
  const double hazard = NormalHazard(z);
  return {hazard, std::max(hazard * (hazard + z), 1e-12)};
}

// Cells of the rectangle around a model's, of all classes together.
constexpr std::int64_t kMostCells = 1 << 27;

/// Where the variable's numbers are among all.  Throws Error: there is none, or one of another
/// type.
int UnknownOf(const Graph& graph, const Key& key, const char* type) {
  const VariableId id = graph.IdOf(key);
  if (graph.TypeOf(id).name != type)
    throw Error("expected " + key.ToString() + " to be a " + type + ", found a " +
                graph.TypeOf(id).name);
  return static_cast<int>(graph.Offset(id));
}

double WeightOf(const NoiseView& noise, std::size_t component) {
  if (noise.kind != NoiseKind::kSigma || noise.values.empty()) return 1;
  const double sigma = noise.values[std::min(component, noise.values.size() - 1)];
  return 1 / (sigma * sigma);
}

// The graph's first values become what was learnt online: a graph that is not linear is then
// nearly solved.
void StartAt(const Tomography& online, const TomographyLayout& layout, double cell_m,
             Graph* graph) {
  Values values = graph->InitialValues();
  std::vector<double>& data = values.MutableData();
  const auto at = [&](const Key& key) -> double& { return data[graph->Offset(graph->IdOf(key))]; };
  double* const path_loss = &at(Key("path_loss", 0));
  path_loss[0] = online.L0Dbm();
  path_loss[1] = online.SlopeDb();
  const bool has_ends = layout.bias == RadioBias::kEnds;
  for (std::uint32_t r = 0; layout.bias != RadioBias::kNone && r < layout.radios; ++r) {
    at(Key(has_ends ? "listener" : "bias", r)) = online.ReceiverBiasDb(r);
    if (has_ends) at(Key("sender", r)) = online.TransmitterBiasDb(r);
  }
  for (std::size_t i = 0; i < layout.cells.size(); ++i) {
    const AttenuationCell& cell = layout.cells[i];
    at(layout.cell_keys[i]) =
        online.AttenuationAt(cell.material, (cell.x + 0.5) * cell_m, (cell.y + 0.5) * cell_m);
  }
  graph->SetValues(values);
}

}  // namespace

FittedGraph BuildFitted(const SignalLog& log, std::shared_ptr<const OccupancyGrid> map,
                        const TomographyOptions& options) {
  TomographyOptions fitted = options;
  Tomography online(options);
  if (!log.measurements.empty()) {
    if (map) online.SetMap(map);
    online.AddMeasurements(log.measurements);
    online.Update(log.measurements.back().link.time_s);
    // Weights are relative to the noise: what is believed stays as it was.
    const double ratio = online.SigmaDb() / options.sigma_db;
    fitted.sigma_db = online.SigmaDb();
    fitted.correlation = online.Correlation();
    fitted.lambda *= ratio;
    for (AttenuationClass& c : fitted.classes) c.phi *= ratio;
  }
  TomographyGraph built = BuildTomography(log.measurements, ClassesOf(map.get(), fitted), fitted);
  StartAt(online, built.layout, options.cell_m, &built.graph);
  return {std::move(built.graph), {fitted, std::move(built.layout)}, online.NotDetermined()};
}

FittedTomography::FittedTomography(const Graph& solved, FittedModel model)
    : model_(std::move(model)), rows_(model_.options) {
  const TomographyLayout& layout = model_.layout;
  path_loss_ = UnknownOf(solved, Key("path_loss", 0), "vector2/1");
  std::int32_t x1 = 0, y1 = 0;
  for (std::size_t i = 0; i < layout.cells.size(); ++i) {
    const AttenuationCell& cell = layout.cells[i];
    x0_ = i == 0 ? cell.x : std::min(x0_, cell.x);
    y0_ = i == 0 ? cell.y : std::min(y0_, cell.y);
    x1 = i == 0 ? cell.x : std::max(x1, cell.x);
    y1 = i == 0 ? cell.y : std::max(y1, cell.y);
  }
  const std::int64_t columns = layout.cells.empty() ? 0 : std::int64_t{x1} - x0_ + 1;
  const std::int64_t lines = layout.cells.empty() ? 0 : std::int64_t{y1} - y0_ + 1;
  const auto classes = static_cast<std::int64_t>(model_.options.classes.size());
  if (columns > kMostCells || lines > kMostCells || columns * lines > kMostCells ||
      columns * lines * classes > kMostCells)
    throw Error("the model's cells are too far apart: a rectangle of " + std::to_string(columns) +
                " x " + std::to_string(lines));
  columns_ = static_cast<std::int32_t>(columns);
  lines_ = static_cast<std::int32_t>(lines);
  index_.assign(static_cast<std::size_t>(columns * lines * classes), -1);
  for (std::size_t i = 0; i < layout.cells.size(); ++i) {
    const AttenuationCell& cell = layout.cells[i];
    if (cell.material >= model_.options.classes.size())
      throw Error("the model has a cell of a class that it does not name");
    const auto at = (static_cast<std::size_t>(cell.material) * static_cast<std::size_t>(lines_) +
                     static_cast<std::size_t>(cell.y - y0_)) *
                        static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(cell.x - x0_);
    index_[at] = UnknownOf(solved, layout.cell_keys[i], "vector1/1");
  }
  for (std::uint32_t r = 0; layout.bias != RadioBias::kNone && r < layout.radios; ++r) {
    const bool has_ends = layout.bias == RadioBias::kEnds;
    const auto offset = [&](const char* family) {
      return UnknownOf(solved, Key(family, r), "vector1/1");
    };
    receiver_.push_back(offset(has_ends ? "listener" : "bias"));
    transmitter_.push_back(offset(has_ends ? "sender" : "bias"));
  }
  const Values initial = solved.InitialValues();
  const std::vector<double>& values = initial.Data();
  solved_ =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  values_ = solved_;
  TakeFactors(solved);
  solved_information_.resize(values_.size(), values_.size());
  solved_information_.setFromTriplets(solved_triplets_.begin(), solved_triplets_.end());
  Factorise(solved_triplets_);
}

void FittedTomography::TakeFactors(const Graph& graph) {
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const std::string& type = factor.type->name;
    const auto offset = [&](std::size_t k) {
      return static_cast<int>(graph.Offset(factor.variables[k]));
    };
    const bool is_heard = type == "signal_path/1" || type == "path_loss/1";
    if (is_heard || type == "signal_path_not_heard/1" || type == "path_loss_not_heard/1") {
      const std::size_t first = is_heard ? 1 : 2;  // strength; or floor and sigma
      Row row = {{offset(0), 1}, {offset(0) + 1, -factor.measurement[first]}};
      for (std::size_t k = 1; k < factor.variables.size(); ++k)
        row.emplace_back(offset(k), -factor.measurement[first + k]);
      double weight = WeightOf(factor.noise, 0);
      if (!is_heard) {
        const double sigma = factor.measurement[1];
        weight *= TailAt((factor.measurement[0] - Dot(row)) / sigma).curvature / (sigma * sigma);
      }
      AddTo(row, weight, &solved_triplets_);
    } else if (type == "attenuation_smooth/1") {
      AddTo({{offset(0), 1}, {offset(1), -1}}, WeightOf(factor.noise, 0), &solved_triplets_);
    } else if (type == "path_loss_prior/1" || type == "radio_bias_prior/1" ||
               type == "attenuation_prior/1") {
      for (std::size_t k = 0; k < factor.measurement.size(); ++k)
        AddTo({{offset(0) + static_cast<int>(k), 1}}, WeightOf(factor.noise, k), &solved_triplets_);
    } else {
      throw Error("a signal model has no factors of type " + type);
    }
  }
}

void FittedTomography::AddTo(const Row& row, double weight,
                             std::vector<Eigen::Triplet<double>>* to) {
  for (const auto& [i, a] : row)
    for (const auto& [j, b] : row)
      if (i >= j) to->emplace_back(i, j, weight * a * b);
}

void FittedTomography::Factorise(const std::vector<Eigen::Triplet<double>>& triplets) {
  Eigen::SparseMatrix<double> information(values_.size(), values_.size());
  information.setFromTriplets(triplets.begin(), triplets.end());
  factor_.compute(information);
  if (factor_.info() != Eigen::Success || (factor_.vectorD().array() <= 0).any())
    throw Error("the model does not determine its unknowns", ErrorKind::kIllPosed);
}

int FittedTomography::Find(std::uint32_t material, std::int32_t x, std::int32_t y) const {
  const std::int64_t dx = std::int64_t{x} - x0_, dy = std::int64_t{y} - y0_;
  if (dx < 0 || dy < 0 || dx >= columns_ || dy >= lines_) return -1;
  return index_[static_cast<std::size_t>((material * std::int64_t{lines_} + dy) * columns_ + dx)];
}

void FittedTomography::SetMap(std::shared_ptr<const OccupancyGrid> map) {
  if (auto classes = ClassesOf(map.get(), model_.options)) rows_.SetMap(std::move(classes));
}

FittedTomography::Traced FittedTomography::TraceEnds(std::uint32_t receiver,
                                                     std::uint32_t transmitter,
                                                     double log_distance) const {
  Traced traced;
  traced.row = {{path_loss_, 1}, {path_loss_ + 1, -log_distance}};
  const double unheard_of = model_.options.bias_sigma_db * model_.options.bias_sigma_db;
  for (const auto& [radio, unknowns] :
       {std::pair(receiver, &receiver_), std::pair(transmitter, &transmitter_)}) {
    if (radio < unknowns->size())
      traced.row.emplace_back((*unknowns)[radio], 1);
    else if (model_.options.bias != RadioBias::kNone)
      traced.variance_db2 += unheard_of;
  }
  return traced;
}

void FittedTomography::TraceCell(const AttenuationCell& cell, double length_m,
                                 Traced* traced) const {
  const int unknown = Find(cell.material, cell.x, cell.y);
  if (unknown >= 0) {
    traced->row.emplace_back(unknown, -length_m);
    return;
  }
  const AttenuationClass& c = model_.options.classes[cell.material];
  const double sigma = length_m * model_.options.sigma_db / c.phi;
  traced->offset_dbm -= length_m * c.rho_db_per_m;
  traced->variance_db2 += sigma * sigma;
}

FittedTomography::Traced FittedTomography::Trace(const SignalLink& link, RayTracer* tracer) const {
  rows_.CheckLink(link);
  Traced traced = TraceEnds(link.receiver, link.transmitter,
                            rows_.LogDistance(link.receiver_m, link.transmitter_m));
  if (model_.options.classes.empty()) return traced;
  for (const RayPiece& piece : tracer->Trace(link.receiver_m, link.transmitter_m))
    TraceCell({piece.material, piece.x, piece.y}, piece.length_m, &traced);
  return traced;
}

double FittedTomography::Dot(const Row& row) const {
  double sum = 0;
  for (const auto& [unknown, value] : row) sum += value * values_[unknown];
  return sum;
}

/// Variances of rows by half a solve each: of L^-1 P row only what is not zero, which is on the way
/// from the row's unknowns to the root of the elimination tree.
struct FittedTomography::HalfSolve {
  explicit HalfSolve(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& ldlt)
      : factor(ldlt),
        lower(ldlt.matrixL().nestedExpression()),
        pivots(ldlt.vectorD()),
        values(static_cast<std::size_t>(lower.cols()), 0.0),
        is_reached(values.size(), false) {}

  double VarianceOf(const Row& row) {
    reached.clear();
    for (const auto& [unknown, value] : row) {
      int at = factor.permutationP().indices()[unknown];
      values[static_cast<std::size_t>(at)] += value;
      while (!is_reached[static_cast<std::size_t>(at)]) {
        is_reached[static_cast<std::size_t>(at)] = true;
        reached.push_back(at);
        // The parent is the first row below the diagonal, which is not stored.
        const int begin = lower.outerIndexPtr()[at];
        if (begin == lower.outerIndexPtr()[at + 1]) break;
        at = lower.innerIndexPtr()[begin];
      }
    }
    std::sort(reached.begin(), reached.end());
    double variance = 0;
    for (const int column : reached) {
      const double value = std::exchange(values[static_cast<std::size_t>(column)], 0);
      is_reached[static_cast<std::size_t>(column)] = false;
      variance += value * value / pivots[column];
      for (int k = lower.outerIndexPtr()[column]; k < lower.outerIndexPtr()[column + 1]; ++k)
        values[static_cast<std::size_t>(lower.innerIndexPtr()[k])] -= lower.valuePtr()[k] * value;
    }
    return variance;
  }

  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor;
  const Eigen::SparseMatrix<double>& lower;
  Eigen::VectorXd pivots;
  std::vector<double> values;    // 0 between calls
  std::vector<char> is_reached;  // the same
  std::vector<int> reached;
};

void FittedTomography::AddMeasurements(Span<const SignalMeasurement> measurements) {
  rows_.Add(measurements);
  is_changed_ = true;
}

void FittedTomography::Update(double) {
  if (!is_changed_) return;
  is_changed_ = false;
  rows_.Trace();
  const double correlation = std::max(0.0, model_.options.correlation);
  std::vector<Traced> later;
  for (std::size_t i = 0; i < rows_.Count(); ++i) {
    const SignalRow& row = rows_.At(i);
    later.push_back(TraceEnds(row.receiver, row.transmitter, row.log_distance));
    for (std::size_t k = 0; k < row.size; ++k)
      TraceCell(rows_.Cells().At(static_cast<std::size_t>(rows_.CellsOf(row)[k])),
                rows_.LengthsOf(row)[k], &later.back());
  }
  // Newton's method: one step where all were heard.
  for (int round = 0; round < (rows_.AllHeard() ? 1 : kRounds); ++round) {
    std::vector<Eigen::Triplet<double>> triplets = solved_triplets_;
    Eigen::VectorXd pull =
        solved_information_.selfadjointView<Eigen::Lower>() * (solved_ - values_);
    for (std::size_t i = 0; i < later.size(); ++i) {
      const SignalRow& row = rows_.At(i);
      const Traced& traced = later[i];
      const double noise = SigmaDb() * SigmaDb() + traced.variance_db2;
      const double off = row.dbm - traced.offset_dbm - Dot(traced.row);
      double weight = row.count / (1 + (row.count - 1) * correlation) / noise, slope = weight * off;
      if (!row.is_heard) {
        const Tail tail = TailAt(off / std::sqrt(noise));
        slope = -weight * std::sqrt(noise) * tail.hazard;
        weight *= tail.curvature;
      }
      for (const auto& [unknown, value] : traced.row) pull[unknown] += slope * value;
      AddTo(traced.row, weight, &triplets);
    }
    Factorise(triplets);
    const Eigen::VectorXd step = factor_.solve(pull);
    values_ += step;
    if (step.cwiseAbs().maxCoeff() < kSmallStep) break;
  }
}

void FittedTomography::Predict(Span<const SignalLink> links,
                               Span<SignalPrediction> predictions) const {
  RayTracer tracer = rows_.Tracer();
  HalfSolve posterior(factor_);
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Traced traced = Trace(links[i], &tracer);
    predictions[i].dbm = Dot(traced.row) + traced.offset_dbm;
    predictions[i].sigma_db =
        std::sqrt(SigmaDb() * SigmaDb() + traced.variance_db2 + posterior.VarianceOf(traced.row));
  }
}

double FittedTomography::AttenuationAt(std::uint32_t material, double x_m, double y_m) const {
  const double side = model_.options.cell_m;
  const auto cell = [&](double m) {
    return side > 0 ? static_cast<std::int32_t>(std::floor(m / side)) : 0;
  };
  const int unknown = Find(material, cell(x_m), cell(y_m));
  return unknown >= 0 ? values_[unknown] : model_.options.classes[material].rho_db_per_m;
}

}  // namespace graticule
