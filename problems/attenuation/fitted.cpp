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

double WeightOf(const NoiseView& noise, std::size_t component) {
  if (noise.kind != NoiseKind::kSigma || noise.values.empty()) return 1;
  const double sigma = noise.values[std::min(component, noise.values.size() - 1)];
  return 1 / (sigma * sigma);
}

}  // namespace

FittedGraph BuildFitted(const SignalLog& log, std::shared_ptr<const OccupancyGrid> map,
                        const TomographyOptions& options) {
  TomographyOptions fitted = options;
  if (!log.measurements.empty()) {
    Tomography online(options);
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
  return {std::move(built.graph), {fitted, std::move(built.layout)}};
}

FittedTomography::FittedTomography(const Graph& solved, FittedModel model)
    : model_(std::move(model)), rows_(model_.options) {
  const TomographyLayout& layout = model_.layout;
  path_loss_ = static_cast<int>(solved.Offset(solved.IdOf(Key("path_loss", 0))));
  std::int32_t x1 = 0, y1 = 0;
  for (std::size_t i = 0; i < layout.cells.size(); ++i) {
    const AttenuationCell& cell = layout.cells[i];
    x0_ = i == 0 ? cell.x : std::min(x0_, cell.x);
    y0_ = i == 0 ? cell.y : std::min(y0_, cell.y);
    x1 = i == 0 ? cell.x : std::max(x1, cell.x);
    y1 = i == 0 ? cell.y : std::max(y1, cell.y);
  }
  columns_ = layout.cells.empty() ? 0 : x1 - x0_ + 1;
  lines_ = layout.cells.empty() ? 0 : y1 - y0_ + 1;
  index_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(lines_) *
                    model_.options.classes.size(),
                -1);
  for (std::size_t i = 0; i < layout.cells.size(); ++i) {
    const AttenuationCell& cell = layout.cells[i];
    if (cell.material >= model_.options.classes.size())
      throw Error("the model has a cell of a class that it does not name");
    const auto at = (static_cast<std::size_t>(cell.material) * static_cast<std::size_t>(lines_) +
                     static_cast<std::size_t>(cell.y - y0_)) *
                        static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(cell.x - x0_);
    index_[at] = static_cast<int>(solved.Offset(solved.IdOf(layout.cell_keys[i])));
  }
  for (std::uint32_t r = 0; layout.bias != RadioBias::kNone && r < layout.radios; ++r) {
    const bool has_ends = layout.bias == RadioBias::kEnds;
    const auto offset = [&](const char* family) {
      return static_cast<int>(solved.Offset(solved.IdOf(Key(family, r))));
    };
    receiver_.push_back(offset(has_ends ? "listener" : "bias"));
    transmitter_.push_back(offset(has_ends ? "sender" : "bias"));
  }
  const Values initial = solved.InitialValues();
  const std::vector<double>& values = initial.Data();
  values_ =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  right_hand_side_ = Eigen::VectorXd::Zero(values_.size());
  TakeFactors(solved);
  Factorise();
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
        // The second derivative of -log Phi((floor - prediction) / sigma).
        const double sigma = factor.measurement[1];
        double predicted = 0;
        for (const auto& [unknown, value] : row) predicted += value * values_[unknown];
        const double z = (factor.measurement[0] - predicted) / sigma, hazard = NormalHazard(z);
        weight *= hazard * (hazard + z) / (sigma * sigma);
      }
      AddRow(row, weight);
    } else if (type == "attenuation_smooth/1") {
      AddRow({{offset(0), 1}, {offset(1), -1}}, WeightOf(factor.noise, 0));
    } else if (type == "path_loss_prior/1" || type == "radio_bias_prior/1" ||
               type == "attenuation_prior/1") {
      for (std::size_t k = 0; k < factor.measurement.size(); ++k)
        AddRow({{offset(0) + static_cast<int>(k), 1}}, WeightOf(factor.noise, k));
    } else {
      throw Error("a signal model has no factors of type " + type);
    }
  }
}

void FittedTomography::AddRow(const Row& row, double weight) {
  for (const auto& [i, a] : row)
    for (const auto& [j, b] : row)
      if (i >= j) triplets_.emplace_back(i, j, weight * a * b);
}

void FittedTomography::Factorise() {
  Eigen::SparseMatrix<double> information(values_.size(), values_.size());
  information.setFromTriplets(triplets_.begin(), triplets_.end());
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

FittedTomography::Traced FittedTomography::Trace(const SignalLink& link, RayTracer* tracer) const {
  rows_.CheckLink(link);
  Traced traced;
  traced.row = {{path_loss_, 1},
                {path_loss_ + 1, -rows_.LogDistance(link.receiver_m, link.transmitter_m)}};
  const double unheard_of = model_.options.bias_sigma_db * model_.options.bias_sigma_db;
  for (const auto& [radio, unknowns] :
       {std::pair(link.receiver, &receiver_), std::pair(link.transmitter, &transmitter_)}) {
    if (radio < unknowns->size())
      traced.row.emplace_back((*unknowns)[radio], 1);
    else if (model_.options.bias != RadioBias::kNone)
      traced.variance_db2 += unheard_of;
  }
  if (model_.options.classes.empty()) return traced;
  for (const RayPiece& piece : tracer->Trace(link.receiver_m, link.transmitter_m)) {
    const AttenuationClass& c = model_.options.classes[piece.material];
    const int unknown = Find(piece.material, piece.x, piece.y);
    if (unknown >= 0) {
      traced.row.emplace_back(unknown, -piece.length_m);
    } else {
      const double sigma = piece.length_m * model_.options.sigma_db / c.phi;
      traced.offset_dbm -= piece.length_m * c.rho_db_per_m;
      traced.variance_db2 += sigma * sigma;
    }
  }
  return traced;
}

Eigen::VectorXd FittedTomography::Dense(const Row& row) const {
  Eigen::VectorXd dense = Eigen::VectorXd::Zero(values_.size());
  for (const auto& [unknown, value] : row) dense[unknown] += value;
  return dense;
}

void FittedTomography::AddMeasurements(Span<const SignalMeasurement> measurements) {
  RayTracer tracer = rows_.Tracer();
  for (const SignalMeasurement& measurement : measurements) {
    if (!measurement.is_heard) continue;
    const Traced traced = Trace(measurement.link, &tracer);
    const double weight = 1 / (SigmaDb() * SigmaDb() + traced.variance_db2);
    const Eigen::VectorXd row = Dense(traced.row);
    right_hand_side_ += weight * (measurement.dbm - traced.offset_dbm - row.dot(values_)) * row;
    AddRow(traced.row, weight);
    is_changed_ = true;
  }
}

void FittedTomography::Update(double) {
  if (!is_changed_) return;
  is_changed_ = false;
  Factorise();
  values_ += factor_.solve(right_hand_side_);
  right_hand_side_.setZero();
}

void FittedTomography::Predict(Span<const SignalLink> links,
                               Span<SignalPrediction> predictions) const {
  RayTracer tracer = rows_.Tracer();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Traced traced = Trace(links[i], &tracer);
    const Eigen::VectorXd row = Dense(traced.row);
    predictions[i].dbm = row.dot(values_) + traced.offset_dbm;
    predictions[i].sigma_db =
        std::sqrt(SigmaDb() * SigmaDb() + traced.variance_db2 + row.dot(factor_.solve(row)));
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
