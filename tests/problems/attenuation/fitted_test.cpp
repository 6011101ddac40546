// A model that was written down predicts as the one that learnt it, and plans are made of it.

#include "graticule/problems/attenuation/fitted.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "graticule/problems/attenuation/plan.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/attenuation/simulate.hpp"
#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/solve.hpp"
#include "predictions.hpp"

namespace graticule {
namespace {

const SimulatedSignal& House() {
  static const SimulatedSignal simulated = [] {
    SignalMissionOptions options;
    options.place = PlaceByName("house");
    options.place.duration_s = 90;
    options.rate_hz = 2;
    options.radio.floor_dbm = -60;  // some are not heard
    return SimulateSignal(options);
  }();
  return simulated;
}

std::unique_ptr<FittedTomography> Fit(const TomographyOptions& options) {
  FittedGraph built = BuildFitted(House().log, House().map, options);
  built.graph.SetValues(Solve(built.graph).values);
  auto fitted = std::make_unique<FittedTomography>(built.graph, built.model);
  fitted->SetMap(House().map);
  return fitted;
}

TEST(FittedTomography, PredictsAsTomographyDoes) {
  TomographyOptions options = TomographyOptions::Matte();
  options.exact_up_to = 5000;
  Tomography online(options);
  online.SetMap(House().map);
  online.AddMeasurements(House().log.measurements);
  online.Update(House().log.measurements.back().link.time_s);
  const auto fitted = Fit(options);
  std::vector<SignalLink> links;
  for (std::size_t i = 0; i < House().log.measurements.size(); i += 37)
    links.push_back(House().log.measurements[i].link);
  std::vector<SignalPrediction> one(links.size()), two(links.size());
  online.Predict(links, {one.data(), one.size()});
  fitted->Predict(links, {two.data(), two.size()});
  for (std::size_t i = 0; i < links.size(); ++i) {
    // Their noise was estimated to a last digit that conjugate gradients leave open.
    EXPECT_NEAR(one[i].dbm, two[i].dbm, 0.1);
    EXPECT_NEAR(one[i].sigma_db, two[i].sigma_db, 0.1);
  }
}

TEST(FittedTomography, IsSurerWhereItHasMeasured) {
  const auto fitted = Fit(TomographyOptions::Matte());
  SignalLink link = House().log.measurements.back().link;
  SignalPrediction before, after;
  fitted->Predict({&link, 1}, {&before, 1});
  const SignalMeasurement measured{link, before.dbm, true};
  fitted->AddMeasurements({&measured, 1});
  fitted->Update(0);
  fitted->Predict({&link, 1}, {&after, 1});
  EXPECT_LT(after.sigma_db, before.sigma_db);
  EXPECT_GT(after.sigma_db, fitted->SigmaDb());
  EXPECT_NEAR(after.dbm, before.dbm, 1e-6);
}

/// Strengths by distance alone, to a known deviation.
class Known : public SignalPredictor {
 public:
  void SetMap(std::shared_ptr<const OccupancyGrid>) override {}
  void AddMeasurements(Span<const SignalMeasurement>) override {}
  void Update(double) override {}
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override {
    for (std::size_t i = 0; i < links.size(); ++i)
      predictions[i] = {-60 - (links[i].receiver_m - links[i].transmitter_m).norm(), 4};
  }
  std::string Name() const override { return "known"; }
};

TEST(Connect, CountsWaysToReachAll) {
  // A chain: a - b - c, whose ends are out of reach of each other.
  const std::vector<Eigen::Vector3d> at = {{0, 0, 0}, {20, 0, 0}, {40, 0, 0}};
  const TeamConnectivity team = Connect(Known(), {0, 1, 2}, at, -80, 0);
  ASSERT_EQ(team.links.size(), 3u);
  const double p = team.links[0].probability, q = team.links[1].probability;
  EXPECT_NEAR(p, 0.5, 1e-9);
  EXPECT_NEAR(q, 2.87e-7, 1e-8);  // five deviations
  EXPECT_NEAR(team.connected, p * p + 2 * p * q * (1 - p), 1e-9);
  EXPECT_EQ(team.backbone, (std::vector<std::size_t>{0, 2}));
}

/// Says as strength what time it is asked for.
class Clock : public Known {
 public:
  void Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const override {
    for (std::size_t i = 0; i < links.size(); ++i) predictions[i] = {-links[i].time_s, 4};
  }
};

TEST(Connect, AsksForNow) {
  const TeamConnectivity team = Connect(Clock(), {0, 1}, {{0, 0, 0}, {20, 0, 0}}, -80, 60);
  EXPECT_EQ(team.links.at(0).prediction.dbm, -60);
}

TEST(FittedTomography, StartsWhereTomographyEnded) {
  FittedGraph built = BuildFitted(House().log, House().map, TomographyOptions::Matte());
  const Solution solution = Solve(built.graph);
  // What conjugate gradients leave is little against the noise.
  EXPECT_LT(solution.report.initial_cost, 1.01 * solution.report.final_cost);
}

TEST(FittedTomography, LearnsFromWhatIsNotHeardLater) {
  const auto fitted = Fit(TomographyOptions::Matte());
  const SignalLink link = House().log.measurements.back().link;
  const SignalPrediction before = test::Predicted(*fitted, {link})[0];
  // Not above what was expected; a second time it is no news of the same size.
  const SignalMeasurement silent{link, before.dbm - 3, false};
  double last = before.dbm, moved = HUGE_VAL;
  for (int time = 0; time < 3; ++time) {
    fitted->AddMeasurements({&silent, 1});
    fitted->Update(0);
    const SignalPrediction after = test::Predicted(*fitted, {link})[0];
    EXPECT_LT(after.dbm, last);
    EXPECT_LT(last - after.dbm, moved);
    EXPECT_LT(after.sigma_db, before.sigma_db);
    moved = last - after.dbm;
    last = after.dbm;
  }
  // A floor far above says nothing.
  const auto other = Fit(TomographyOptions::Matte());
  const SignalMeasurement idle{link, 25, false};
  other->AddMeasurements({&idle, 1});
  other->Update(0);
  EXPECT_NEAR(test::Predicted(*other, {link})[0].dbm, before.dbm, 1e-6);
}

// What comes after the graph says the same as if it had been in it, but for cells the graph has
// not, whose number is small: the second half of the log drives where the first did.
TEST(FittedTomography, LearnsLaterWhatItWouldHaveLearntAtOnce) {
  TomographyOptions options = TomographyOptions::OneAttenuationPerClass();
  options.correlation = 0;
  const auto& all = House().log.measurements;
  const auto solved = [&](Span<const SignalMeasurement> measurements) {
    const auto map = std::make_shared<const ClassMap>(*House().map, options.class_of);
    TomographyGraph built = BuildTomography(measurements, map, options);
    built.graph.SetValues(Solve(built.graph, TomographySolving()).values);
    auto fitted = std::make_unique<FittedTomography>(built.graph,
                                                     FittedModel{options, std::move(built.layout)});
    fitted->SetMap(House().map);
    return fitted;
  };
  const std::size_t half = all.size() / 2;
  const auto whole = solved(all), first = solved({all.data(), half});
  first->AddMeasurements({all.data() + half, all.size() - half});
  first->Update(0);
  for (std::size_t i = 0; i < all.size(); i += 37) {
    const SignalPrediction one = test::Predicted(*whole, {all[i].link})[0];
    const SignalPrediction two = test::Predicted(*first, {all[i].link})[0];
    // The first half's packets not heard count by their curvature as it was then.
    EXPECT_NEAR(one.dbm, two.dbm, 0.1);
    EXPECT_NEAR(one.sigma_db, two.sigma_db, 0.02);
  }
}

TEST(WhereToMeasure, GoesWhereLeastIsKnownAndNotTwice) {
  const auto fitted = Fit(TomographyOptions::Matte());
  const std::vector<Eigen::Vector3d> candidates = {{2, 2, 0}, {2.1, 2, 0}, {14, 10, 0}};
  const std::vector<WorthwhilePlace> places =
      WhereToMeasure(fitted.get(), fitted->SigmaDb(), 0, 0, {1}, {{8, 3, 0}}, candidates, 5);
  ASSERT_EQ(places.size(), 3u);
  EXPECT_GT(places[0].gain_nats, 0);
  EXPECT_GE(places[0].gain_nats, places[1].gain_nats);
  EXPECT_GE(places[1].gain_nats, places[2].gain_nats);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i + 1; k < 3; ++k) EXPECT_NE(places[i].at_m, places[k].at_m);
}

// Even of a method whose deviations do not fall by what it learns.
TEST(WhereToMeasure, NamesNoPlaceTwiceWhateverTheMethodKnows) {
  Known known;
  const std::vector<WorthwhilePlace> places =
      WhereToMeasure(&known, 4, 0, 0, {1}, {{8, 3, 0}}, {{0, 0, 0}, {1, 0, 0}}, 2);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NE(places[0].at_m, places[1].at_m);
}

TEST(SignalSettings, AreFoundByNameAndKeepWhatWasSet) {
  MethodOptions options;
  for (const SignalSetting& setting : SignalSettings()) {
    const double value = 0.5 * (setting.lower + setting.upper);
    SetSignalOption(&options, setting.name, value);
    EXPECT_EQ(setting.get(options), value) << setting.name;
  }
  EXPECT_EQ(options.matte.classes[1].rho_db_per_m, 9);
  EXPECT_THROW(SetSignalOption(&options, "matte.lamda", 1), Error);
}

TEST(SignalSettings, OfAProcessAreNotLearntWhereOneIsGiven) {
  MethodOptions options;
  EXPECT_TRUE(SettingsOf("pair-gp", options).empty());
  SetSignalOption(&options, "pair-gp.length_m", 7);
  EXPECT_FALSE(options.pair_gp.learn);
  EXPECT_EQ(SettingsOf("pair-gp", options).size(), 3u);
}

TEST(SignalSettings, OfAMethodAreThoseThatItDependsOn) {
  EXPECT_EQ(SettingsOf("log-fit").size(), 0u);
  EXPECT_EQ(SettingsOf("matte").size(), 9u);  // cells, lambda, biases; rho and phi of three classes
  EXPECT_EQ(SettingsOf("matte+gp").size(), 9u + 7);
  EXPECT_EQ(SettingsOf("fine-mrt+gp").back()->name, "fine-mrt-gp.noise_db");
  EXPECT_EQ(SettingsOf("log-fit+gp").back()->name, "gp.noise_db");
  EXPECT_EQ(SettingsOf("pair-gp").size(), 0u) << "it learns them";
  EXPECT_EQ(SettingsOf("combined").size(), 9u + 5 + 7 + 7);
  MethodOptions options;
  options.matte.bias = RadioBias::kNone;
  EXPECT_EQ(SettingsOf("matte", options).size(), 8u);
  EXPECT_THROW(SettingsOf("magic"), Error);
}

}  // namespace
}  // namespace graticule
