// What simulated signals are like, to be laid beside recorded ones: the tables of
// docs/signal_simulation.md.
//   graticule_attenuation_statistics [PLACE...]

#include <fmt/core.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>

#include "graticule/problems/attenuation/simulate.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

struct Moments {
  double count = 0, sum = 0, squares = 0;
  void Add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  double Mean() const { return sum / count; }
  double Deviation() const { return std::sqrt(std::max(0.0, squares / count - Mean() * Mean())); }
};

struct LogLine {
  double l0 = 0, exponent = 0;
};

LogLine FitLine(const std::vector<double>& decades, const std::vector<double>& dbm) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < dbm.size(); ++i) {
    const Eigen::Vector2d row(1, -10 * decades[i]);
    information += row * row.transpose();
    right += row * dbm[i];
  }
  const Eigen::Vector2d x = information.ldlt().solve(right);
  return {x[0], x[1]};
}

/// Links between fixed nodes at random places, without fading and biases: exponent, deviation, and
/// how links that share an end correlate.
void PrintFixed(const PlaceOptions& place) {
  const FloorPlan plan = MakeFloorPlan(place);
  const OccupancyGrid truth = plan.Occupied();
  RadioWorld world(plan, {}, place.seed);
  RandomNumbers random(1);
  std::vector<Eigen::Vector3d> nodes;
  while (nodes.size() < 250) {
    const Eigen::Vector3d at(random.Uniform(0, place.width_m - 0.01),
                             random.Uniform(0, place.height_m - 0.01), 0);
    if (truth.At(static_cast<std::size_t>(at.x() / truth.resolution),
                 static_cast<std::size_t>(at.y() / truth.resolution)) == Occupancy::kFree)
      nodes.push_back(at);
  }
  const std::size_t n = nodes.size();
  std::vector<double> residual(n * n, NAN), decades, dbm;
  std::vector<std::size_t> which;
  Moments walls;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (nodes[i] - nodes[j]).norm();
      if (distance < 1) continue;
      const double material = world.MaterialLossDb(nodes[i], nodes[j]);
      const double mean = world.MeanDbm(nodes[i], nodes[j], material);
      if (mean < world.Options().floor_dbm) continue;
      decades.push_back(std::log10(distance));
      dbm.push_back(mean);
      which.push_back(i * n + j);
      walls.Add(material);
    }
  const LogLine line = FitLine(decades, dbm);
  Moments all;
  for (std::size_t k = 0; k < which.size(); ++k) {
    const double r = dbm[k] - line.l0 + 10 * line.exponent * decades[k];
    all.Add(r);
    residual[which[k]] = r;
    residual[which[k] % n * n + which[k] / n] = r;
  }
  const double bins[][2] = {{0.4, 0.8}, {1, 1.5}, {2, 4}, {8, 12}, {12, 20}};
  fmt::print(
      "{:<8} {:6d} links, exponent {:.2f}, shadowing {:.2f} dB, walls {:.1f} dB; shared end:",
      place.name, which.size(), line.exponent, all.Deviation(), walls.Mean());
  for (const auto& bin : bins) {
    double products = 0, squares = 0, count = 0;
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < j; ++k) {
        const double apart = (nodes[j] - nodes[k]).norm();
        if (apart < bin[0] || apart > bin[1]) continue;
        for (std::size_t i = 0; i < n; ++i) {
          const double a = residual[i * n + j], b = residual[i * n + k];
          if (std::isnan(a) || std::isnan(b)) continue;
          products += a * b;
          squares += 0.5 * (a * a + b * b);
          ++count;
        }
      }
    fmt::print(" {:.2f}", count > 200 ? products / squares : NAN);
  }
  fmt::print("\n");
}

void PrintMission(const PlaceOptions& place) {
  SignalMissionOptions options;
  options.place = place;
  const Stopwatch watch;
  const SimulatedSignal simulated = SimulateSignal(options);
  const double seconds = watch.Elapsed().wall;
  std::vector<double> decades, dbm;
  std::size_t not_heard = 0;
  Moments reciprocity;
  const auto& all = simulated.log.measurements;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].is_heard) {
      ++not_heard;
      continue;
    }
    decades.push_back(
        std::log10(std::max(0.1, (all[i].link.receiver_m - all[i].link.transmitter_m).norm())));
    dbm.push_back(all[i].dbm);
    if (i % 2 == 0 && all[i + 1].is_heard) reciprocity.Add(all[i].dbm - all[i + 1].dbm);
  }
  const LogLine line = FitLine(decades, dbm);
  Moments residual;
  for (std::size_t k = 0; k < dbm.size(); ++k)
    residual.Add(dbm[k] - line.l0 + 10 * line.exponent * decades[k]);
  std::size_t known = 0, structure = 0;
  for (const Occupancy what : simulated.map->cells) {
    known += what != Occupancy::kUnknown;
    structure += what == Occupancy::kStructure;
  }
  fmt::print(
      "{:<8} {:.0f} s, {} measurements, {:.1f} % not heard; exponent {:.2f}, residual {:.2f} dB, "
      "both ways differ by {:.2f} dB; {:.0f} m2 known, {:.0f} of it structure; {:.1f} s\n",
      place.name, place.duration_s, all.size(),
      100.0 * static_cast<double>(not_heard) / static_cast<double>(all.size()), line.exponent,
      residual.Deviation(), reciprocity.Deviation(), 0.01 * static_cast<double>(known),
      0.01 * static_cast<double>(structure), seconds);
}

/// Fading in sight and behind walls: its deviation, and correlation over so many centimetres.
void PrintFading() {
  for (const double walls_db : {0.0, 20.0}) {
    RandomNumbers random(1);
    const RadioOptions radio;
    LinkFading fading(radio, &random);
    std::vector<double> values;
    for (int i = 0; i < 100000; ++i) values.push_back(fading.Next(0.005, 0, walls_db));
    Moments all;
    for (const double value : values) all.Add(value);
    fmt::print("fading behind {:.0f} dB: mean {:.2f}, deviation {:.2f} dB; correlation at",
               walls_db, all.Mean(), all.Deviation());
    for (const std::size_t lag : {2, 3, 4, 10, 20, 40}) {
      double products = 0;
      for (std::size_t i = 0; i + lag < values.size(); ++i)
        products += (values[i] - all.Mean()) * (values[i + lag] - all.Mean());
      fmt::print(" {:.1f} cm {:.2f}", 0.5 * static_cast<double>(lag),
                 products / static_cast<double>(values.size() - lag) /
                     (all.Deviation() * all.Deviation()));
    }
    fmt::print("\n");
  }
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  try {
    std::vector<PlaceOptions> places;
    for (int i = 1; i < argc; ++i) places.push_back(PlaceByName(argv[i]));
    if (places.empty()) places = KnownPlaces();
    fmt::print("walls [dB]:");
    for (const Filling wall : {Filling::kPartition, Filling::kBlockWall, Filling::kBrickWall,
                               Filling::kConcreteWall, Filling::kGlassWall})
      fmt::print(" {} {:.1f},", LossOf(wall).name, LossOf(wall).db_per_m * DrawnThickness(wall));
    fmt::print(" bookshelf {:.1f} dB/m\n", LossOf(Filling::kBookshelf).db_per_m);
    PrintFading();
    for (const PlaceOptions& place : places) PrintFixed(place);
    for (const PlaceOptions& place : places) PrintMission(place);
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
