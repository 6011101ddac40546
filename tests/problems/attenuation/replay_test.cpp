#include "graticule/problems/attenuation/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "graticule/problems/attenuation/tune_method.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

/// Two drives of a robot between three anchors, ten minutes apart.
SignalLog TwoDrives() {
  SignalLog log;
  log.radios = {"robot", "a", "b", "c"};
  const Eigen::Vector3d anchors[] = {{0, 0, 0}, {9, 1, 0}, {4, 8, 0}};
  RandomNumbers random(3);
  for (int i = 0; i < 300; ++i) {
    SignalMeasurement m;
    m.link.time_s = 0.37 * i + (i >= 150 ? 600 : 0);
    m.link.transmitter = 1 + static_cast<std::uint32_t>(i % 3);
    m.link.receiver_m = {5 + 3 * std::cos(0.02 * i), 4 + 3 * std::sin(0.02 * i), 0};
    m.link.transmitter_m = anchors[i % 3];
    m.dbm = -45 - 22 * std::log10((m.link.receiver_m - m.link.transmitter_m).norm()) +
            3 * random.Normal();
    log.measurements.push_back(m);
  }
  return log;
}

TEST(Replay, IsTheDirectLoop) {
  const SignalLog log = TwoDrives();
  const ReplayResult result = Replay(log, [] { return MakePredictor("log-fit"); });
  // Slowly: each step anew from all that was before it.
  double sum[10] = {};
  std::size_t count[10] = {};
  for (const double begin : {0.0, 600 + 0.37 * 150})
    for (int step = 1; step <= 30; ++step) {
      const double now = begin + 2 * step;
      std::vector<SignalMeasurement> past;
      bool is_step = false;
      for (const SignalMeasurement& m : log.measurements)
        if (m.link.time_s < now) {
          past.push_back(m);
          is_step = is_step || m.link.time_s >= now - 2;
        }
      if (!is_step) continue;
      const auto fit = MakePredictor("log-fit");
      fit->AddMeasurements(past);
      fit->Update(now);
      for (const SignalMeasurement& m : log.measurements) {
        if (m.link.time_s < now || m.link.time_s >= now + 20) continue;
        SignalPrediction prediction;
        fit->Predict({&m.link, 1}, {&prediction, 1});
        const auto horizon = static_cast<std::size_t>((m.link.time_s - now) / 2);
        sum[horizon] += std::pow(prediction.dbm - m.dbm, 2);
        ++count[horizon];
      }
    }
  for (std::size_t h = 0; h < 10; ++h) {
    EXPECT_EQ(result.horizons[h].count, count[h]);
    EXPECT_NEAR(result.horizons[h].mse, sum[h] / static_cast<double>(count[h]), 1e-9);
  }
}

TEST(Replay, GivesTheSameDigitsTwiceAndRefusesALogWithoutTime) {
  SignalLog log = TwoDrives();
  const auto make = [] { return MakePredictor("log-fit+gp"); };
  EXPECT_EQ(Replay(log, make).all.mse, Replay(log, make).all.mse);
  log.has_time = false;
  EXPECT_THROW(Replay(log, make), Error);
}

TEST(Replay, CoversWhatItSays) {
  // The model is true here: 300 measurements, each predicted up to ten times, so 3 % are chance.
  const SignalScore all = Replay(TwoDrives(), [] { return MakePredictor("log-fit"); }).all;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(all.coverage[i], kCoverageLevels[i], 0.06);
}

TEST(Replay, ComparesMethodsInPairsAndDrivesAlike) {
  const SignalLog log = TwoDrives();
  const ReplayResult mean = Replay(log, [] { return MakePredictor("mean"); });
  const ReplayResult fit = Replay(log, [] { return MakePredictor("log-fit"); });
  for (const std::size_t h : {0, 5}) {
    const PairedDifference difference = ComparePaired({mean}, {fit}, h, h + 1);
    EXPECT_NEAR(difference.mse, mean.horizons[h].mse - fit.horizons[h].mse, 1e-9);
    EXPECT_GT(difference.standard_error, 0);
    EXPECT_EQ(ComparePaired({fit}, {fit}, h, h + 1).standard_error, 0);
  }
  EXPECT_THROW(ComparePaired({mean}, {fit, fit}, 0, 1), Error);
  ReplayOptions options;
  options.leave_s = 300;  // the whole first drive
  const ReplayResult second = Replay(
      log, [] { return MakePredictor("log-fit"); }, options);
  EXPECT_NEAR(RmseOverDrives(second)[0], second.horizons[0].rmse, 1e-9);
  const double first_count = static_cast<double>(fit.horizons[0].count - second.horizons[0].count);
  const double first =
      std::sqrt((fit.horizons[0].mse * static_cast<double>(fit.horizons[0].count) -
                 second.horizons[0].mse * static_cast<double>(second.horizons[0].count)) /
                first_count);
  EXPECT_NEAR(RmseOverDrives(fit)[0], (first + second.horizons[0].rmse) / 2, 1e-9);
}

TEST(Crps, IsTheIntegralOfSquaredDifferences) {
  const SignalPrediction prediction{-60, 4};
  const double dbm = -57;
  double sum = 0;
  for (double x = -120; x < 0; x += 0.001) {
    const double below = 0.5 * std::erfc(-(x - prediction.dbm) / 4 / std::sqrt(2.0));
    sum += std::pow(below - (x >= dbm ? 1 : 0), 2) * 0.001;
  }
  EXPECT_NEAR(GaussianCrps(prediction, dbm), sum, 1e-3);
}

TEST(HoldOut, NeverTestsWhatItLearnt) {
  const SignalLog log = TwoDrives();
  const HoldOut one = UnseenRadios(log, 0.4, 2, 1);
  std::vector<bool> is_seen(log.radios.size());
  for (const std::uint32_t i : one.train) {
    is_seen[log.measurements[i].link.receiver] = true;
    is_seen[log.measurements[i].link.transmitter] = true;
  }
  for (const std::uint32_t i : one.test)
    EXPECT_FALSE(is_seen[log.measurements[i].link.receiver] &&
                 is_seen[log.measurements[i].link.transmitter]);
  const HoldOut random = RandomLinks(log, 0.5, 1);
  EXPECT_EQ(random.train.size() + random.test.size(), log.measurements.size());
  for (const HoldOut& split : FrontierSweep(log, 4))
    for (const std::uint32_t i : split.test)
      EXPECT_EQ(std::count(split.train.begin(), split.train.end(), i), 0);
}

double Valley(const std::vector<double>& x) {
  return std::pow(x[0] - 1.5, 2) + 10 * std::pow(x[1] + x[0], 2);
}

TEST(CompassSearch, FindsTheBottomWhateverTheThreads) {
  CompassOptions options;
  options.last_step = 1e-4;
  options.max_evaluations = 100000;
  const CompassResult one = CompassSearch(Valley, {0, 0}, options);
  EXPECT_TRUE(one.has_converged);
  EXPECT_NEAR(one.best[0], 1.5, 1e-3);
  EXPECT_NEAR(one.best[1], -1.5, 1e-3);
  options.threads = 3;
  EXPECT_EQ(CompassSearch(Valley, {0, 0}, options).best, one.best);
}

TEST(CompassSearch, GoesOnWhereItWasStopped) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / "compass_state").string();
  std::filesystem::remove(path);
  CompassOptions options;
  options.state_path = path;
  const CompassResult whole = CompassSearch(Valley, {0, 0}, CompassOptions{});
  options.max_evaluations = 7;
  EXPECT_FALSE(CompassSearch(Valley, {0, 0}, options).has_converged);
  options.max_evaluations = 1000;
  const CompassResult rest = CompassSearch(Valley, {0, 0}, options);
  EXPECT_EQ(rest.best, whole.best);
  EXPECT_LT(rest.evaluations, whole.evaluations);
  EXPECT_EQ(CompassSearch(Valley, {0, 0}, options).evaluations, 0u);
  EXPECT_THROW(CompassSearch(Valley, {1, 0}, options), Error) << "another search's";
  std::filesystem::remove(path);
}

TEST(CompassSearch, StoppedAnywhereItEndsAsIfItHadNotBeen) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / "compass_stops").string();
  std::filesystem::remove(path);
  CompassOptions options;
  options.max_evaluations = 40;  // before it has converged
  const CompassResult whole = CompassSearch(Valley, {0, 0}, options);
  EXPECT_FALSE(whole.was_stopped);
  options.state_path = path;
  options.state_of = "valley";
  // Finds so many values, the last of a round first, and is then stopped.
  const auto search = [&](std::size_t values) {
    const CompassEvaluate evaluate = [&](const std::vector<std::vector<double>>& points,
                                         const CompassFound& found) {
      for (std::size_t i = points.size(); i-- > 0 && values > 0; --values)
        found(i, Valley(points[i]));
    };
    return CompassSearch(evaluate, {0, 0}, options);
  };
  const CompassResult none = search(0);
  EXPECT_TRUE(none.was_stopped);
  EXPECT_TRUE(std::isnan(none.value));
  EXPECT_EQ(none.best, (std::vector<double>{0, 0}));
  std::size_t stops = 0;
  CompassResult part = search(1);
  for (; part.was_stopped && stops < 100; ++stops) {
    EXPECT_EQ(part.evaluations, 1u);
    EXPECT_EQ(part.value, Valley(part.best));
    part = search(1);
  }
  EXPECT_EQ(stops + part.evaluations, whole.evaluations);
  EXPECT_EQ(part.best, whole.best);
  EXPECT_EQ(part.value, whole.value);
  options.state_of = "hill";
  EXPECT_THROW(CompassSearch(Valley, {0, 0}, options), Error) << "another function's";
  std::filesystem::remove(path);
}

TEST(CompassSearch, NeverFindsMoreValuesThanItMay) {
  const auto bowl = [](const std::vector<double>& x) {
    double sum = 0;
    for (const double v : x) sum += (v - 3) * (v - 3);
    return sum;
  };
  for (std::size_t most = 1; most < 40; ++most) {
    CompassOptions options;
    options.max_evaluations = most;
    EXPECT_LE(CompassSearch(bowl, {0, 0, 0}, options).evaluations, most);
  }
}

TEST(CompassSearch, StaysWithinItsBounds) {
  CompassOptions options;
  options.lower = {-1, -1};
  options.upper = {1, 1};
  const CompassResult result = CompassSearch(Valley, {0, 0}, options);
  EXPECT_EQ(result.best, (std::vector<double>{1, -1}));
}

TEST(TuneMethod, FindsHowLongResidualsLast) {
  // Each link has an offset for good: what it said last stays true.
  SignalLog log = TwoDrives();
  for (SignalMeasurement& m : log.measurements)
    m.dbm += 10 * (static_cast<double>(m.link.transmitter) - 2);
  MethodOptions start;
  start.persistence_s = 1;
  TuneOptions options;
  options.by = TuneBy::kMse;
  TuneResult result = TuneMethod("persistence", {{log, nullptr}}, start, options);
  EXPECT_GT(result.options.persistence_s, 30);
  EXPECT_LT(result.after, 0.5 * result.before);
  const auto replayed =
      Replay(log, [&] { return MakePredictor("persistence", result.options); }).all;
  EXPECT_EQ(result.after, replayed.mse);
  EXPECT_THROW(TuneMethod("log-fit", {{log, nullptr}}, start, options), Error) << "no parameters";
  EXPECT_THROW(TuneMethod("persistence", {}, start, options), Error);
  options.only = {"magic"};
  EXPECT_THROW(TuneMethod("persistence", {{log, nullptr}}, start, options), Error);
}

TEST(TuneMethod, GoesOnFromASettingThatIsZero) {
  const std::string path = ::testing::TempDir() + "/tune_zero.state";
  std::filesystem::remove(path);
  MethodOptions start;
  start.mrt.lambda = 0;
  TuneOptions options;
  options.only = {"mrt.lambda"};
  options.state_path = path;
  options.max_evaluations = 3;
  const std::vector<TrainingLog> logs = {{TwoDrives(), nullptr}};
  const TuneResult first = TuneMethod("mrt", logs, start, options);
  const TuneResult again = TuneMethod("mrt", logs, start, options);
  EXPECT_EQ(again.search.evaluations, 0u);
  EXPECT_EQ(again.after, first.after);
  EXPECT_TRUE(std::isfinite(again.after));
}

TEST(TuneMethod, RefusesTheStateOfOtherLogs) {
  const std::string path = ::testing::TempDir() + "tune_method.state";
  std::filesystem::remove(path);
  SignalLog log = TwoDrives();
  TuneOptions options;
  options.state_path = path;
  options.max_evaluations = 3;
  const TuneResult first = TuneMethod("persistence", {{log, nullptr}}, {}, options);
  EXPECT_EQ(first.search.evaluations, 3u);
  EXPECT_EQ(TuneMethod("persistence", {{log, nullptr}}, {}, options).search.evaluations, 0u);
  log.measurements.back().dbm += 1;
  EXPECT_THROW(TuneMethod("persistence", {{log, nullptr}}, {}, options), Error);
  std::filesystem::remove(path);
}

TEST(TuneMethod, LetsOthersFindTheScores) {
  const std::vector<TrainingLog> logs = {{TwoDrives(), nullptr}};
  TuneOptions options;
  options.max_evaluations = 8;
  const TuneResult here = TuneMethod("persistence", logs, {}, options);
  std::size_t asked = 0;
  options.evaluate = [&](const std::vector<std::vector<double>>& points,
                         const CompassFound& found) {
    for (std::size_t i = 0; i < points.size(); ++i, ++asked) {
      MethodOptions there;
      here.settings[0]->set(&there, points[i].at(0));
      found(i, TuneScore("persistence", logs, there, options));
    }
  };
  const TuneResult there = TuneMethod("persistence", logs, {}, options);
  EXPECT_EQ(asked, here.search.evaluations);
  EXPECT_EQ(there.search.best, here.search.best);
  EXPECT_EQ(there.after, here.after);
}

TEST(TuneMethod, RefusesALogInWhichNothingIsPredicted) {
  SignalLog log = TwoDrives();
  log.measurements.resize(1);
  EXPECT_THROW(TuneMethod("persistence", {{log, nullptr}}, {}, {}), Error);
}

TEST(SignalSettings, AreWithinTheirBoundsAndUsable) {
  for (const std::string& method : MethodNames())
    for (const SignalSetting* setting : SettingsOf(method)) {
      SCOPED_TRACE(method + " " + setting->name);
      MethodOptions options;
      EXPECT_GE(setting->get(options), setting->lower);
      EXPECT_LE(setting->get(options), setting->upper);
      setting->set(&options, setting->upper);
      EXPECT_NO_THROW(MakePredictor(method, options));
    }
}

}  // namespace
}  // namespace graticule
