#include "graticule/problems/attenuation/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <ctime>

#include "graticule/problems/attenuation/link_index.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/persistence.hpp"
#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "predictions.hpp"

namespace graticule {
namespace {

using test::LinksOf;
using test::Predicted;

/// Links between places in a hall of 20 m, heard once a tenth of a second.
std::vector<SignalMeasurement> Hall(std::size_t count, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<SignalMeasurement> measurements(count);
  for (std::size_t i = 0; i < count; ++i) {
    SignalLink& link = measurements[i].link;
    link.time_s = 0.1 * static_cast<double>(i);
    link.receiver = static_cast<std::uint32_t>(random.Below(3));
    link.transmitter = 3 + static_cast<std::uint32_t>(random.Below(3));
    link.receiver_m = {random.Uniform(0, 20), random.Uniform(0, 20), 0};
    link.transmitter_m = {random.Uniform(0, 20), random.Uniform(0, 20), 0};
    const double distance = (link.receiver_m - link.transmitter_m).norm();
    measurements[i].dbm =
        -40 - 25 * std::log10(distance) + 4 * std::sin(link.receiver_m.x()) + 2 * random.Normal();
  }
  return measurements;
}

/// Of the kernels' matrix for links in a hall of 5 m, where all are within the support.
double SmallestEigenvalue(bool is_pair) {
  auto links = LinksOf(Hall(200, 4));
  for (SignalLink& link : links) {
    link.receiver_m /= 4;
    link.transmitter_m /= 4;
  }
  const PlaceKernel kernel = GaussianProcessOptions::Mrgp().place;
  const auto count = static_cast<Eigen::Index>(links.size());
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      matrix(i, j) = is_pair ? PairSimilarity(kernel, links[i], links[j])
                             : ThesisSimilarity(kernel, links[i], links[j]);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

TEST(PairKernel, IsPositiveDefiniteWhereTheThesisOneIsNot) {
  EXPECT_LT(SmallestEigenvalue(false), -0.5) << "-0.599 was measured";
  EXPECT_GT(SmallestEigenvalue(true), 0) << "0.018 was measured";
}

TEST(PairKernel, DoesNotMindWhoListens) {
  const auto links = LinksOf(Hall(20, 5));
  const PlaceKernel kernel{3, 1, 0, 3};
  for (const SignalLink& a : links)
    for (const SignalLink& b : links) {
      SignalLink turned = b;
      std::swap(turned.receiver_m, turned.transmitter_m);
      EXPECT_DOUBLE_EQ(PairSimilarity(kernel, a, b), PairSimilarity(kernel, a, turned));
      EXPECT_DOUBLE_EQ(ThesisSimilarity(kernel, a, b), ThesisSimilarity(kernel, a, turned));
      EXPECT_DOUBLE_EQ(PairSimilarity(kernel, a, b), PairSimilarity(kernel, b, a));
    }
}

TEST(LogFit, IsTheLeastSquaresLine) {
  const auto measurements = Hall(500, 6);
  LogFit fit;
  fit.AddMeasurements(measurements);
  fit.Update(50);
  // The prior is worth a ten thousandth of a measurement.
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const auto& m : measurements) {
    const Eigen::Vector2d row(1, std::log10((m.link.receiver_m - m.link.transmitter_m).norm()));
    information += row * row.transpose();
    right += row * m.dbm;
  }
  EXPECT_LT((fit.Coefficients() - information.ldlt().solve(right)).norm(), 1e-3);
  double sum = 0;
  const auto predictions = Predicted(fit, LinksOf(measurements));
  for (std::size_t i = 0; i < predictions.size(); ++i)
    sum += std::pow(predictions[i].dbm - measurements[i].dbm, 2);
  EXPECT_NEAR(fit.SigmaDb(), std::sqrt((5 * 25 + sum) / (5 + 498)), 1e-3);
}

/// A dense Gaussian process by the book, on the residuals of a log-fit.
TEST(LogFit, IsNotSureOfAFewThatAreAlike) {
  LogFit fit;
  SignalMeasurement measurement;
  measurement.link.transmitter_m = {5, 0, 0};
  measurement.dbm = -50;
  const std::vector<SignalMeasurement> three(3, measurement);
  fit.AddMeasurements(three);
  fit.Update(0);
  // Five of 5 dB are believed, and one more of none is left over.
  EXPECT_NEAR(fit.SigmaDb(), 5 * std::sqrt(5.0 / 6), 0.05);
}

TEST(GaussianProcess, AgreesWithTheDenseFormulasThroughTheSparseFactor) {
  GaussianProcessOptions options;
  options.place = {3, 1, 6, 3};
  options.sigma_f_db = 4;
  options.sigma_d_db = 2;
  options.learn = false;
  const auto measurements = Hall(150, 7);
  const auto queries = LinksOf(Hall(40, 8));
  GaussianProcess process(options);
  process.AddMeasurements(measurements);
  process.Update(15);
  ASSERT_EQ(process.PointCount(), 150u);
  EXPECT_EQ(process.JitterDb2(), 0);
  LogFit mean;
  mean.AddMeasurements(measurements);
  mean.Update(15);

  const auto links = LinksOf(measurements);
  const auto expected = Predicted(mean, links);
  const auto kernel = [&](const SignalLink& a, const SignalLink& b) {
    return 16 * PairSimilarity(options.place, a, b);
  };
  Eigen::MatrixXd matrix(150, 150);
  Eigen::VectorXd residuals(150);
  for (int i = 0; i < 150; ++i) {
    residuals[i] = measurements[i].dbm - expected[i].dbm;
    for (int j = 0; j < 150; ++j) matrix(i, j) = kernel(links[i], links[j]) + (i == j ? 4 : 0);
  }
  const Eigen::MatrixXd inverse = matrix.inverse();
  const auto found = Predicted(process, queries);
  const auto base = Predicted(mean, queries);
  for (int q = 0; q < 40; ++q) {
    Eigen::VectorXd cross(150);
    for (int i = 0; i < 150; ++i) cross[i] = kernel(links[i], queries[q]);
    EXPECT_NEAR(found[q].dbm, base[q].dbm + cross.dot(inverse * residuals), 1e-8);
    const double variance = kernel(queries[q], queries[q]) - cross.dot(inverse * cross) + 4;
    EXPECT_NEAR(found[q].sigma_db, std::sqrt(variance), 1e-8);
  }
}

TEST(GaussianProcess, KeepsNoMorePointsThanAllowed) {
  GaussianProcess mrgp(GaussianProcessOptions::Mrgp());
  mrgp.AddMeasurements(Hall(2000, 9));
  mrgp.Update(200);
  EXPECT_EQ(mrgp.PointCount(), 100u) << "5 %";
  for (const SignalPrediction& prediction : Predicted(mrgp, LinksOf(Hall(30, 10)))) {
    EXPECT_TRUE(std::isfinite(prediction.dbm));
    EXPECT_GE(prediction.sigma_db, 1.5);
  }
}

TEST(GaussianProcess, LearnsTheNoise) {
  GaussianProcess process({});
  process.AddMeasurements(Hall(600, 11));
  process.Update(60);
  EXPECT_GT(process.Options().sigma_d_db, 1);
  EXPECT_LT(process.Options().sigma_d_db, 4.5);
}

TEST(ResidualGp, IsTheWholeProcessWhereAllPointsAreNear) {
  // With room for every point it is one exact process: the same by dense formulas.
  ResidualGpOptions options;
  options.place.length_m = 1.5;
  options.place_db = 3;
  options.link_db = 2;
  options.link_s = 5;
  options.offset_db = 1;
  options.radio_db = 1.5;
  const double noise = options.noise_db * options.noise_db;
  options.newest = 500;
  options.nearest = 500;
  const auto measurements = Hall(120, 12);
  ResidualGp process(std::make_unique<LogFit>(), options);
  process.AddMeasurements(measurements);
  process.Update(12);
  LogFit mean;
  mean.AddMeasurements(measurements);
  mean.Update(12);
  const auto kernel = [&](const SignalLink& a, const SignalLink& b) {
    const bool same = a.receiver == b.receiver && a.transmitter == b.transmitter;
    const int shared = (a.receiver == b.receiver) + (a.receiver == b.transmitter) +
                       (a.transmitter == b.receiver) + (a.transmitter == b.transmitter);
    return 9 * PairSimilarity(options.place, a, b) + 2.25 * shared +
           (same ? 1 + 4 * std::exp(-std::abs(a.time_s - b.time_s) / 5) : 0);
  };
  const auto links = LinksOf(measurements);
  const auto expected = Predicted(mean, links);
  Eigen::MatrixXd matrix(120, 120);
  Eigen::VectorXd residuals(120);
  for (int i = 0; i < 120; ++i) {
    residuals[i] = measurements[i].dbm - expected[i].dbm;
    for (int j = 0; j < 120; ++j) matrix(i, j) = kernel(links[i], links[j]) + (i == j ? noise : 0);
  }
  auto queries = LinksOf(Hall(30, 13));
  for (SignalLink& link : queries) link.time_s += 12;
  const auto found = Predicted(process, queries);
  const auto base = Predicted(mean, queries);
  const Eigen::MatrixXd inverse = matrix.inverse();
  for (int q = 0; q < 30; ++q) {
    Eigen::VectorXd cross(120);
    for (int i = 0; i < 120; ++i) cross[i] = kernel(links[i], queries[q]);
    EXPECT_NEAR(found[q].dbm, base[q].dbm + cross.dot(inverse * residuals), 1e-8);
    const double variance = kernel(queries[q], queries[q]) - cross.dot(inverse * cross) + noise;
    EXPECT_NEAR(found[q].sigma_db, std::sqrt(variance), 1e-8);
  }
}

TEST(ResidualGp, MergesWhatALinkSaysFromOnePlace) {
  // Two measurements from one place at one time are one of half the noise's variance: the same.
  ResidualGpOptions options;
  options.merge_m = 0;
  const auto make = [&](double merge_s) {
    options.merge_s = merge_s;
    return ResidualGp(std::make_unique<LogFit>(), options);
  };
  ResidualGp merged = make(2), each = make(0);
  auto measurements = Hall(30, 16);
  for (std::size_t i = 0; i + 1 < measurements.size(); i += 2) {
    measurements[i + 1].link = measurements[i].link;
    // Apart in time by nothing that the process would tell, but more than merge_s.
    measurements[i + 1].link.time_s += 1e-9;
  }
  for (ResidualGp* process : {&merged, &each}) {
    process->AddMeasurements(measurements);
    process->Update(12);
  }
  EXPECT_EQ(merged.PointCount(), 15u);
  EXPECT_EQ(each.PointCount(), 30u);
  const auto queries = LinksOf(Hall(20, 17));
  const auto some = Predicted(merged, queries), all = Predicted(each, queries);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    EXPECT_NEAR(some[q].dbm, all[q].dbm, 1e-6);
    EXPECT_NEAR(some[q].sigma_db, all[q].sigma_db, 1e-6);
  }
}

TEST(ResidualGp, LearnsOfANewLinkFromTheRadiosItShares) {
  // Radio 0 hears 8 dB less than all others; a link of it that nobody measured, far away.
  ResidualGpOptions options;
  options.radio_db = 4;
  ResidualGp process(std::make_unique<LogFit>(), options);
  auto measurements = Hall(400, 18);
  for (SignalMeasurement& m : measurements) m.dbm -= m.link.receiver == 0 ? 8 : 0;
  process.AddMeasurements(measurements);
  process.Update(40);
  SignalLink near = measurements[0].link, deaf = near;
  near.receiver = 1;
  deaf.receiver = 0;
  near.transmitter = deaf.transmitter = 9;
  const auto found = Predicted(process, {near, deaf});
  EXPECT_NEAR(found[0].dbm - found[1].dbm, 8, 2);
}

TEST(LinkIndex, FindsWhatLookingAtAllFinds) {
  const auto links = LinksOf(Hall(400, 19));
  auto queries = LinksOf(Hall(40, 20));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    if (q % 2 == 0) std::swap(queries[q].receiver_m, queries[q].transmitter_m);
    if (q % 5 == 0) queries[q].receiver_m.x() += 1e6;
    if (q % 7 == 0) queries[q].transmitter_m.y() = -1e300;
  }
  for (const double cell_m : {0.3, 3.0, 100.0}) {
    LinkIndex index(cell_m);
    for (std::size_t i = 0; i < links.size(); ++i)
      index.Add(static_cast<std::uint32_t>(i), links[i]);
    for (const SignalLink& query : queries)
      for (const std::size_t count : {1, 7, 1000}) {
        std::vector<std::pair<double, std::uint32_t>> slow, quick;
        for (std::uint32_t i = 0; i < links.size(); ++i)
          if (i % 3 != 0) slow.emplace_back(LinkDistance(links[i], query), i);
        std::sort(slow.begin(), slow.end());
        slow.resize(std::min(slow.size(), count));
        index.Nearest(
            query, count, [&](std::uint32_t i) -> const SignalLink& { return links[i]; },
            [](std::uint32_t i) { return i % 3 != 0; }, &quick);
        std::sort(quick.begin(), quick.end());
        EXPECT_EQ(quick, slow);
      }
  }
}

TEST(LinkIndex, FindsTheNearestOfManyCellsFromFarOff) {
  // Rings around the query as long as one of them is smaller than all cells would be 10^9 cells, a
  // minute and more; all cells once are a hundredth of a second.
  std::vector<SignalLink> links(200000);
  LinkIndex index(1);
  for (std::size_t i = 0; i < links.size(); ++i) {
    links[i].receiver_m = links[i].transmitter_m = {static_cast<double>(i), 0, 0};
    index.Add(static_cast<std::uint32_t>(i), links[i]);
  }
  SignalLink query;
  query.receiver_m = query.transmitter_m = {0, 1e6, 0};
  std::vector<std::pair<double, std::uint32_t>> nearest;
  const std::clock_t begin = std::clock();
  index.Nearest(
      query, 1, [&](std::uint32_t i) -> const SignalLink& { return links[i]; },
      [](std::uint32_t) { return true; }, &nearest);
  EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 5);
  ASSERT_EQ(nearest.size(), 1u);
  EXPECT_EQ(nearest[0].second, 0u);
}

TEST(Persistence, FadesFromTheLastResidualsToTheLogFit) {
  const auto measurements = Hall(300, 14);
  Persistence persistence(30);
  LogFit mean;
  for (SignalPredictor* predictor :
       {static_cast<SignalPredictor*>(&persistence), static_cast<SignalPredictor*>(&mean)}) {
    predictor->AddMeasurements(measurements);
    predictor->Update(30);
  }
  SignalLink soon = measurements.back().link, late = soon;
  late.time_s += 3000;
  const auto kept = Predicted(persistence, {soon, late});
  const auto base = Predicted(mean, {soon, late});
  EXPECT_NE(kept[0].dbm, base[0].dbm);
  EXPECT_NEAR(kept[1].dbm, base[1].dbm, 1e-9);
  EXPECT_NEAR(kept[1].sigma_db, base[1].sigma_db, 1e-9);
}

TEST(Methods, AreMadeByNameAndPredictBeforeAndAfterMeasuring) {
  const auto measurements = Hall(80, 15);
  auto map = std::make_shared<OccupancyGrid>();
  map->resolution = 0.5;
  map->width = map->height = 50;
  map->cells.assign(2500, Occupancy::kFree);
  for (const std::string& name : MethodNames()) {
    SCOPED_TRACE(name);
    const auto predictor = MakePredictor(name);
    EXPECT_EQ(predictor->Name(), name);
    predictor->SetMap(map);
    for (int round = 0; round < 2; ++round) {
      for (const SignalPrediction& prediction : Predicted(*predictor, LinksOf(measurements))) {
        EXPECT_TRUE(std::isfinite(prediction.dbm));
        EXPECT_GT(prediction.sigma_db, 0);
      }
      predictor->AddMeasurements(measurements);
      predictor->Update(8);
    }
  }
  EXPECT_THROW(MakePredictor("magic"), Error);
  EXPECT_THROW(MakePredictor("+gp"), Error);
}

}  // namespace
}  // namespace graticule
