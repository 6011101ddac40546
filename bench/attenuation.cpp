// Signal strength: rays through a map, tomography online and as a recorded graph.  The map is 160 x
// 100 m in cells of 0.1 m: houses with rooms, some of them never seen from inside, in the open.

#include <benchmark/benchmark.h>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

#include "graticule/problems/attenuation/replay.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/problems/attenuation/tomography_graph.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/solve.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kWidth = 1600, kHeight = 1000;

std::shared_ptr<const OccupancyGrid> Street() {
  static const auto street = [] {
    auto grid = std::make_shared<OccupancyGrid>();
    grid->width = kWidth;
    grid->height = kHeight;
    grid->cells.assign(kWidth * kHeight, Occupancy::kFree);
    RandomNumbers random(11);
    const auto set = [&](std::size_t x0, std::size_t x1, std::size_t y0, std::size_t y1,
                         Occupancy what) {
      for (std::size_t y = y0; y < std::min(y1, kHeight); ++y)
        for (std::size_t x = x0; x < std::min(x1, kWidth); ++x) grid->cells[y * kWidth + x] = what;
    };
    for (std::size_t y = 60; y + 200 < kHeight; y += 320)
      for (std::size_t x = 60; x + 300 < kWidth; x += 380) {
        const std::size_t w = 220 + random.Below(80), h = 160 + random.Below(60);
        const bool seen = random.Unit() < 0.6;
        set(x, x + w, y, y + h, Occupancy::kStructure);
        set(x + 2, x + w - 2, y + 2, y + h - 2, seen ? Occupancy::kFree : Occupancy::kUnknown);
        for (std::size_t i = 50; seen && i < w; i += 50)
          set(x + i, x + i + 2, y, y + h - 30, Occupancy::kStructure);
        if (seen) set(x + w / 2, x + w / 2 + 12, y, y + 2, Occupancy::kFree);
        for (int k = 0; seen && k < 12; ++k) {  // furniture
          const std::size_t fx = x + random.Below(w), fy = y + random.Below(h);
          set(fx, fx + 4 + random.Below(12), fy, fy + 4 + random.Below(8), Occupancy::kStructure);
        }
      }
    return grid;
  }();
  return street;
}

/// Speckled: no tile is of one class.
std::shared_ptr<const OccupancyGrid> Speckle() {
  auto grid = std::make_shared<OccupancyGrid>(*Street());
  RandomNumbers random(5);
  for (Occupancy& cell : grid->cells)
    if (random.Unit() < 0.05) cell = static_cast<Occupancy>(random.Below(3));
  return grid;
}

Vector3d AnyPlace(RandomNumbers* random) {
  return {random->Uniform(1, 159), random->Uniform(1, 99), 0};
}

std::vector<std::pair<Vector3d, Vector3d>> Rays(std::size_t count, double longest_m) {
  RandomNumbers random(3);
  std::vector<std::pair<Vector3d, Vector3d>> rays;
  while (rays.size() < count) {
    const Vector3d a = AnyPlace(&random), b = AnyPlace(&random);
    if ((a - b).norm() < longest_m) rays.emplace_back(a, b);
  }
  return rays;
}

void RayThrough(benchmark::State& state, const OccupancyGrid& grid) {
  const ClassMap map(grid, {2, 0, 1});
  RayTracer tracer(&map, 4);
  const auto rays = Rays(2000, 60);
  std::int64_t cells = 0, count = 0;
  for (auto _ : state)
    for (const auto& [a, b] : rays) {
      benchmark::DoNotOptimize(tracer.Trace(a, b).data());
      cells += tracer.CellsCrossed();
      ++count;
    }
  state.counters["ns_per_cell"] = benchmark::Counter(
      static_cast<double>(cells) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["ns_per_ray"] = benchmark::Counter(
      static_cast<double>(count) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
void RayStreet(benchmark::State& state) { RayThrough(state, *Street()); }
BENCHMARK(RayStreet);
void RaySpeckle(benchmark::State& state) { RayThrough(state, *Speckle()); }
BENCHMARK(RaySpeckle);

// Amanatides and Woo as in their paper, cell by cell over rows, added up a class.
void PlainWalk(benchmark::State& state) {
  const OccupancyGrid& grid = *Street();
  const auto rays = Rays(2000, 60);
  std::int64_t cells = 0;
  for (auto _ : state)
    for (const auto& [a, b] : rays) {
      const Vector3d u = a * 10, v = b * 10, by = v - u;
      std::int64_t x = static_cast<std::int64_t>(u.x()), y = static_cast<std::int64_t>(u.y());
      const std::int64_t x1 = static_cast<std::int64_t>(v.x()),
                         y1 = static_cast<std::int64_t>(v.y());
      const std::int64_t sx = by.x() > 0 ? 1 : -1, sy = by.y() > 0 ? 1 : -1;
      const double dx = 1 / std::abs(by.x()), dy = 1 / std::abs(by.y());
      double tx = (static_cast<double>(x + (sx > 0)) - u.x()) / by.x();
      double ty = (static_cast<double>(y + (sy > 0)) - u.y()) / by.y();
      double at = 0, length[3] = {0, 0, 0};
      while (x != x1 || y != y1) {
        const auto c = static_cast<std::size_t>(
            grid.At(static_cast<std::size_t>(x), static_cast<std::size_t>(y)));
        ++cells;
        if (tx < ty) {
          length[c] += tx - at;
          at = tx;
          tx += dx;
          x += sx;
        } else {
          length[c] += ty - at;
          at = ty;
          ty += dy;
          y += sy;
        }
        if (at > 1) break;
      }
      benchmark::DoNotOptimize(length);
    }
  state.counters["ns_per_cell"] = benchmark::Counter(
      static_cast<double>(cells) * 1e-9, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(PlainWalk);

void MapSummary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(ClassMap(*Street(), {2, 0, 1}).ClassCount());
}
BENCHMARK(MapSummary)->Unit(benchmark::kMillisecond);

/// What a radio hears, plus noise of 4 dB.
double Strength(RayTracer* tracer, const Vector3d& a, const Vector3d& b, RandomNumbers* random) {
  double dbm = -38 - 22 * std::log10(std::max(0.1, (a - b).norm())) + 4 * random->Normal();
  const double loss[3] = {0.05, 2, 0.3};
  for (const RayPiece& piece : tracer->Trace(a, b)) dbm -= piece.length_m * loss[piece.material];
  return std::max(-120.0, dbm);
}

std::vector<SignalMeasurement> AnyMeasurements(std::size_t count) {
  const ClassMap map(*Street(), {2, 0, 1});
  RayTracer tracer(&map, 0);
  RandomNumbers random(4);
  std::vector<SignalMeasurement> all;
  for (const auto& [a, b] : Rays(count, 40)) {
    SignalMeasurement m;
    m.link = {static_cast<double>(all.size()), 0, 1, a, b};
    m.dbm = Strength(&tracer, a, b, &random);
    all.push_back(m);
  }
  return all;
}

/// 100 x 100 cells of 1.6 x 1.0 m would not be square: cells of 1.265 m are as many, 10,000 a
/// class.
void GridOfTenThousandCells(benchmark::State& state) {
  const auto measurements = AnyMeasurements(static_cast<std::size_t>(state.range(0)));
  TomographyOptions options;
  options.cell_m = 1.265;
  options.samples = static_cast<int>(state.range(1));
  options.bias = RadioBias::kNone;
  double iterations = 0, cells = 0, entries = 0;
  for (auto _ : state) {
    Tomography matte(options);
    matte.SetMap(Street());
    matte.AddMeasurements(measurements);
    matte.Update(0);
    iterations = matte.LastIterations();
    cells = static_cast<double>(matte.Rows().Cells().Count());
    entries = static_cast<double>(matte.Rows().EntryCount());
  }
  state.counters["iterations"] = iterations;
  state.counters["cells"] = cells;
  state.counters["entries"] = entries;
}
BENCHMARK(GridOfTenThousandCells)
    ->Args({5000, 0})
    ->Args({40000, 0})
    ->Args({40000, 64})
    ->Unit(benchmark::kMillisecond);

/// 40 x 25 cells of 4 m, 10,000 rays: the recorded graph, built before.
void GraphSolve(benchmark::State& state) {
  const auto map =
      std::make_shared<const ClassMap>(*Street(), std::array<std::uint8_t, 3>{2, 0, 1});
  TomographyOptions options;
  options.correlation = 0;
  const TomographyGraph built = BuildTomography(AnyMeasurements(10000), map, options);
  SolveOptions solve = TomographySolving();
  solve.engine = static_cast<Engine>(state.range(0));
  solve.linear_solver = static_cast<LinearSolver>(state.range(1));
  int iterations = 0;
  for (auto _ : state) {
    const Solution solution = Solve(built.graph, solve);
    iterations = static_cast<int>(solution.report.iterations.size());
  }
  state.counters["iterations"] = iterations;
  state.counters["unknowns"] = static_cast<double>(built.graph.VariableCount());
}
BENCHMARK(GraphSolve)
    ->Args({static_cast<int>(Engine::kAutomatic), static_cast<int>(LinearSolver::kAutomatic)})
    ->Args({static_cast<int>(Engine::kCeres),
            static_cast<int>(LinearSolver::kSparseNormalCholesky)})
    ->Args({static_cast<int>(Engine::kCeres), static_cast<int>(LinearSolver::kDenseNormalCholesky)})
    ->Unit(benchmark::kMillisecond);

/// The same rows as normal equations, added up and factorised by CHOLMOD.
void NormalEquations(benchmark::State& state) {
  const auto map =
      std::make_shared<const ClassMap>(*Street(), std::array<std::uint8_t, 3>{2, 0, 1});
  TomographyOptions options;
  SignalRows rows(options);
  rows.SetMap(map);
  rows.Add(AnyMeasurements(10000));
  rows.Trace();
  SignalSystem system(options);
  system.Set(rows, options.sigma_db, 0, 0);
  system.Prepare();
  const auto size = static_cast<Eigen::Index>(system.Size());
  for (auto _ : state) {
    std::vector<Eigen::Triplet<double>> terms;
    int row = 0;
    for (const SignalEquation& e : system.Equations()) {
      const double root = std::sqrt(e.weight);
      terms.emplace_back(row, 0, root);
      terms.emplace_back(row, 1, -root * e.log_distance);
      terms.emplace_back(row, e.receiver, root);
      terms.emplace_back(row, e.transmitter, root);
      const SignalRow& r = rows.At(static_cast<std::size_t>(row));
      for (std::size_t k = 0; k < r.size; ++k)
        terms.emplace_back(row, static_cast<int>(system.HeadSize()) + rows.CellsOf(r)[k],
                           -root * rows.LengthsOf(r)[k]);
      ++row;
    }
    const double smooth = std::sqrt(system.SmoothWeight());
    for (std::size_t i = 0; i < rows.Cells().Count(); ++i)
      for (const std::int32_t other : {rows.Cells().Right(i), rows.Cells().Up(i)}) {
        if (other < 0) continue;
        terms.emplace_back(row, static_cast<int>(system.HeadSize() + i), smooth);
        terms.emplace_back(row++, static_cast<int>(system.HeadSize()) + other, -smooth);
      }
    for (std::size_t i = 0; i < system.Size(); ++i)
      terms.emplace_back(row++, static_cast<int>(i), std::sqrt(system.PriorWeight(i)));
    Eigen::SparseMatrix<double> a(row, size);
    a.setFromTriplets(terms.begin(), terms.end());
    const Eigen::SparseMatrix<double> n = Eigen::SparseMatrix<double>(a.transpose()) * a;
    const Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> factor(n);
    const Eigen::VectorXd x =
        factor.solve(Eigen::Map<const Eigen::VectorXd>(system.RightHandSide().data(), size));
    benchmark::DoNotOptimize(x[0]);
  }
}
BENCHMARK(NormalEquations)->Unit(benchmark::kMillisecond);

void TenThousandPredictions(benchmark::State& state) {
  TomographyOptions options;
  Tomography matte(options);
  matte.SetMap(Street());
  matte.AddMeasurements(AnyMeasurements(10000));
  matte.Update(0);
  std::vector<SignalLink> links;
  for (const auto& [a, b] : Rays(10000, 60)) links.push_back({0, 0, 1, a, b});
  std::vector<SignalPrediction> predictions(links.size());
  for (auto _ : state) matte.Predict(links, {predictions.data(), predictions.size()});
}
BENCHMARK(TenThousandPredictions)->Unit(benchmark::kMillisecond);

/// Three robots that explore for half an hour at 1 m/s, 20 measurements a second each way.
std::vector<SignalMeasurement> Mission() {
  const ClassMap map(*Street(), {2, 0, 1});
  RayTracer tracer(&map, 0);
  RandomNumbers random(6);
  Vector3d at[3], goal[3];
  for (int r = 0; r < 3; ++r) {
    at[r] = {80.0 + r, 50, 0};
    goal[r] = AnyPlace(&random);
  }
  std::vector<SignalMeasurement> all;
  for (int step = 0; step < 30 * 60 * 20; ++step) {
    for (int r = 0; r < 3; ++r) {
      if ((goal[r] - at[r]).norm() < 1) goal[r] = AnyPlace(&random);
      at[r] += 0.05 * (goal[r] - at[r]).normalized();
    }
    for (std::uint32_t i = 0; i < 3; ++i)
      for (std::uint32_t j = 0; j < 3; ++j) {
        if (i == j) continue;
        SignalMeasurement m;
        m.link = {0.05 * step, i, j, at[i], at[j]};
        m.dbm = Strength(&tracer, at[i], at[j], &random);
        all.push_back(m);
      }
  }
  return all;
}

/// Learning and predicting all that comes in the next ten steps, scored: what `graticule signal
/// evaluate` does for a method.
void MissionReplayed(benchmark::State& state) {
  SignalLog log;
  log.has_time = true;
  log.measurements = Mission();
  const auto make = [] {
    auto matte = std::make_unique<Tomography>(TomographyOptions::Matte());
    matte->SetMap(Street());
    return matte;
  };
  double cpu_s = 0, wall_s = 0;
  ReplayResult result;
  for (auto _ : state) {
    const Stopwatch clock;
    result = Replay(log, make);
    cpu_s = clock.Elapsed().cpu;
    wall_s = clock.Elapsed().wall;
  }
  state.counters["cpu_s"] = cpu_s;
  state.counters["wall_s"] = wall_s;
  state.counters["predictions"] = static_cast<double>(result.all.count);
  state.counters["rmse_db"] = result.all.rmse;
  state.counters["covered_90"] = result.all.coverage[2];
}
BENCHMARK(MissionReplayed)->Iterations(1)->Unit(benchmark::kMillisecond);

/// Learning in steps of 2 s, with (range 0) or without predicting the ten steps to come each time.
void MissionReplay(benchmark::State& state) {
  const auto mission = Mission();
  const std::size_t step = 240;
  double worst_ms = 0, update_cpu = 0, rows = 0, cells = 0, entries = 0, iterations = 0, sum = 0;
  for (auto _ : state) {
    TomographyOptions options;
    options.samples = static_cast<int>(state.range(1));
    Tomography matte(options);
    matte.SetMap(Street());
    worst_ms = update_cpu = 0;
    iterations = 0;
    std::vector<SignalLink> links;
    std::vector<SignalPrediction> predictions(10 * step);
    for (std::size_t i = 0; i < mission.size(); i += step) {
      // Of the processor: others may be at work on this machine.
      const std::clock_t begin = std::clock();
      matte.AddMeasurements({mission.data() + i, step});
      matte.Update(mission[i].link.time_s);
      const double took_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      worst_ms = std::max(worst_ms, took_ms);
      update_cpu += 1e-3 * took_ms;
      iterations += matte.LastIterations();
      if (state.range(0) == 0) continue;
      links.clear();
      for (std::size_t k = i + step; k < std::min(mission.size(), i + 11 * step); ++k)
        links.push_back(mission[k].link);
      matte.Expect(links);
      matte.Predict(links, {predictions.data(), links.size()});
      if (!links.empty()) sum += predictions[0].dbm;
    }
    rows = static_cast<double>(matte.Rows().Count());
    cells = static_cast<double>(matte.Rows().Cells().Count());
    entries = static_cast<double>(matte.Rows().EntryCount());
    // How far what the updates left undone puts predictions off, in their own deviations.
    links.clear();
    for (const auto& [a, b] : Rays(500, 60)) links.push_back({0, 0, 1, a, b});
    std::vector<SignalPrediction> left(links.size()), done(links.size());
    matte.Predict(links, {left.data(), left.size()});
    TomographyOptions exactly = options;
    exactly.exact_up_to = 3000;
    Tomography whole(exactly);
    whole.SetMap(Street());
    whole.AddMeasurements(mission);
    whole.Update(1800);
    whole.Predict(links, {done.data(), done.size()});
    double off = 0, posterior = 0, online_posterior = 0;
    const double noise = std::pow(whole.SigmaDb(), 2);
    for (std::size_t i = 0; i < links.size(); ++i) {
      off += std::pow(left[i].dbm - done[i].dbm, 2);
      posterior += std::pow(done[i].sigma_db, 2) - noise;
      online_posterior += std::pow(left[i].sigma_db, 2) - std::pow(matte.SigmaDb(), 2);
    }
    state.counters["off_db"] = std::sqrt(off / static_cast<double>(links.size()));
    state.counters["posterior_db"] = std::sqrt(posterior / static_cast<double>(links.size()));
    state.counters["online_posterior_db"] =
        std::sqrt(online_posterior / static_cast<double>(links.size()));
    state.counters["whole_sigma"] = whole.SigmaDb();
    state.counters["whole_correlation"] = whole.Correlation();
    state.counters["sigma"] = matte.SigmaDb();
    state.counters["correlation"] = matte.Correlation();
  }
  benchmark::DoNotOptimize(sum);
  state.counters["updates_s"] = update_cpu;
  state.counters["worst_update_ms"] = worst_ms;
  state.counters["rows"] = rows;
  state.counters["cells"] = cells;
  state.counters["entries"] = entries;
  state.counters["iterations_a_step"] = iterations / (static_cast<double>(mission.size()) / step);
}
BENCHMARK(MissionReplay)
    ->Args({0, 0})
    ->Args({0, 64})
    ->Args({1, 64})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graticule

BENCHMARK_MAIN();
