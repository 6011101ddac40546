#include "graticule/problems/attenuation/residual_gp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kTogether = 16;  // predictions of a link that share their points
constexpr double kTogether_m = 0.6;    // where their links are no further apart
constexpr std::size_t kLearnAtLeast = 250;
constexpr std::size_t kLearnBlocks = 8;  // of the points of one prediction each

std::pair<std::uint32_t, std::uint32_t> RadiosOf(const SignalLink& link) {
  return std::minmax(link.receiver, link.transmitter);
}

double Square(double x) { return x * x; }

}  // namespace

void ResidualGpOptions::Check() const {
  for (const double value : {place.length_m, place_db, link_db, link_s, offset_db, noise_db})
    if (!(value > 0) || !std::isfinite(value))
      throw Error(
          name + ": a deviation, length or time is " + Shown(value) + "; expected above zero",
          ErrorKind::kUsage);
  if (newest + nearest == 0) throw Error(name + ": no points to predict from", ErrorKind::kUsage);
}

ResidualGp::ResidualGp(std::unique_ptr<SignalPredictor> mean, ResidualGpOptions options)
    : mean_(std::move(mean)), options_(std::move(options)) {
  options_.Check();
}

void ResidualGp::AddMeasurements(Span<const SignalMeasurement> measurements) {
  CheckMeasurements(measurements);
  mean_->AddMeasurements(measurements);
  for (const SignalMeasurement& measurement : measurements) {
    if (!measurement.is_heard) continue;
    of_link_[RadiosOf(measurement.link)].push_back(static_cast<std::uint32_t>(points_.size()));
    points_.push_back(measurement);
  }
}

double ResidualGp::Covariance(const SignalLink& a, const SignalLink& b) const {
  double sum = Square(options_.place_db) * PairSimilarity(options_.place, a, b);
  if (RadiosOf(a) == RadiosOf(b))
    sum += Square(options_.offset_db) +
           Square(options_.link_db) * std::exp(-std::abs(a.time_s - b.time_s) / options_.link_s);
  return sum;
}

std::vector<std::uint32_t> ResidualGp::PointsFor(const SignalLink& link) const {
  std::vector<std::uint32_t> chosen;
  std::uint32_t first_of_newest = 0;
  const auto own = of_link_.find(RadiosOf(link));
  const Radios radios = RadiosOf(link);
  if (own != of_link_.end() && options_.newest > 0) {
    const auto& mine = own->second;
    const std::size_t count = std::min(options_.newest, mine.size());
    chosen.assign(mine.end() - static_cast<std::ptrdiff_t>(count), mine.end());
    first_of_newest = chosen.front();
  }
  const bool has_newest = !chosen.empty();
  std::vector<std::pair<double, std::uint32_t>> others;
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    if (has_newest && i >= first_of_newest && RadiosOf(points_[i].link) == radios) continue;
    others.emplace_back(LinkDistance(points_[i].link, link), i);
  }
  const std::size_t count = std::min(options_.nearest, others.size());
  // Ties by index, so that the choice is one.
  std::nth_element(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count),
                   others.end());
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(others[i].second);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<double> ResidualGp::Residuals(const std::vector<std::uint32_t>& points) const {
  std::vector<SignalLink> links;
  for (const std::uint32_t i : points) links.push_back(points_[i].link);
  std::vector<SignalPrediction> expected(links.size());
  mean_->Predict(links, {expected.data(), expected.size()});
  std::vector<double> residuals;
  for (std::size_t k = 0; k < points.size(); ++k)
    residuals.push_back(points_[points[k]].dbm - expected[k].dbm);
  return residuals;
}

void ResidualGp::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  mean_->Predict(links, predictions);
  if (points_.empty()) return;
  // Neighbours in time of one link come one after the other, whatever the order asked.
  std::vector<std::size_t> order(links.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Radios first = RadiosOf(links[a]), second = RadiosOf(links[b]);
    return first != second ? first < second : links[a].time_s < links[b].time_s;
  });
  std::vector<SignalLink> some;
  std::vector<SignalPrediction> answers;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    const SignalLink& first = links[order[begin]];
    some.clear();
    answers.clear();
    for (; end < order.size() && end - begin < kTogether; ++end) {
      const SignalLink& next = links[order[end]];
      if (RadiosOf(next) != RadiosOf(first) || LinkDistance(next, first) > kTogether_m) break;
      some.push_back(next);
      answers.push_back(predictions[order[end]]);
    }
    PredictTogether(some, {answers.data(), answers.size()});
    for (std::size_t k = begin; k < end; ++k) predictions[order[k]] = answers[k - begin];
  }
}

void ResidualGp::PredictTogether(Span<const SignalLink> links,
                                 Span<SignalPrediction> predictions) const {
  const std::vector<std::uint32_t> chosen = PointsFor(links[links.size() / 2]);
  const std::vector<double> residuals = Residuals(chosen);
  const auto count = static_cast<Eigen::Index>(chosen.size());
  const auto width = static_cast<Eigen::Index>(links.size());
  Eigen::MatrixXd matrix(count, count), cross(count, width);
  for (Eigen::Index i = 0; i < count; ++i) {
    const SignalLink& link = points_[chosen[i]].link;
    for (Eigen::Index j = 0; j < i; ++j) matrix(i, j) = Covariance(link, points_[chosen[j]].link);
    matrix(i, i) = Covariance(link, link) + Square(options_.noise_db);
    for (Eigen::Index q = 0; q < width; ++q) cross(i, q) = Covariance(link, links[q]);
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  const Eigen::VectorXd weights = factor.solve(
      Eigen::Map<const Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(count)));
  const Eigen::MatrixXd half = factor.matrixL().solve(cross);
  for (Eigen::Index q = 0; q < width; ++q) {
    predictions[q].dbm += cross.col(q).dot(weights);
    const double variance = Covariance(links[q], links[q]) - half.col(q).squaredNorm();
    predictions[q].sigma_db = std::sqrt(std::max(variance, 0.0) + Square(options_.noise_db));
  }
}

void ResidualGp::Learn() {
  // Blocks of points as predictions take them, around measurements spread over the log.
  std::vector<std::vector<std::uint32_t>> blocks;
  std::vector<std::vector<double>> residuals;
  for (std::size_t k = 0; k < kLearnBlocks; ++k) {
    const std::size_t centre = (2 * k + 1) * points_.size() / (2 * kLearnBlocks);
    const SignalLink& link = points_[centre].link;
    const auto& own = of_link_.at(RadiosOf(link));
    const auto place = std::lower_bound(own.begin(), own.end(), centre) - own.begin();
    const auto from =
        std::max<std::ptrdiff_t>(0, place - static_cast<std::ptrdiff_t>(options_.newest) / 2);
    std::vector<std::uint32_t> block = PointsFor(link);
    for (auto i = from;
         i < std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(own.size()),
                                      from + static_cast<std::ptrdiff_t>(options_.newest));
         ++i)
      block.push_back(own[static_cast<std::size_t>(i)]);
    std::sort(block.begin(), block.end());
    block.erase(std::unique(block.begin(), block.end()), block.end());
    residuals.push_back(Residuals(block));
    blocks.push_back(std::move(block));
  }
  const auto take = [&](const std::vector<double>& logs) {
    options_.place.length_m = std::exp(logs[0]);
    options_.place_db = std::exp(logs[1]);
    options_.link_db = std::exp(logs[2]);
    options_.link_s = std::exp(logs[3]);
    options_.noise_db = std::exp(logs[4]);
  };
  const auto cost = [&](const std::vector<double>& logs) {
    take(logs);
    double sum = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto count = static_cast<Eigen::Index>(blocks[b].size());
      Eigen::MatrixXd matrix(count, count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const SignalLink& link = points_[blocks[b][i]].link;
        for (Eigen::Index j = 0; j < i; ++j)
          matrix(i, j) = Covariance(link, points_[blocks[b][j]].link);
        matrix(i, i) = Covariance(link, link) + Square(options_.noise_db);
      }
      const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
      if (factor.info() != Eigen::Success) return HUGE_VAL;
      const Eigen::Map<const Eigen::VectorXd> r(residuals[b].data(), count);
      sum += 0.5 * r.dot(factor.solve(r)) + factor.matrixLLT().diagonal().array().log().sum();
    }
    return sum;
  };
  CompassOptions search;
  search.first_step = 0.4;
  search.last_step = 0.09;
  search.lower = {std::log(0.1), std::log(0.3), std::log(0.3), std::log(0.5), std::log(0.5)};
  search.upper = {std::log(30.0), std::log(20.0), std::log(20.0), std::log(120.0), std::log(20.0)};
  search.max_evaluations = 120;
  take(CompassSearch(
           cost,
           {std::log(options_.place.length_m), std::log(options_.place_db),
            std::log(options_.link_db), std::log(options_.link_s), std::log(options_.noise_db)},
           search)
           .best);
}

void ResidualGp::Update(double now_s) {
  mean_->Update(now_s);
  if (!options_.learn || points_.size() < std::max(kLearnAtLeast, 2 * learnt_at_)) return;
  Learn();
  learnt_at_ = points_.size();
}

}  // namespace graticule
