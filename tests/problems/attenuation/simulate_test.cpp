// Simulated signals: their statistics are those that they were asked to have, and the truth that
// comes with them is the truth.

#include "graticule/problems/attenuation/simulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

FloorPlan Empty(double side_m) {
  FloorPlan plan;
  plan.width = plan.height = static_cast<std::size_t>(side_m / plan.resolution);
  plan.cells.assign(plan.width * plan.height, Filling::kAir);
  return plan;
}

SignalMissionOptions Small() {
  SignalMissionOptions options;
  options.place = PlaceByName("room");
  options.place.duration_s = 20;
  options.rate_hz = 5;
  return options;
}

TEST(SimulateMaterials, AttenuateAsTheTableOfItuSays) {
  // P.2040-1: concrete at 2.4 GHz has a conductivity of 0.0326 * 2.4^0.8095 S/m.
  const ItuMaterial concrete{5.31, 0.0326, 0.8095};
  EXPECT_NEAR(concrete.Conductivity(2.4), 0.0662, 1e-4);
  EXPECT_NEAR(concrete.AttenuationDbPerM(2.4), 47.0, 0.1);
  EXPECT_NEAR(concrete.FaceLossDb(), 0.735, 0.01);
  for (const Filling wall : {Filling::kPartition, Filling::kBlockWall, Filling::kBrickWall,
                             Filling::kConcreteWall, Filling::kGlassWall}) {
    const double loss = LossOf(wall).db_per_m * DrawnThickness(wall);
    EXPECT_GT(loss, 1.5) << LossOf(wall).name;
    EXPECT_LT(loss, 12) << LossOf(wall).name;
  }
}

TEST(SimulateRadio, FallsWithTheExponentAndScattersWithTheShadowing) {
  RadioOptions radio;
  radio.shadowing_db = 5;
  // Several worlds: within one, all links share one field.
  double squares = 0, sum = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RadioWorld world(Empty(60), radio, seed);
    RandomNumbers random(seed, 9);
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector3d a(random.Uniform(1, 59), random.Uniform(1, 59), 0);
      const Eigen::Vector3d b(random.Uniform(1, 59), random.Uniform(1, 59), 0);
      if ((a - b).norm() < 20) continue;
      const double expected =
          radio.l0_dbm - 10 * FloorPlan::kIndoorExponent * std::log10((a - b).norm());
      const double shadow = world.MeanDbm(a, b, 0) - expected;
      EXPECT_NEAR(world.MeanDbm(b, a, 0) - expected, shadow, 1e-3);  // reciprocal
      sum += shadow;
      squares += shadow * shadow;
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 0, 0.5);
  // Fields longer than the link do not average out over it: the deviation is a little below.
  EXPECT_NEAR(std::sqrt(squares / count), 4.8, 0.5);
}

TEST(SimulateRadio, ShadowsOfLinksThatShareAnEndCorrelateAsMeasured) {
  // The curve of docs/signal_simulation.md.
  const double apart[] = {0.6, 1.25, 3, 10}, measured[] = {0.67, 0.48, 0.32, 0.21};
  double products[4] = {}, squares[4] = {};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const ShadowField field(60, 60, 5, seed);
    RandomNumbers random(seed, 9);
    for (int i = 0; i < 1500; ++i) {
      const Eigen::Vector2d end(random.Uniform(5, 55), random.Uniform(5, 55));
      const double angle = random.Uniform(0, 2 * M_PI), range = random.Uniform(12, 30);
      const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
      const Eigen::Vector2d a = end + range * along;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d b = a + apart[k] * across;
        if (a.minCoeff() < 0 || b.minCoeff() < 0 || a.maxCoeff() > 60 || b.maxCoeff() > 60)
          continue;
        const double first = field.LossDb(end, a), second = field.LossDb(end, b);
        products[k] += first * second;
        squares[k] += 0.5 * (first * first + second * second);
      }
    }
  }
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(products[k] / squares[k], measured[k], 0.1) << apart[k] << " m";
}

TEST(SimulateRadio, FadesLessInSightThanBehindWallsAndForgetsItInCentimetres) {
  const RadioOptions radio;
  double deviation[2];
  for (const bool is_hidden : {false, true}) {
    RandomNumbers random(1);
    LinkFading fading(radio, &random);
    std::vector<double> values;
    for (int i = 0; i < 40000; ++i) values.push_back(fading.Next(0.015, 0, is_hidden ? 20 : 0));
    double sum = 0, squares = 0, near = 0, far = 0;
    for (const double value : values) sum += value;
    const double mean = sum / static_cast<double>(values.size());
    for (std::size_t i = 0; i + 10 < values.size(); ++i) {
      squares += (values[i] - mean) * (values[i] - mean);
      near += (values[i] - mean) * (values[i + 1] - mean);
      far += (values[i] - mean) * (values[i + 10] - mean);
    }
    deviation[is_hidden] = std::sqrt(squares / static_cast<double>(values.size()));
    if (is_hidden) {
      EXPECT_NEAR(near / squares, 0.5, 0.07);  // at 1.5 cm
    }
    EXPECT_NEAR(far / squares, 0, 0.07);  // at 15 cm
  }
  EXPECT_NEAR(deviation[1], 2.73, 0.15);  // of Gamma(3) in dB
  EXPECT_LT(deviation[0], deviation[1]);
}

TEST(SimulateSignal, GivesTheSameDigitsForTheSameSeed) {
  const SimulatedSignal one = SimulateSignal(Small()), two = SimulateSignal(Small());
  ASSERT_EQ(FormatSignalLog(one.log), FormatSignalLog(two.log));
  EXPECT_EQ(one.map->cells, two.map->cells);
  SignalMissionOptions other = Small();
  other.seed = 2;
  EXPECT_NE(FormatSignalLog(SimulateSignal(other).log), FormatSignalLog(one.log));
}

TEST(SimulateSignal, HearsBothWaysAlikeAndNothingBelowTheFloor) {
  SignalMissionOptions options = Small();
  options.place = PlaceByName("office");
  options.place.duration_s = 60;
  options.radio.floor_dbm = -70;
  const SimulatedSignal simulated = SimulateSignal(options);
  ASSERT_EQ(simulated.log.measurements.size(), 60u * 5 * 6);
  double squares = 0, count = 0;
  std::size_t not_heard = 0;
  for (std::size_t i = 0; i + 1 < simulated.log.measurements.size(); i += 2) {
    const SignalMeasurement& there = simulated.log.measurements[i];
    const SignalMeasurement& back = simulated.log.measurements[i + 1];
    EXPECT_EQ(there.link.receiver, back.link.transmitter);
    if (!there.is_heard) {
      EXPECT_EQ(there.dbm, -70);
      ++not_heard;
    }
    if (!there.is_heard || !back.is_heard) continue;
    EXPECT_GE(there.dbm, -70);
    EXPECT_EQ(there.dbm, std::round(there.dbm));
    squares += (there.dbm - back.dbm) * (there.dbm - back.dbm);
    ++count;
  }
  EXPECT_GT(not_heard, 0u);
  EXPECT_LT(std::sqrt(squares / count), 2.0);
  // What robots measured from is free in the map that they drew.
  for (const SignalMeasurement& measurement : simulated.log.measurements) {
    const Eigen::Vector3d& at = measurement.link.receiver_m;
    EXPECT_NE(simulated.map->At(static_cast<std::size_t>(at.x() / 0.1),
                                static_cast<std::size_t>(at.y() / 0.1)),
              Occupancy::kStructure);
  }
}

TEST(SimulateSignal, MapsGrowAndAgreeWithThePlan) {
  SignalMissionOptions options = Small();
  options.place = PlaceByName("house");
  options.place.duration_s = 60;
  options.map_every_s = 10;
  const SimulatedSignal simulated = SimulateSignal(options);
  ASSERT_GE(simulated.maps.size(), 5u);
  const OccupancyGrid truth = simulated.plan.Occupied();
  std::size_t known_before = 0;
  for (const TimedMap& map : simulated.maps) {
    std::size_t known = 0;
    for (std::size_t i = 0; i < truth.cells.size(); ++i) {
      if (map.map->cells[i] == Occupancy::kUnknown) continue;
      ++known;
      ASSERT_EQ(map.map->cells[i], truth.cells[i]);
    }
    EXPECT_GE(known, known_before);
    known_before = known;
  }
  for (const TrueAttenuation& cell : TrueAttenuations(simulated.plan, *simulated.map, 4)) {
    if (cell.what == Occupancy::kFree) {
      EXPECT_LE(cell.db_per_m, 0.1);
    }
    if (cell.what == Occupancy::kStructure) {
      EXPECT_GT(cell.db_per_m, 1);
    }
  }
}

TEST(SimulatePlaces, AllCanBeDrawnAndDrivenThrough) {
  for (const PlaceOptions& place : KnownPlaces()) {
    const FloorPlan plan = MakeFloorPlan(place);
    std::size_t structure = 0;
    for (const Filling filling : plan.cells) structure += LossOf(filling).is_structure;
    const double share = static_cast<double>(structure) / static_cast<double>(plan.cells.size());
    EXPECT_GT(share, 0.02) << place.name;
    EXPECT_LT(share, 0.4) << place.name;
  }
  EXPECT_THROW(PlaceByName("moon"), Error);
}

}  // namespace
}  // namespace graticule
