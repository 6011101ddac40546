// The five evaluations of the thesis' Table 3.1 on simulated places: train on two, test on three.
// The tables of docs/signal_evaluation.md.
//   graticule_attenuation_simulated [--rate HZ] [--seconds S] [--most N] [--threads N] [NUMBER...]

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>

#include "graticule/problems/attenuation/growing_map.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/simulate.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Evaluation {
  std::vector<std::string> train, test;
};
// Evaluation 2 of the table tests nw2 twice: taken as nw1 and nw2.
const Evaluation kEvaluations[] = {{{"nw2", "bbb3"}, {"eecs4", "dc1", "nw1"}},
                                   {{"eecs4", "dc1"}, {"bbb3", "nw1", "nw2"}},
                                   {{"bbb3", "eecs4"}, {"nw2", "nw1", "dc1"}},
                                   {{"nw1", "eecs4"}, {"nw2", "dc1", "bbb3"}},
                                   {{"dc1", "nw1"}, {"eecs4", "bbb3", "nw2"}}};

struct Words {
  double rate_hz = 4, seconds = 0;
  std::size_t most = 60, threads = 2;
};

/// What the compass search of a method turns: the thesis' meta-parameters, where one of them may be
/// several settings.
struct Coordinate {
  std::vector<std::string> settings;
  double start, step, lower, upper;
};
std::vector<Coordinate> CoordinatesOf(const std::string& method) {
  if (method == "mrt") return {{{"mrt.lambda"}, 4, 2, 0.1, 40}};
  if (method == "mrgp") return {{{"mrgp.length_m"}, 28.75, 8, 1, 60}};
  if (method == "matte")
    return {{{"matte.lambda"}, 4, 2, 0.1, 40},
            {{"matte.phi_free", "matte.phi_unknown"}, 10, 5, 0.2, 60},
            {{"matte.phi_structure"}, 4, 2, 0.2, 60},
            {{"matte.rho_free"}, 0.05, 0.1, -0.5, 5},
            {{"matte.rho_structure"}, 2, 2, 0, 20},
            {{"matte.rho_unknown"}, 0.2, 0.2, -0.5, 5}};
  return {};
}

MethodOptions OptionsAt(const std::vector<Coordinate>& coordinates, const std::vector<double>& at) {
  MethodOptions options;
  for (std::size_t i = 0; i < at.size(); ++i)
    for (const std::string& name : coordinates[i].settings) SetSignalOption(&options, name, at[i]);
  return options;
}

class Bench {
 public:
  explicit Bench(const Words& words) : words_(words) {}

  const SimulatedSignal& Place(const std::string& name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    auto& place = places_[name];
    if (!place) {
      SignalMissionOptions options;
      options.place = PlaceByName(name);
      if (words_.seconds > 0) options.place.duration_s = words_.seconds;
      options.rate_hz = words_.rate_hz;
      place = std::make_unique<SimulatedSignal>(SimulateSignal(options));
    }
    return *place;
  }

  ReplayResult Run(const std::string& name, const std::string& method, const MethodOptions& options,
                   int horizons) {
    const SimulatedSignal& place = Place(name);
    ReplayOptions replay;
    replay.horizons = horizons;
    return Replay(
        place.log,
        [&] { return std::make_unique<GrowingMap>(MakePredictor(method, options), place.maps); },
        replay);
  }

  MethodOptions Tune(const Evaluation& evaluation, const std::string& method) {
    const std::vector<Coordinate> coordinates = CoordinatesOf(method);
    if (coordinates.empty()) return {};
    CompassOptions search;
    std::vector<double> start;
    for (const Coordinate& c : coordinates) {
      start.push_back(c.start);
      search.scale.push_back(c.step);
      search.lower.push_back(c.lower);
      search.upper.push_back(c.upper);
    }
    search.last_step = 0.2;
    search.max_evaluations = words_.most;
    search.threads = words_.threads;
    const CompassResult found = CompassSearch(
        [&](const std::vector<double>& at) {
          double squares = 0, count = 0;
          for (const std::string& place : evaluation.train) {
            const SignalScore score = Trained(place, method, coordinates, at);
            squares += score.mse * static_cast<double>(score.count);
            count += static_cast<double>(score.count);
          }
          return squares / count;
        },
        start, search);
    fmt::print("  {:<8} {:.2f} dB^2 in training, {} evaluations:", method, found.value,
               found.evaluations);
    for (std::size_t i = 0; i < coordinates.size(); ++i)
      fmt::print(" {} {:.3g}", coordinates[i].settings.front(), found.best[i]);
    fmt::print("\n");
    std::fflush(stdout);
    return OptionsAt(coordinates, found.best);
  }

  /// How attenuations that were recovered compare to the truth.
  void PrintRecovered(const std::string& name, const MethodOptions& options) {
    const SimulatedSignal& place = Place(name);
    Tomography tomography(options.matte);
    tomography.SetMap(place.map);
    tomography.AddMeasurements(place.log.measurements);
    tomography.Update(place.log.measurements.back().link.time_s);
    tomography.RefreshPosterior();
    std::map<std::tuple<int, int, int>, double> truth;
    const auto& class_of = options.matte.class_of;
    for (const TrueAttenuation& cell :
         TrueAttenuations(place.plan, *place.map, options.matte.cell_m))
      if (cell.cells >= 5)
        truth[{class_of[static_cast<std::size_t>(cell.what)], cell.x, cell.y}] = cell.db_per_m;
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    std::array<double, 3> sums = {}, true_sums = {}, counts = {};
    for (const CellAttenuation& cell : tomography.Cells()) {
      const auto found =
          truth.find({static_cast<int>(cell.cell.material), cell.cell.x, cell.cell.y});
      const AttenuationClass& c = options.matte.classes[cell.cell.material];
      const double believed = options.matte.sigma_db / c.phi;
      if (found == truth.end() || cell.sigma_db_per_m > 0.8 * believed) continue;
      ++n;
      a += cell.db_per_m;
      b += found->second;
      aa += cell.db_per_m * cell.db_per_m;
      bb += found->second * found->second;
      ab += cell.db_per_m * found->second;
      sums[cell.cell.material] += cell.db_per_m;
      true_sums[cell.cell.material] += found->second;
      ++counts[cell.cell.material];
    }
    fmt::print("  {:<6} {:.0f} observed cells, correlation with truth {:.2f}; dB/m (truth):", name,
               n, (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n)));
    for (std::size_t c = 0; c < 3; ++c)
      if (counts[c] > 0)
        fmt::print(" {} {:.2f} ({:.2f}) of {:.0f}", options.matte.classes[c].name,
                   sums[c] / counts[c], true_sums[c] / counts[c], counts[c]);
    fmt::print("\n");
  }

 private:
  SignalScore Trained(const std::string& place, const std::string& method,
                      const std::vector<Coordinate>& coordinates, const std::vector<double>& at) {
    std::string key = place + method;
    for (const double value : at) key += fmt::format(" {:.12g}", value);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto found = trained_.find(key);
      if (found != trained_.end()) return found->second;
    }
    const SignalScore score = Run(place, method, OptionsAt(coordinates, at), 3).all;
    const std::lock_guard<std::mutex> lock(mutex_);
    return trained_[key] = score;
  }

  Words words_;
  std::mutex mutex_;
  std::map<std::string, std::unique_ptr<SimulatedSignal>> places_;
  std::map<std::string, SignalScore> trained_;
};

void Evaluate(std::size_t number, Bench* bench) {
  const Evaluation& evaluation = kEvaluations[number - 1];
  fmt::print("evaluation {}: train {} {}, test {} {} {}\n", number, evaluation.train[0],
             evaluation.train[1], evaluation.test[0], evaluation.test[1], evaluation.test[2]);
  MethodOptions matte;
  for (const std::string method : {"log-fit", "persistence", "mrt", "mrgp", "matte"}) {
    const MethodOptions options = bench->Tune(evaluation, method);
    if (method == "matte") matte = options;
    double squares[10] = {}, counts[10] = {}, covered = 0, all = 0, near = 0, near_count = 0;
    for (const std::string& place : evaluation.test) {
      const ReplayResult result = bench->Run(place, method, options, 10);
      for (std::size_t h = 0; h < 10; ++h) {
        const auto n = static_cast<double>(result.horizons[h].count);
        squares[h] += n * result.horizons[h].mse;
        counts[h] += n;
        if (h < 3) near += n * result.horizons[h].mse;
        if (h < 3) near_count += n;
      }
      covered += result.all.coverage[3] * static_cast<double>(result.all.count);
      all += static_cast<double>(result.all.count);
    }
    fmt::print("  {:<12} MSE", method);
    for (std::size_t h = 0; h < 10; ++h) fmt::print(" {:6.2f}", squares[h] / counts[h]);
    fmt::print(" | 0-6 s {:6.2f} | 95 % covers {:.1f}\n", near / near_count, 100 * covered / all);
    std::fflush(stdout);
  }
  for (const std::string& place : evaluation.test) bench->PrintRecovered(place, matte);
  std::fflush(stdout);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  try {
    Words words;
    std::vector<std::size_t> numbers;
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      const double value = i + 1 < argc ? std::atof(argv[i + 1]) : 0;
      if (word == "--rate")
        words.rate_hz = value, ++i;
      else if (word == "--seconds")
        words.seconds = value, ++i;
      else if (word == "--most")
        words.most = static_cast<std::size_t>(value), ++i;
      else if (word == "--threads")
        words.threads = static_cast<std::size_t>(value), ++i;
      else
        numbers.push_back(static_cast<std::size_t>(std::atoi(argv[i])));
    }
    if (numbers.empty()) numbers = {1, 2, 3, 4, 5};
    Bench bench(words);
    for (const std::size_t number : numbers) {
      if (number < 1 || number > 5) throw Error("an evaluation is 1 to 5", ErrorKind::kUsage);
      Evaluate(number, &bench);
    }
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
