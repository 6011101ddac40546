#include "graticule/problems/attenuation/tune_method.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Parameters = std::vector<MetaParameter>;

void AddTomography(const std::string& name, TomographyOptions MethodOptions::*of,
                   const MethodOptions& options, Parameters* all) {
  const TomographyOptions& now = options.*of;
  const auto add = [&](const std::string& what, double TomographyOptions::*member, double least,
                       double most) {
    all->push_back({name + "." + what, [=](MethodOptions* o) { return &((o->*of).*member); }, true,
                    1, least, most});
  };
  if (now.cell_m > 0) {
    add("cell_m", &TomographyOptions::cell_m, 0.5, 20);
    add("lambda", &TomographyOptions::lambda, 0.05, 100);
  }
  if (now.bias != RadioBias::kNone)
    add("bias_sigma_db", &TomographyOptions::bias_sigma_db, 0.1, 30);
  for (std::size_t c = 0; c < now.classes.size(); ++c) {
    all->push_back({name + ".rho_" + now.classes[c].name,
                    [=](MethodOptions* o) { return &(o->*of).classes[c].rho_db_per_m; }, false, 0.5,
                    -2, 20});
    all->push_back({name + ".phi_" + now.classes[c].name,
                    [=](MethodOptions* o) { return &(o->*of).classes[c].phi; }, true, 1, 0.05,
                    100});
  }
}

void AddProcess(const std::string& name, GaussianProcessOptions MethodOptions::*of,
                const MethodOptions& options, Parameters* all) {
  if ((options.*of).learn) return;
  all->push_back({name + ".length_m", [=](MethodOptions* o) { return &(o->*of).place.length_m; },
                  true, 1, 0.05, 200});
  all->push_back({name + ".sigma_f_db", [=](MethodOptions* o) { return &(o->*of).sigma_f_db; },
                  true, 1, 0.05, 50});
  all->push_back({name + ".sigma_d_db", [=](MethodOptions* o) { return &(o->*of).sigma_d_db; },
                  true, 1, 0.1, 50});
}

void AddResidual(const std::string& name, ResidualGpOptions MethodOptions::*of,
                 const MethodOptions& options, Parameters* all) {
  const auto add = [&](const std::string& what, double ResidualGpOptions::*member, double least,
                       double most) {
    all->push_back({name + "." + what, [=](MethodOptions* o) { return &((o->*of).*member); }, true,
                    1, least, most});
  };
  add("offset_db", &ResidualGpOptions::offset_db, 0.05, 20);
  all->push_back({name + ".length_m", [=](MethodOptions* o) { return &(o->*of).place.length_m; },
                  true, 1, 0.05, 200});
  add("place_db", &ResidualGpOptions::place_db, 0.1, 30);
  add("link_db", &ResidualGpOptions::link_db, 0.1, 30);
  add("link_s", &ResidualGpOptions::link_s, 0.25, 600);
  if ((options.*of).radio_db > 0) add("radio_db", &ResidualGpOptions::radio_db, 0.1, 30);
  add("noise_db", &ResidualGpOptions::noise_db, 0.3, 30);
}

}  // namespace

std::vector<MetaParameter> MetaParameters(const std::string& method, const MethodOptions& options) {
  MakePredictor(method, options);  // throws where there is none
  Parameters all;
  std::string mean = method;
  while (mean.size() > 3 && mean.compare(mean.size() - 3, 3, "+gp") == 0)
    mean.resize(mean.size() - 3);
  if (mean == "persistence")
    all.push_back({"persistence.decay_s", [](MethodOptions* o) { return &o->persistence_s; }, true,
                   1, 0.5, 3600});
  if (mean == "one-attenuation-a-class")
    AddTomography(mean, &MethodOptions::one_a_class, options, &all);
  if (mean == "mrt") AddTomography(mean, &MethodOptions::mrt, options, &all);
  if (mean == "matte") AddTomography(mean, &MethodOptions::matte, options, &all);
  if (mean == "fine-mrt") AddTomography(mean, &MethodOptions::fine_mrt, options, &all);
  if (mean == "mrgp") AddProcess(mean, &MethodOptions::mrgp, options, &all);
  if (mean == "pair-gp") AddProcess(mean, &MethodOptions::pair_gp, options, &all);
  if (mean == method) return all;
  if (mean == "fine-mrt")
    AddResidual("fine-mrt-gp", &MethodOptions::fine_mrt_gp, options, &all);
  else
    AddResidual("gp", &MethodOptions::residual_gp, options, &all);
  return all;
}

TuneResult TuneMethod(const std::string& method, const std::vector<TrainingLog>& logs,
                      const MethodOptions& start, const TuneOptions& options) {
  if (logs.empty()) throw Error("tune: no log to tune on", ErrorKind::kUsage);
  TuneResult result;
  result.options = start;
  Parameters all = MetaParameters(method, start);
  for (const std::string& name : options.only) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const MetaParameter& p) { return p.name == name; });
    if (found == all.end())
      throw Error("tune: " + method + " has no parameter " + Quoted(name), ErrorKind::kUsage);
    result.parameters.push_back(*found);
  }
  if (options.only.empty()) result.parameters = std::move(all);
  if (result.parameters.empty())
    throw Error("tune: " + method + " has no parameter", ErrorKind::kUsage);

  CompassOptions search;
  search.first_step = options.first_step;
  search.last_step = options.last_step;
  search.max_evaluations = options.max_evaluations;
  search.threads = options.threads;
  search.state_path = options.state_path;
  const auto coordinate = [](const MetaParameter& p, double value) {
    return p.is_log ? std::log2(value) : value / p.step;
  };
  std::vector<double> from;
  for (const MetaParameter& p : result.parameters) {
    from.push_back(coordinate(p, *p.value(&result.options)));
    search.lower.push_back(coordinate(p, p.least));
    search.upper.push_back(coordinate(p, p.most));
  }
  const auto at = [&](const std::vector<double>& x) {
    MethodOptions there = start;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const MetaParameter& p = result.parameters[i];
      *p.value(&there) = p.is_log ? std::exp2(x[i]) : x[i] * p.step;
    }
    return there;
  };
  const auto score = [&](const std::vector<double>& x) {
    const MethodOptions there = at(x);
    double sum = 0;
    for (const TrainingLog& training : logs) {
      const SignalScore all_horizons =
          Replay(
              training.log,
              [&]() -> std::unique_ptr<SignalPredictor> {
                auto predictor = MakePredictor(method, there);
                predictor->SetMap(training.map);
                if (training.maps.empty()) return predictor;
                return std::make_unique<GrowingMap>(std::move(predictor), training.maps);
              },
              options.replay)
              .all;
      sum += options.by == TuneBy::kMse ? all_horizons.mse : all_horizons.negative_log_likelihood;
    }
    return sum / static_cast<double>(logs.size());
  };
  result.search = CompassSearch(score, from, search);
  result.before = result.search.start_value;
  result.after = result.search.value;
  result.options = at(result.search.best);
  return result;
}

}  // namespace graticule
