// The five evaluations of the thesis' Table 3.1 on simulated places: train on two, test on three.
// The tables of docs/signal_simulation.md.
//   graticule_attenuation_simulated [--rate HZ] [--seconds S] [--most N] [--threads N]
//       [--state FOLDER] [--method NAME]... [NUMBER...]
// --state: where searches are kept, so that a run which was stopped goes on.

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>

#include "graticule/problems/attenuation/growing_map.hpp"
#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/simulate.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/problems/attenuation/tune_method.hpp"
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
constexpr std::size_t kNear = 3;  // horizons of 2 s that tuning and the verdict look at

struct Words {
  double rate_hz = 2, seconds = 0;
  std::size_t most = 60, threads = 2;
  std::string state;
  std::vector<std::string> methods = {"log-fit", "persistence", "one-attenuation-a-class",
                                      "mrt",     "mrgp",        "matte"};
};

/// What the compass search of a method turns: the thesis' meta-parameters.  One attenuation a class
/// has none ("no parameters to tune").
std::vector<std::string> Tuned(const std::string& method) {
  if (method == "persistence") return {"persistence.decay_s"};
  if (method == "mrt") return {"mrt.lambda", "mrt.rho_all", "mrt.phi_all"};
  if (method == "mrgp") return {"mrgp.length_m"};
  if (method == "matte")
    return {"matte.lambda",        "matte.rho_free",    "matte.phi_free",   "matte.rho_structure",
            "matte.phi_structure", "matte.rho_unknown", "matte.phi_unknown"};
  return {};
}

/// Pairs of an estimate and the truth.
struct Pairs {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void Add(double x, double y) {
    ++n;
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  double Correlation() const {
    return (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n));
  }
};

class Bench {
 public:
  explicit Bench(const Words& words) : words_(words) {}

  void Evaluate(std::size_t number) {
    const Evaluation& evaluation = kEvaluations[number - 1];
    fmt::print("evaluation {}: train {} {}, test {} {} {}\n", number, evaluation.train[0],
               evaluation.train[1], evaluation.test[0], evaluation.test[1], evaluation.test[2]);
    std::map<std::string, std::vector<ReplayResult>> results;
    MethodOptions matte;
    for (const std::string& method : words_.methods) {
      const MethodOptions options = Tune(number, method);
      if (method == "matte") matte = options;
      std::vector<ReplayResult>& tests = results[method];
      for (const std::string& place : evaluation.test) tests.push_back(Run(place, method, options));
      PrintScores(method, tests);
    }
    if (results.count("matte") == 0) return;
    PrintComparison(results);
    for (const std::string& place : evaluation.test) PrintRecovered(place, matte);
    std::fflush(stdout);
  }

 private:
  const SimulatedSignal& Place(const std::string& name) {
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

  ReplayResult Run(const std::string& name, const std::string& method,
                   const MethodOptions& options) {
    const SimulatedSignal& place = Place(name);
    return Replay(place.log, [&] {
      return std::make_unique<GrowingMap>(MakePredictor(method, options), place.maps);
    });
  }

  MethodOptions Tune(std::size_t number, const std::string& method) {
    TuneOptions options;
    options.only = Tuned(method);
    if (options.only.empty() || words_.most == 0) return {};
    options.by = TuneBy::kMse;
    options.replay.horizons = static_cast<int>(kNear);
    options.max_evaluations = words_.most;
    options.threads = words_.threads;
    if (!words_.state.empty())
      options.state_path = fmt::format("{}/{}-{}.search", words_.state, number, method);
    std::vector<TrainingLog> logs;
    for (const std::string& name : kEvaluations[number - 1].train)
      logs.push_back({Place(name).log, nullptr, Place(name).maps});
    const TuneResult result = TuneMethod(method, logs, {}, options);
    fmt::print("  {:<23} in training {:.2f} -> {:.2f} dB^2{}:", method, result.before, result.after,
               result.search.has_converged ? "" : ", not converged");
    for (const SignalSetting* setting : result.settings)
      fmt::print(" {} {:.3g}", setting->name, setting->get(result.options));
    fmt::print("\n");
    std::fflush(stdout);
    return result.options;
  }

  static void PrintScores(const std::string& method, const std::vector<ReplayResult>& tests) {
    fmt::print("  {:<23} MSE", method);
    double near = 0, near_count = 0;
    for (std::size_t h = 0; h < tests.front().horizons.size(); ++h) {
      double squares = 0, count = 0, variance = 0;
      for (const ReplayResult& test : tests) {
        const SignalScore& score = test.horizons[h];
        const auto n = static_cast<double>(score.count);
        squares += n * score.mse;
        variance += n * n * score.standard_error * score.standard_error;
        count += n;
      }
      fmt::print(" {:.2f}", squares / count);
      if (h < kNear) fmt::print("+-{:.2f}", std::sqrt(variance) / count);
      if (h < kNear) near += squares, near_count += count;
    }
    fmt::print(" | 0-6 s {:.2f} | 95 % covers", near / near_count);
    double covered = 0, all = 0;
    for (const ReplayResult& test : tests) {
      const auto n = static_cast<double>(test.all.count);
      covered += n * test.all.coverage[3];
      all += n;
      fmt::print(" {:.1f}", 100 * test.all.coverage[3]);
    }
    fmt::print(", in all {:.1f}\n", 100 * covered / all);
    std::fflush(stdout);
  }

  /// MATTE beside each other method, paired; negative: MATTE is better.
  static void PrintComparison(const std::map<std::string, std::vector<ReplayResult>>& results) {
    for (const auto& [method, tests] : results) {
      if (method == "matte") continue;
      fmt::print("  matte - {:<23}", method);
      for (std::size_t h = 0; h <= kNear; ++h) {
        const PairedDifference difference = ComparePaired(
            results.at("matte"), tests, h == kNear ? 0 : h, h == kNear ? kNear : h + 1);
        fmt::print(" {}{:+.2f}+-{:.2f}", h == kNear ? "| 0-6 s " : "", difference.mse,
                   difference.standard_error);
      }
      fmt::print("\n");
    }
  }

  /// How attenuations that were recovered compare to the truth, in cells that rays have told of.
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
    Pairs all;
    std::array<Pairs, 3> of_class;
    for (const CellAttenuation& cell : tomography.Cells()) {
      const auto found =
          truth.find({static_cast<int>(cell.cell.material), cell.cell.x, cell.cell.y});
      const double believed =
          options.matte.sigma_db / options.matte.classes[cell.cell.material].phi;
      if (found == truth.end() || cell.sigma_db_per_m > 0.8 * believed) continue;
      all.Add(cell.db_per_m, found->second);
      of_class[cell.cell.material].Add(cell.db_per_m, found->second);
    }
    fmt::print("  {:<6} {:.0f} observed cells, correlation with truth {:.2f}; dB/m (truth):", name,
               all.n, all.Correlation());
    for (std::size_t c = 0; c < of_class.size(); ++c)
      if (of_class[c].n > 0)
        fmt::print(" {} {:.2f} ({:.2f}) of {:.0f}, correlation {:.2f};",
                   options.matte.classes[c].name, of_class[c].a / of_class[c].n,
                   of_class[c].b / of_class[c].n, of_class[c].n, of_class[c].Correlation());
    fmt::print("\n");
  }

  Words words_;
  std::map<std::string, std::unique_ptr<SimulatedSignal>> places_;
};

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  try {
    Words words;
    std::vector<std::size_t> numbers;
    std::vector<std::string> methods;
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
      else if (word == "--state" && i + 1 < argc)
        words.state = argv[++i];
      else if (word == "--method" && i + 1 < argc)
        methods.push_back(argv[++i]);
      else
        numbers.push_back(static_cast<std::size_t>(std::atoi(argv[i])));
    }
    if (!methods.empty()) words.methods = methods;
    if (numbers.empty()) numbers = {1, 2, 3, 4, 5};
    Bench bench(words);
    for (const std::size_t number : numbers) {
      if (number < 1 || number > 5) throw Error("an evaluation is 1 to 5", ErrorKind::kUsage);
      bench.Evaluate(number);
    }
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
