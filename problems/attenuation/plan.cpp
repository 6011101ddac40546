#include "graticule/problems/attenuation/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graticule/problems/random.hpp"

namespace graticule {
namespace {

constexpr int kDraws = 20000;  // of teams too large to count: a probability to about 0.004

/// Which radios hang together.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count), left_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  bool Join(std::size_t a, std::size_t b) {
    a = Find(a);
    b = Find(b);
    if (a == b) return false;
    parent_[a] = b;
    --left_;
    return true;
  }
  std::size_t Count() const { return left_; }

 private:
  std::size_t Find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::size_t> parent_;
  std::size_t left_;
};

double ProbabilityThatAllReachAll(const std::vector<TeamLink>& links,
                                  const std::vector<std::pair<std::size_t, std::size_t>>& ends,
                                  std::size_t team) {
  if (links.size() <= 15) {  // every set of links that may be up
    double sum = 0;
    for (std::uint32_t up = 0; up < (1u << links.size()); ++up) {
      double probability = 1;
      Pieces pieces(team);
      for (std::size_t k = 0; k < links.size(); ++k) {
        const bool is_up = (up >> k) & 1;
        probability *= is_up ? links[k].probability : 1 - links[k].probability;
        if (is_up) pieces.Join(ends[k].first, ends[k].second);
      }
      if (pieces.Count() == 1) sum += probability;
    }
    return sum;
  }
  RandomNumbers random(1);
  int joined = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Pieces pieces(team);
    for (std::size_t k = 0; k < links.size(); ++k)
      if (random.Unit() < links[k].probability) pieces.Join(ends[k].first, ends[k].second);
    joined += pieces.Count() == 1;
  }
  return static_cast<double>(joined) / kDraws;
}

}  // namespace

TeamConnectivity Connect(const SignalPredictor& predictor, const std::vector<std::uint32_t>& radios,
                         const std::vector<Eigen::Vector3d>& at_m, double usable_dbm,
                         double now_s) {
  TeamConnectivity team;
  std::vector<std::pair<std::size_t, std::size_t>> ends;
  std::vector<SignalLink> links;
  for (std::size_t a = 0; a < radios.size(); ++a)
    for (std::size_t b = a + 1; b < radios.size(); ++b) {
      ends.emplace_back(a, b);
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        SignalLink link;
        link.time_s = now_s;
        link.transmitter = radios[from];
        link.receiver = radios[to];
        link.transmitter_m = at_m[from];
        link.receiver_m = at_m[to];
        links.push_back(link);
      }
    }
  std::vector<SignalPrediction> both(links.size());
  predictor.Predict(links, {both.data(), both.size()});
  for (std::size_t k = 0; k < ends.size(); ++k) {
    TeamLink link;
    link.a = static_cast<std::uint32_t>(ends[k].first);
    link.b = static_cast<std::uint32_t>(ends[k].second);
    link.prediction = {0.5 * (both[2 * k].dbm + both[2 * k + 1].dbm),
                       std::max(both[2 * k].sigma_db, both[2 * k + 1].sigma_db)};
    link.probability =
        0.5 * std::erfc((usable_dbm - link.prediction.dbm) / (M_SQRT2 * link.prediction.sigma_db));
    team.links.push_back(link);
  }
  std::vector<std::size_t> order(ends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return team.links[i].probability > team.links[j].probability;
  });
  Pieces pieces(radios.size());
  for (const std::size_t k : order)
    if (pieces.Join(ends[k].first, ends[k].second)) team.backbone.push_back(k);
  std::sort(team.backbone.begin(), team.backbone.end());
  team.connected = ProbabilityThatAllReachAll(team.links, ends, radios.size());
  return team;
}

std::vector<WorthwhilePlace> WhereToMeasure(SignalPredictor* predictor, double noise_db,
                                            double now_s, std::uint32_t radio,
                                            const std::vector<std::uint32_t>& others,
                                            const std::vector<Eigen::Vector3d>& others_m,
                                            std::vector<Eigen::Vector3d> candidates,
                                            std::size_t count) {
  std::vector<SignalLink> links;
  for (const Eigen::Vector3d& at : candidates)
    for (std::size_t i = 0; i < others.size(); ++i)
      links.push_back({now_s, radio, others[i], at, others_m[i]});
  predictor->Expect(links);
  std::vector<WorthwhilePlace> chosen;
  std::vector<SignalPrediction> predictions;
  while (chosen.size() < count && !candidates.empty()) {
    predictions.resize(links.size());
    predictor->Predict(links, {predictions.data(), predictions.size()});
    WorthwhilePlace best;
    std::size_t best_at = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      WorthwhilePlace place{candidates[c], 0, 0};
      for (std::size_t i = 0; i < others.size(); ++i) {
        const double sigma = predictions[c * others.size() + i].sigma_db;
        place.gain_nats += std::log(std::max(1.0, sigma / noise_db));
        place.sigma_db = std::max(place.sigma_db, sigma);
      }
      if (c == 0 || place.gain_nats > best.gain_nats) {
        best = place;
        best_at = c;
      }
    }
    chosen.push_back(best);
    std::vector<SignalMeasurement> imagined;
    for (std::size_t i = 0; i < others.size(); ++i) {
      const std::size_t k = best_at * others.size() + i;
      imagined.push_back({links[k], predictions[k].dbm, true});
    }
    predictor->AddMeasurements(imagined);
    predictor->Update(now_s);
    const auto at = static_cast<std::ptrdiff_t>(best_at);
    const auto size = static_cast<std::ptrdiff_t>(others.size());
    candidates.erase(candidates.begin() + at);
    links.erase(links.begin() + at * size, links.begin() + (at + 1) * size);
  }
  return chosen;
}

}  // namespace graticule
