#include "graticule/problems/attenuation/tomography_graph.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/attenuation/signal_system.hpp"

namespace graticule {
namespace {

const Key& PathLossKey() {
  static const Key key("path_loss", 0);
  return key;
}
Key ReceiverKey(RadioBias kind, std::uint32_t radio) {
  return {kind == RadioBias::kEnds ? "listener" : "bias", radio};
}
Key TransmitterKey(RadioBias kind, std::uint32_t radio) {
  return {kind == RadioBias::kEnds ? "sender" : "bias", radio};
}

/// Keys that say where in the rectangle of all cells each one is.
std::vector<Key> CellKeys(const std::vector<AttenuationCell>& cells,
                          const std::vector<AttenuationClass>& classes) {
  std::int64_t x0 = INT32_MAX, x1 = INT32_MIN, y0 = INT32_MAX;
  for (const AttenuationCell& cell : cells) {
    x0 = std::min<std::int64_t>(x0, cell.x);
    x1 = std::max<std::int64_t>(x1, cell.x);
    y0 = std::min<std::int64_t>(y0, cell.y);
  }
  std::vector<Key> keys;
  for (const AttenuationCell& cell : cells)
    keys.emplace_back("cell_" + classes[cell.material].name,
                      static_cast<std::uint64_t>((cell.y - y0) * (x1 - x0 + 1) + (cell.x - x0)));
  return keys;
}

/// Adds the factors of a graph by position, names looked up once.
class Adder {
 public:
  Adder(const SignalRows& rows, const SignalSystem& system, const TomographyOptions& options,
        TomographyGraph* to)
      : rows_(rows), system_(system), options_(options), graph_(&to->graph), layout_(&to->layout) {}

  void AddVariables() {
    path_loss_ = graph_->Add(PathLossKey(), "vector2/1", {options_.l0_dbm, options_.slope_db});
    for (std::uint32_t r = 0; layout_->bias != RadioBias::kNone && r < layout_->radios; ++r) {
      receiver_.push_back(graph_->Add(ReceiverKey(layout_->bias, r), "vector1/1", {0}));
      transmitter_.push_back(layout_->bias == RadioBias::kEnds
                                 ? graph_->Add(TransmitterKey(layout_->bias, r), "vector1/1", {0})
                                 : receiver_.back());
    }
    const Graph::TypeId scalar = graph_->VariableTypeId("vector1/1");
    for (std::size_t i = 0; i < layout_->cells.size(); ++i) {
      const double rho = options_.classes[layout_->cells[i].material].rho_db_per_m;
      cells_.push_back(graph_->Add(layout_->cell_keys[i], scalar, {&rho, 1}, false));
    }
  }

  void AddRows() {
    const Graph::TypeId heard = graph_->FactorTypeId("signal_path/1");
    const Graph::TypeId heard_bare = graph_->FactorTypeId("path_loss/1");
    const Graph::TypeId not_heard = graph_->FactorTypeId("signal_path_not_heard/1");
    const Graph::TypeId not_heard_bare = graph_->FactorTypeId("path_loss_not_heard/1");
    std::vector<VariableId> variables;
    std::vector<double> numbers;
    for (std::size_t i = 0; i < rows_.Count(); ++i) {
      const SignalRow& row = rows_.At(i);
      variables.assign({path_loss_});
      numbers.assign({row.dbm});
      if (!row.is_heard) numbers.push_back(options_.sigma_db);
      numbers.push_back(row.log_distance);
      if (!receiver_.empty()) {
        variables.insert(variables.end(), {receiver_[row.receiver], transmitter_[row.transmitter]});
        numbers.insert(numbers.end(), {-1, -1});
      }
      for (std::size_t k = 0; k < row.size; ++k) {
        variables.push_back(cells_[static_cast<std::size_t>(rows_.CellsOf(row)[k])]);
        numbers.push_back(rows_.LengthsOf(row)[k]);
      }
      const bool is_bare = variables.size() == 1;
      const double share = 1 / std::sqrt(system_.Equations()[i].weight);
      const double sigma = row.is_heard ? options_.sigma_db * share : share;
      const Graph::TypeId type =
          row.is_heard ? (is_bare ? heard_bare : heard) : (is_bare ? not_heard_bare : not_heard);
      graph_->Add(type, variables, numbers, {NoiseKind::kSigma, {&sigma, 1}},
                  row.is_heard ? options_.loss : Loss{}, row.is_heard ? "heard" : "not heard");
    }
  }

  void AddPriors() {
    graph_->Add({"path_loss_prior/1",
                 {PathLossKey()},
                 {options_.l0_dbm, options_.slope_db},
                 Noise::Sigmas({options_.l0_sigma_db, options_.slope_sigma_db}),
                 {},
                 "prior"});
    const auto add = [&](const char* type, VariableId variable, double value, double sigma) {
      graph_->Add(graph_->FactorTypeId(type), {&variable, 1}, {&value, 1},
                  {NoiseKind::kSigma, {&sigma, 1}}, {}, "prior");
    };
    for (std::size_t r = 0; r < receiver_.size(); ++r) {
      add("radio_bias_prior/1", receiver_[r], 0, options_.bias_sigma_db);
      if (layout_->bias == RadioBias::kEnds)
        add("radio_bias_prior/1", transmitter_[r], 0, options_.bias_sigma_db);
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const AttenuationClass& c = options_.classes[layout_->cells[i].material];
      add("attenuation_prior/1", cells_[i], c.rho_db_per_m, options_.sigma_db / c.phi);
    }
    if (options_.lambda == 0) return;
    const Graph::TypeId smooth = graph_->FactorTypeId("attenuation_smooth/1");
    const double sigma = options_.sigma_db / options_.lambda, none = 0;
    for (std::size_t i = 0; i < cells_.size(); ++i)
      for (const std::int32_t other : {rows_.Cells().Right(i), rows_.Cells().Up(i)}) {
        if (other < 0) continue;
        const VariableId pair[] = {cells_[i], cells_[static_cast<std::size_t>(other)]};
        graph_->Add(smooth, {pair, 2}, {&none, 1}, {NoiseKind::kSigma, {&sigma, 1}}, {},
                    "smoothness");
      }
  }

 private:
  const SignalRows& rows_;
  const SignalSystem& system_;
  const TomographyOptions& options_;
  Graph* graph_;
  TomographyLayout* layout_;
  VariableId path_loss_ = 0;
  std::vector<VariableId> receiver_, transmitter_, cells_;
};

}  // namespace

TomographyGraph BuildTomography(Span<const SignalMeasurement> measurements,
                                std::shared_ptr<const ClassMap> map,
                                const TomographyOptions& options) {
  options.Check();
  SignalRows rows(options);
  if (map && options.uses_map) rows.SetMap(std::move(map));
  rows.Add(measurements);
  rows.Trace();
  double last_s = 0;
  for (std::size_t i = 0; i < measurements.size(); ++i)
    last_s = i == 0 ? measurements[i].link.time_s : std::max(last_s, measurements[i].link.time_s);
  SignalSystem system(options);
  system.Set(rows, options.sigma_db, std::max(0.0, options.correlation), last_s);

  TomographyGraph built{Graph(Builtins()), {}};
  built.layout.bias = options.bias;
  built.layout.radios = rows.RadioCount();
  for (std::size_t i = 0; i < rows.Cells().Count(); ++i)
    built.layout.cells.push_back(rows.Cells().At(i));
  built.layout.cell_keys = CellKeys(built.layout.cells, options.classes);
  built.graph.Reserve(1 + 2 * rows.RadioCount() + rows.Cells().Count(),
                      rows.Count() + 3 * rows.Cells().Count());
  Adder adder(rows, system, options, &built);
  adder.AddVariables();
  adder.AddRows();
  adder.AddPriors();
  return built;
}

SolveOptions TomographySolving() {
  SolveOptions options;
  options.gradient_tolerance = 1e-8;
  // Packets not heard make the last digits slow to come, and they mean nothing.
  options.function_tolerance = 1e-14;
  return options;
}

TomographyEstimate ReadBackTomography(const TomographyLayout& layout, const Values& values) {
  TomographyEstimate estimate;
  const Span<const double> path_loss = values.At(PathLossKey());
  estimate.l0_dbm = path_loss[0];
  estimate.slope_db = path_loss[1];
  for (std::uint32_t r = 0; layout.bias != RadioBias::kNone && r < layout.radios; ++r) {
    estimate.receiver_bias_db.push_back(values.At(ReceiverKey(layout.bias, r))[0]);
    estimate.transmitter_bias_db.push_back(values.At(TransmitterKey(layout.bias, r))[0]);
  }
  for (const Key& key : layout.cell_keys) estimate.db_per_m.push_back(values.At(key)[0]);
  return estimate;
}

}  // namespace graticule
