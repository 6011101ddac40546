#include "graticule/problems/attenuation/tomography.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/problems/attenuation/tomography_graph.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"
#include "predictions.hpp"

namespace graticule {
namespace {

using test::LinksOf;
using test::Predicted;

using Eigen::Vector3d;

/// A room of 40 x 24 m, free, with a wall of half a metre across it at x = 20.
std::shared_ptr<const OccupancyGrid> Room() {
  auto grid = std::make_shared<OccupancyGrid>();
  grid->width = 400;
  grid->height = 240;
  grid->cells.assign(grid->width * grid->height, Occupancy::kFree);
  for (std::size_t y = 0; y < grid->height; ++y)
    for (std::size_t x = 200; x < 205; ++x)
      grid->cells[y * grid->width + x] = Occupancy::kStructure;
  return grid;
}

struct Truth {
  double l0_dbm = -38, slope_db = 22, free_db_per_m = 0.1, wall_db_per_m = 12;
  double bias_db[3] = {1.5, -2, 0.5};
  double sigma_db = 3;
};

/// Three radios anywhere in the room.
std::vector<SignalMeasurement> Measured(const Truth& truth, std::size_t count, std::uint64_t seed) {
  const ClassMap map(*Room(), {2, 0, 1});
  RayTracer tracer(&map, 0);
  RandomNumbers random(seed);
  std::vector<SignalMeasurement> measurements(count);
  for (std::size_t i = 0; i < count; ++i) {
    SignalMeasurement& m = measurements[i];
    m.link.time_s = 0.1 * static_cast<double>(i);
    m.link.receiver = static_cast<std::uint32_t>(random.Below(3));
    m.link.transmitter = (m.link.receiver + 1 + static_cast<std::uint32_t>(random.Below(2))) % 3;
    for (Vector3d* end : {&m.link.receiver_m, &m.link.transmitter_m})
      *end = {random.Uniform(0.5, 39.5), random.Uniform(0.5, 23.5), 0};
    m.dbm = truth.l0_dbm + truth.bias_db[m.link.receiver] + truth.bias_db[m.link.transmitter] -
            truth.slope_db *
                std::log10(std::max(0.1, (m.link.receiver_m - m.link.transmitter_m).norm())) +
            truth.sigma_db * random.Normal();
    for (const RayPiece& piece : tracer.Trace(m.link.receiver_m, m.link.transmitter_m))
      m.dbm -= piece.length_m * (piece.material == 1 ? truth.wall_db_per_m : truth.free_db_per_m);
  }
  return measurements;
}

TEST(Tomography, FindsAWall) {
  Truth truth;
  truth.sigma_db = 1;
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  matte.AddMeasurements(Measured(truth, 4000, 1));
  matte.Update(400);
  EXPECT_NEAR(matte.SigmaDb(), 1, 0.05);
  EXPECT_NEAR(matte.AttenuationAt(1, 20.2, 12), truth.wall_db_per_m, 1.0);
  EXPECT_NEAR(matte.AttenuationAt(0, 10, 12), truth.free_db_per_m, 0.2);
}

TEST(Tomography, PredictsBeforeTheFirstMeasurement) {
  const Tomography matte(TomographyOptions::Matte());
  const auto p = Predicted(matte, LinksOf(Measured({}, 20, 1)));
  for (const SignalPrediction& prediction : p) {
    EXPECT_TRUE(std::isfinite(prediction.dbm));
    EXPECT_GT(prediction.sigma_db, 20);
  }
}

TEST(Tomography, CoversWhatItPredictsAsOftenAsItSays) {
  for (const TomographyOptions& options :
       {TomographyOptions::Matte(), TomographyOptions::OneAttenuationPerClass()}) {
    Tomography predictor(options);
    predictor.SetMap(Room());
    predictor.AddMeasurements(Measured({}, 1500, 2));
    predictor.Update(150);
    const auto test = Measured({}, 4000, 3);
    const auto p = Predicted(predictor, LinksOf(test));
    int covered = 0;
    for (std::size_t i = 0; i < test.size(); ++i)
      covered += std::abs(test[i].dbm - p[i].dbm) < 1.96 * p[i].sigma_db;
    EXPECT_GE(covered, 4000 * .92) << predictor.Name();
    EXPECT_LE(covered, 4000 * .98) << predictor.Name();
  }
}

TEST(Tomography, LearnsInStepsWhatItLearnsAtOnce) {
  TomographyOptions options;
  options.estimate_sigma = false;
  options.correlation = 0.1;
  options.tolerance = 1e-8;
  options.update_iterations = 1000;
  const auto measurements = Measured({}, 1200, 4);
  Tomography whole(options), steps(options);
  whole.SetMap(Room());
  steps.SetMap(Room());
  whole.AddMeasurements(measurements);
  whole.Update(120);
  for (std::size_t i = 0; i < 1200; i += 40) {
    steps.AddMeasurements({measurements.data() + i, 40});
    steps.Update(0.1 * static_cast<double>(i));
  }
  const auto links = LinksOf(Measured({}, 500, 5));
  const auto a = Predicted(whole, links), b = Predicted(steps, links);
  for (std::size_t i = 0; i < links.size(); ++i) EXPECT_NEAR(a[i].dbm, b[i].dbm, 1e-6);
}

// Each step brings a few of the samples a little further; none may be left behind.  The tolerance
// is that of 64 samples, whose deviations are good to a tenth, over links that are all different.
TEST(Tomography, IsAsSureInStepsAsExactly) {
  TomographyOptions options;
  options.cell_m = 1.5;
  TomographyOptions exactly = options;
  exactly.exact_up_to = 4000;
  Tomography whole(exactly), steps(options);
  const auto measurements = Measured({}, 6000, 4);
  whole.SetMap(Room());
  steps.SetMap(Room());
  whole.AddMeasurements(measurements);
  whole.Update(600);
  ASSERT_GT(whole.Rows().Cells().Count(), 256u) << "else no samples are drawn";
  for (std::size_t i = 0; i < measurements.size(); i += 40) {
    steps.AddMeasurements({measurements.data() + i, 40});
    steps.Update(0.1 * static_cast<double>(i));
  }
  const auto links = LinksOf(Measured({}, 500, 5));
  const auto a = Predicted(whole, links), b = Predicted(steps, links);
  double exact = 0, online = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    exact += std::pow(a[i].sigma_db, 2) - std::pow(whole.SigmaDb(), 2);
    online += std::pow(b[i].sigma_db, 2) - std::pow(steps.SigmaDb(), 2);
  }
  EXPECT_NEAR(std::sqrt(online / exact), 1, 0.07);
}

TEST(Tomography, PredictsWhatItExpectsToTheSameDigits) {
  for (const RadioBias bias : {RadioBias::kNone, RadioBias::kRadio, RadioBias::kEnds}) {
    TomographyOptions options;
    options.bias = bias;
    Tomography expecting(options), other(options);
    auto links = LinksOf(Measured({}, 300, 5));
    for (std::size_t i = 0; i < 100; ++i) {  // the other way, some of them next to each other
      links.push_back(links[3 * i]);
      std::swap(links.back().receiver, links.back().transmitter);
      std::swap(links.back().receiver_m, links.back().transmitter_m);
    }
    for (Tomography* matte : {&expecting, &other}) {
      matte->SetMap(Room());
      matte->AddMeasurements(Measured({}, 500, 1));
      matte->Update(50);
    }
    const auto expect_same = [&](const std::vector<SignalLink>& asked) {
      const auto a = Predicted(expecting, asked), b = Predicted(other, asked);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        EXPECT_EQ(a[i].dbm, b[i].dbm);
        EXPECT_EQ(a[i].sigma_db, b[i].sigma_db);
      }
    };
    expecting.Expect(links);
    expect_same(links);
    // A window that moves on, links in another order, and a map that takes all paths away.
    const std::vector<SignalLink> later(links.begin() + 200, links.end());
    expecting.Expect(later);
    expect_same(later);
    expect_same({links.rbegin(), links.rend()});
    auto empty = std::make_shared<OccupancyGrid>(*Room());
    empty->cells.assign(empty->cells.size(), Occupancy::kFree);
    expecting.SetMap(empty);
    other.SetMap(empty);
    expect_same(later);
  }
}

TEST(Tomography, ExpectsNoLinkThatItWouldRefuse) {
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  auto links = LinksOf(Measured({}, 3, 5));
  links[1].receiver_m.x() = 400;
  EXPECT_THROW(matte.Expect(links), Error);
  links[1].receiver_m.x() = 4;
  matte.Expect(links);
  EXPECT_EQ(Predicted(matte, links).size(), 3u);
}

void ExpectAsSolved(TomographyOptions options, const std::vector<SignalMeasurement>& measurements) {
  options.estimate_sigma = false;
  options.correlation = 0.2;
  options.tolerance = 1e-9;
  Tomography online(options);
  online.SetMap(Room());
  online.AddMeasurements(measurements);
  online.Update(measurements.back().link.time_s);
  const auto map = std::make_shared<const ClassMap>(*Room(), options.class_of);
  const TomographyGraph built = BuildTomography(measurements, map, options);
  SolveOptions solve = TomographySolving();
  solve.engine = Engine::kCeres;
  const Solution solution = Solve(built.graph, solve);
  const bool is_linear = std::all_of(measurements.begin(), measurements.end(),
                                     [](const SignalMeasurement& m) { return m.is_heard; });
  if (is_linear && options.loss.kind == LossKind::kNone) {
    EXPECT_EQ(solution.report.iterations.size(), 2u) << "the start, and one step";
  }
  const TomographyEstimate estimate = ReadBackTomography(built.layout, solution.values);
  EXPECT_NEAR(online.L0Dbm(), estimate.l0_dbm, 1e-6);
  EXPECT_NEAR(online.SlopeDb(), estimate.slope_db, 1e-6);
  for (std::uint32_t r = 0; r < 3 && options.bias != RadioBias::kNone; ++r) {
    EXPECT_NEAR(online.ReceiverBiasDb(r), estimate.receiver_bias_db[r], 1e-6);
    EXPECT_NEAR(online.TransmitterBiasDb(r), estimate.transmitter_bias_db[r], 1e-6);
  }
  ASSERT_EQ(online.Cells().size(), built.layout.cells.size());
  const double cell_m = options.cell_m;
  for (std::size_t i = 0; i < built.layout.cells.size(); ++i) {
    const AttenuationCell& cell = built.layout.cells[i];
    EXPECT_NEAR(online.AttenuationAt(cell.material, (cell.x + .5) * cell_m, (cell.y + .5) * cell_m),
                estimate.db_per_m[i], 1e-6);
  }
}

TEST(Tomography, AgreesWithItsGraphSolvedByCeres) {
  auto measurements = Measured({}, 1200, 8);
  for (RadioBias bias : {RadioBias::kNone, RadioBias::kRadio, RadioBias::kEnds}) {
    TomographyOptions options;
    options.bias = bias;
    ExpectAsSolved(options, measurements);
  }
  ExpectAsSolved(TomographyOptions::Mrt(), measurements);
  ExpectAsSolved(TomographyOptions::OneAttenuationPerClass(), measurements);
  TomographyOptions plain = TomographyOptions::LogFit();
  plain.bias = RadioBias::kNone;
  ExpectAsSolved(plain, measurements);
}

// What is below -75 dBm is not heard.
TEST(Tomography, AgreesWithCeresOnPacketsNotHeard) {
  auto measurements = Measured({}, 1200, 8);
  for (SignalMeasurement& m : measurements) {
    m.is_heard = m.dbm > -75;
    m.dbm = std::max(m.dbm, -75.0);
  }
  ExpectAsSolved({}, measurements);
}

TEST(Tomography, AgreesWithCeresUnderALoss) {
  auto measurements = Measured({}, 1200, 8);
  for (std::size_t i = 0; i < measurements.size(); i += 20) measurements[i].dbm -= 30;
  TomographyOptions options;
  options.loss = {LossKind::kHuber, 1.345};
  ExpectAsSolved(options, measurements);
}

// What was cut off at the floor is not what the strength was.
TEST(Tomography, LearnsFromPacketsNotHeardWhereTheFloorMisleads) {
  const Truth truth;
  auto measurements = Measured(truth, 3000, 9);
  TomographyOptions options = TomographyOptions::OneAttenuationPerClass();
  Tomography deaf(options), wise(options);
  for (SignalMeasurement& m : measurements) {
    m.is_heard = m.dbm > -72;
    m.dbm = std::max(m.dbm, -72.0);
  }
  wise.SetMap(Room());
  wise.AddMeasurements(measurements);
  wise.Update(300);
  deaf.SetMap(Room());
  for (const SignalMeasurement& m : measurements)
    if (m.is_heard) deaf.AddMeasurements({&m, 1});
  deaf.Update(300);
  EXPECT_NEAR(wise.SlopeDb(), truth.slope_db, 1.5);
  EXPECT_LT(std::abs(wise.SlopeDb() - truth.slope_db), std::abs(deaf.SlopeDb() - truth.slope_db));
}

TEST(Tomography, KeepsWhatItLearntThroughAnotherMap) {
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  matte.AddMeasurements(Measured({}, 2000, 1));
  matte.Update(200);
  const double wall = matte.AttenuationAt(1, 20.2, 12);
  const auto room = Room();
  auto finer = std::make_shared<OccupancyGrid>(*room);  // of half the resolution's cells
  finer->resolution = 0.05;
  finer->width = 800;
  finer->height = 480;
  finer->cells.assign(finer->width * finer->height, Occupancy::kFree);
  for (std::size_t y = 0; y < 480; ++y)
    for (std::size_t x = 0; x < 800; ++x) finer->cells[y * 800 + x] = room->At(x / 2, y / 2);
  const auto links = LinksOf(Measured({}, 100, 5));
  const auto before = Predicted(matte, links);
  matte.SetMap(finer);
  const auto after = Predicted(matte, links);
  for (std::size_t i = 0; i < links.size(); ++i) EXPECT_NEAR(before[i].dbm, after[i].dbm, 1e-9);
  matte.Update(200);
  EXPECT_NEAR(matte.AttenuationAt(1, 20.2, 12), wall, 0.05);
}

TEST(Tomography, HasTheSameDigitsTwice) {
  const auto links = LinksOf(Measured({}, 200, 5));
  std::vector<SignalPrediction> first;
  for (int run = 0; run < 2; ++run) {
    Tomography matte(TomographyOptions::Matte());
    matte.SetMap(Room());
    matte.AddMeasurements(Measured({}, 800, 6));
    matte.Update(80);
    const auto p = Predicted(matte, links);
    if (run == 0) first = p;
    for (std::size_t i = 0; i < links.size(); ++i) {
      EXPECT_EQ(p[i].dbm, first[i].dbm);
      EXPECT_EQ(p[i].sigma_db, first[i].sigma_db);
    }
  }
}

TEST(Tomography, RefusesWhatIsNotAMeasurement) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  const auto good = Measured({}, 1, 1)[0];
  const auto expect_refused = [&](auto change) {
    SignalMeasurement bad = good;
    change(&bad);
    const SignalMeasurement both[] = {good, bad};
    EXPECT_THROW(matte.AddMeasurements({both, 2}), Error);
    EXPECT_EQ(matte.Rows().MeasurementCount(), 0);
  };
  expect_refused([&](auto* m) { m->dbm = nan; });
  expect_refused([&](auto* m) { m->dbm = 40; });
  expect_refused([&](auto* m) { m->link.time_s = nan; });
  expect_refused([&](auto* m) { m->link.receiver_m.x() = infinity; });
  expect_refused([&](auto* m) { m->link.transmitter_m.y() = 60; });
  expect_refused([&](auto* m) { m->link.transmitter = m->link.receiver; });
}

TEST(Tomography, RefusesCellsThatAreNoCells) {
  TomographyOptions options;
  options.cell_m = 1e-9;
  try {
    options.Check();
    FAIL() << "a cell of a nanometre";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cell_m"), std::string::npos) << error.what();
  }
}

TEST(Tomography, SaysWhatStandingStillDoesNotDetermine) {
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  std::vector<SignalMeasurement> measurements(400, Measured({}, 1, 1)[0]);
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    measurements[i].link.time_s = 0.05 * static_cast<double>(i);
    measurements[i].link.receiver_m = {5, 5, 0};
    measurements[i].link.transmitter_m = {15, 5, 0};
    measurements[i].dbm = i % 2 ? -60 : -61;
  }
  matte.AddMeasurements(measurements);
  matte.Update(20);
  const auto p = Predicted(matte, {measurements[0].link});
  EXPECT_NEAR(p[0].dbm, -60.5, 1);
  std::string said;
  for (const std::string& line : matte.NotDetermined()) said += line + "\n";
  EXPECT_NE(said.find("slope"), std::string::npos) << said;
  EXPECT_NE(said.find("class structure: no ray"), std::string::npos) << said;
}

TEST(Tomography, TakesEndsAtOnePlace) {
  Tomography matte(TomographyOptions::Matte());
  matte.SetMap(Room());
  auto m = Measured({}, 50, 1);
  m[7].link.receiver_m = m[7].link.transmitter_m;
  matte.AddMeasurements(m);
  matte.Update(5);
  EXPECT_TRUE(std::isfinite(Predicted(matte, {m[7].link})[0].dbm));
}

}  // namespace
}  // namespace graticule
