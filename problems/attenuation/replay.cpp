#include "graticule/problems/attenuation/replay.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "graticule/problems/random.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

/// Half-widths of kCoverageLevels' intervals, in standard deviations.
constexpr std::array<double, 4> kHalfWidths = {0.6744897501960817, 0.994457883209753,
                                               1.6448536269514722, 1.959963984540054};

/// Sums of which a SignalScore is made.
class Sums {
 public:
  void Add(const SignalPrediction& prediction, double dbm) {
    const double error = dbm - prediction.dbm, scaled = error / prediction.sigma_db;
    ++count_;
    squares_ += error * error;
    step_squares_ += error * error;
    ++step_count_;
    nll_ += 0.5 * scaled * scaled + std::log(prediction.sigma_db) + 0.5 * std::log(2 * M_PI);
    crps_ += GaussianCrps(prediction, dbm);
    for (std::size_t i = 0; i < kHalfWidths.size(); ++i)
      covered_[i] += std::abs(scaled) <= kHalfWidths[i] ? 1 : 0;
  }

  void EndStep() {
    if (step_count_ == 0) return;
    const double mean = step_squares_ / static_cast<double>(step_count_);
    ++steps_;
    means_ += mean;
    means_squared_ += mean * mean;
    step_squares_ = 0;
    step_count_ = 0;
  }

  SignalScore Score() const {
    SignalScore score;
    score.count = count_;
    if (count_ == 0) return score;
    const double n = static_cast<double>(count_), steps = static_cast<double>(steps_);
    score.mse = squares_ / n;
    score.rmse = std::sqrt(score.mse);
    if (steps_ > 1)
      score.standard_error = std::sqrt(
          std::max(means_squared_ / steps - means_ * means_ / steps / steps, 0.0) / (steps - 1));
    score.negative_log_likelihood = nll_ / n;
    score.crps = crps_ / n;
    for (std::size_t i = 0; i < covered_.size(); ++i)
      score.coverage[i] = static_cast<double>(covered_[i]) / n;
    return score;
  }

 private:
  std::size_t count_ = 0, step_count_ = 0, steps_ = 0;
  double squares_ = 0, step_squares_ = 0, means_ = 0, means_squared_ = 0, nll_ = 0, crps_ = 0;
  std::array<std::size_t, 4> covered_ = {};
};

std::pair<std::uint32_t, std::uint32_t> RadiosOf(const SignalLink& link) {
  return std::minmax(link.receiver, link.transmitter);
}

/// A part of the radios, chosen at random.
std::vector<bool> SomeRadios(const SignalLog& log, double part, RandomNumbers* random) {
  std::vector<bool> chosen(log.radios.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = random->Unit() < part;
  return chosen;
}

}  // namespace

double GaussianCrps(const SignalPrediction& prediction, double dbm) {
  const double z = (dbm - prediction.dbm) / prediction.sigma_db;
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * M_PI);
  return prediction.sigma_db *
         (z * std::erf(z / std::sqrt(2.0)) + 2 * density - 1 / std::sqrt(M_PI));
}

double Skill(const SignalScore& score, const SignalScore& reference) {
  return 1 - score.mse / reference.mse;
}

ReplayResult Replay(const SignalLog& log,
                    const std::function<std::unique_ptr<SignalPredictor>()>& make,
                    const ReplayOptions& options) {
  if (!log.has_time) throw Error("a log without time cannot be replayed: use a hold-out split");
  const auto& all = log.measurements;
  std::vector<Sums> horizons(static_cast<std::size_t>(options.horizons));
  Sums every;
  ReplayResult result;
  std::unique_ptr<SignalPredictor> predictor = make();
  result.method = predictor->Name();
  std::size_t steps = 0, predicted_steps = 0, drive = 0;
  std::vector<SignalLink> links;
  std::vector<SignalPrediction> predictions;
  for (std::size_t begin = 0, drive_end = 0; begin < all.size(); begin = drive_end, ++drive) {
    for (drive_end = begin + 1; drive_end < all.size(); ++drive_end)
      if (all[drive_end].link.time_s - all[drive_end - 1].link.time_s > options.new_drive_s) break;
    if (options.forget_between_drives && begin > 0) predictor = make();
    const double start_s = all[begin].link.time_s;
    for (std::size_t known = begin, step = 1; known < drive_end; ++step) {
      const double now_s = start_s + static_cast<double>(step) * options.step_s;
      std::size_t next = known;
      while (next < drive_end && all[next].link.time_s < now_s) ++next;
      if (next == known) continue;
      if (options.before_step) options.before_step();
      const Stopwatch update;
      predictor->AddMeasurements({all.data() + known, next - known});
      predictor->Update(now_s);
      result.update_ms += update.Elapsed().wall * 1e3;
      known = next;
      if (++steps % options.every != 0) continue;
      if (now_s - all.front().link.time_s < options.leave_s) continue;

      const double end_s = now_s + options.horizons * options.step_s;
      links.clear();
      std::size_t last = next;
      for (; last < drive_end && all[last].link.time_s < end_s; ++last)
        links.push_back(all[last].link);
      predictions.resize(links.size());
      const Stopwatch predict;
      predictor->Expect(links);
      predictor->Predict(links, {predictions.data(), predictions.size()});
      result.predict_ms += predict.Elapsed().wall * 1e3;
      ++predicted_steps;
      StepErrors errors{drive, std::vector<double>(horizons.size()),
                        std::vector<std::size_t>(horizons.size())};
      for (std::size_t i = 0; i < links.size(); ++i) {
        if (!all[next + i].is_heard) continue;
        const double dbm = all[next + i].dbm, error = dbm - predictions[i].dbm;
        const std::size_t horizon =
            std::min(static_cast<std::size_t>((links[i].time_s - now_s) / options.step_s),
                     horizons.size() - 1);
        horizons[horizon].Add(predictions[i], dbm);
        every.Add(predictions[i], dbm);
        errors.squares[horizon] += error * error;
        ++errors.counts[horizon];
      }
      result.steps.push_back(std::move(errors));
      for (Sums& sums : horizons) sums.EndStep();
      every.EndStep();
    }
  }
  for (const Sums& sums : horizons) result.horizons.push_back(sums.Score());
  result.all = every.Score();
  result.update_ms /= static_cast<double>(std::max<std::size_t>(steps, 1));
  result.predict_ms /= static_cast<double>(std::max<std::size_t>(predicted_steps, 1));
  return result;
}

std::vector<double> RmseOverDrives(const ReplayResult& result) {
  std::vector<double> means;
  for (std::size_t h = 0; h < result.horizons.size(); ++h) {
    double sum = 0, drives = 0;
    for (std::size_t begin = 0, end = 0; begin < result.steps.size(); begin = end) {
      double squares = 0, count = 0;
      for (; end < result.steps.size() && result.steps[end].drive == result.steps[begin].drive;
           ++end) {
        squares += result.steps[end].squares[h];
        count += static_cast<double>(result.steps[end].counts[h]);
      }
      if (count == 0) continue;
      sum += std::sqrt(squares / count);
      ++drives;
    }
    means.push_back(drives > 0 ? sum / drives : 0);
  }
  return means;
}

PairedDifference ComparePaired(const std::vector<ReplayResult>& method,
                               const std::vector<ReplayResult>& other, std::size_t from,
                               std::size_t to, std::size_t block_steps) {
  struct Block {
    double difference = 0, count = 0;
  };
  std::vector<Block> blocks;
  Block sum;
  if (method.size() != other.size() || block_steps == 0)
    throw Error("replays that are not of the same logs cannot be paired", ErrorKind::kUsage);
  for (std::size_t log = 0; log < method.size(); ++log) {
    const auto &mine = method[log].steps, &theirs = other[log].steps;
    if (mine.size() != theirs.size())
      throw Error("replays that are not of the same steps cannot be paired", ErrorKind::kUsage);
    for (std::size_t step = 0; step < mine.size(); ++step) {
      if (step % block_steps == 0) blocks.emplace_back();
      for (std::size_t h = from; h < std::min(to, mine[step].counts.size()); ++h) {
        if (theirs[step].counts.at(h) != mine[step].counts[h])
          throw Error("replays that are not of the same steps cannot be paired", ErrorKind::kUsage);
        blocks.back().difference += mine[step].squares[h] - theirs[step].squares[h];
        blocks.back().count += static_cast<double>(mine[step].counts[h]);
      }
    }
  }
  for (const Block& block : blocks) {
    sum.difference += block.difference;
    sum.count += block.count;
  }
  PairedDifference result;
  if (sum.count == 0) return result;
  result.mse = sum.difference / sum.count;
  double squares = 0;
  for (const Block& block : blocks)
    squares += std::pow(block.difference - result.mse * block.count, 2);
  const auto n = static_cast<double>(blocks.size());
  if (n > 1) result.standard_error = std::sqrt(squares * n / (n - 1)) / sum.count;
  return result;
}

HoldOut RandomLinks(const SignalLog& log, double part, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> is_test;
  HoldOut split;
  for (std::uint32_t i = 0; i < log.measurements.size(); ++i) {
    const auto [link, is_new] = is_test.emplace(RadiosOf(log.measurements[i].link), false);
    if (is_new) link->second = random.Unit() < part;
    (link->second ? split.test : split.train).push_back(i);
  }
  return split;
}

HoldOut UnseenRadios(const SignalLog& log, double part, std::uint64_t seed, int unseen_ends) {
  RandomNumbers random(seed);
  const std::vector<bool> is_unseen = SomeRadios(log, part, &random);
  HoldOut split;
  for (std::uint32_t i = 0; i < log.measurements.size(); ++i) {
    const SignalLink& link = log.measurements[i].link;
    const int unseen = is_unseen[link.receiver] + is_unseen[link.transmitter];
    if (unseen == 0) split.train.push_back(i);
    if (unseen == unseen_ends) split.test.push_back(i);
  }
  return split;
}

std::vector<HoldOut> FrontierSweep(const SignalLog& log, int count) {
  std::map<std::uint32_t, double> east;
  for (const SignalMeasurement& measurement : log.measurements) {
    east.emplace(measurement.link.receiver, measurement.link.receiver_m.x());
    east.emplace(measurement.link.transmitter, measurement.link.transmitter_m.x());
  }
  std::vector<double> sorted;
  for (const auto& [radio, x] : east) sorted.push_back(x);
  std::sort(sorted.begin(), sorted.end());
  const auto frontier = [&](int i) {
    const double part = 0.3 + 0.7 * i / count;
    const auto place = static_cast<std::size_t>(part * static_cast<double>(sorted.size()));
    return place < sorted.size() ? sorted[place] : HUGE_VAL;
  };
  std::vector<HoldOut> splits(static_cast<std::size_t>(std::max(count, 0)));
  for (int i = 0; i < count; ++i)
    for (std::uint32_t k = 0; k < log.measurements.size(); ++k) {
      const SignalLink& link = log.measurements[k].link;
      const double near = std::min(link.receiver_m.x(), link.transmitter_m.x());
      const double far = std::max(link.receiver_m.x(), link.transmitter_m.x());
      if (far < frontier(i))
        splits[i].train.push_back(k);
      else if (near < frontier(i) && far < frontier(i + 1))
        splits[i].test.push_back(k);
    }
  return splits;
}

ReplayResult EvaluateHoldOut(const SignalLog& log, const std::vector<HoldOut>& splits,
                             const std::function<std::unique_ptr<SignalPredictor>()>& make) {
  ReplayResult result;
  Sums sums;
  for (const HoldOut& split : splits) {
    const std::unique_ptr<SignalPredictor> predictor = make();
    result.method = predictor->Name();
    std::vector<SignalMeasurement> train;
    for (const std::uint32_t i : split.train) train.push_back(log.measurements[i]);
    const Stopwatch update;
    predictor->AddMeasurements(train);
    predictor->Update(train.empty() ? 0 : train.back().link.time_s);
    result.update_ms += update.Elapsed().wall * 1e3 / static_cast<double>(splits.size());
    std::vector<SignalLink> links;
    for (const std::uint32_t i : split.test) links.push_back(log.measurements[i].link);
    std::vector<SignalPrediction> predictions(links.size());
    const Stopwatch predict;
    predictor->Predict(links, {predictions.data(), predictions.size()});
    result.predict_ms += predict.Elapsed().wall * 1e3 / static_cast<double>(splits.size());
    for (std::size_t i = 0; i < links.size(); ++i)
      if (log.measurements[split.test[i]].is_heard)
        sums.Add(predictions[i], log.measurements[split.test[i]].dbm);
    sums.EndStep();
  }
  result.all = sums.Score();
  return result;
}

}  // namespace graticule
