#include "graticule/problems/attenuation/combination.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "graticule/io/text.hpp"
#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMostMembers = 8;

/// The mixture of predictions with these weights.
SignalPrediction Mixed(const Eigen::VectorXd& weights, const SignalPrediction* predictions) {
  SignalPrediction mixed;
  for (Eigen::Index k = 0; k < weights.size(); ++k) mixed.dbm += weights[k] * predictions[k].dbm;
  double variance = 0;
  for (Eigen::Index k = 0; k < weights.size(); ++k) {
    const double sigma = predictions[k].sigma_db, apart = predictions[k].dbm - mixed.dbm;
    variance += weights[k] * (sigma * sigma + apart * apart);
  }
  mixed.sigma_db = std::sqrt(variance);
  return mixed;
}

/// w >= 0 with sum 1 of the least w' products w + ridge |w - prior|^2: each choice of those that
/// are not zero is tried, for there are few.
Eigen::VectorXd SimplexMinimum(const Eigen::MatrixXd& products, double ridge,
                               const Eigen::VectorXd& prior) {
  const Eigen::Index size = prior.size();
  Eigen::VectorXd best = prior;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned chosen = 1; chosen < 1u << size; ++chosen) {
    std::vector<Eigen::Index> which;
    for (Eigen::Index k = 0; k < size; ++k)
      if (chosen >> k & 1) which.push_back(k);
    const auto count = static_cast<Eigen::Index>(which.size());
    Eigen::MatrixXd matrix(count, count);
    Eigen::VectorXd right(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j) matrix(i, j) = products(which[i], which[j]);
      matrix(i, i) += ridge;
      right[i] = ridge * prior[which[i]];
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
    if (factor.info() != Eigen::Success) continue;
    const Eigen::VectorXd free = factor.solve(right), ones = Eigen::VectorXd::Ones(count),
                          toward = factor.solve(ones);
    const Eigen::VectorXd found = free + (1 - free.sum()) / toward.sum() * toward;
    if (!(found.minCoeff() >= 0)) continue;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(size);
    for (Eigen::Index i = 0; i < count; ++i) weights[which[i]] = found[i];
    const double cost = weights.dot(products * weights) + ridge * (weights - prior).squaredNorm();
    if (!(cost < least)) continue;
    least = cost;
    best = weights;
  }
  return best;
}

}  // namespace

void CombinationOptions::Check() const {
  for (const double value : {step_s, far_s, prior_count})
    if (!(value > 0) || !std::isfinite(value))
      throw Error(name + ": a time or count is " + Shown(value) + "; expected above zero",
                  ErrorKind::kUsage);
}

Combination::Combination(Members members, Members lagging, CombinationOptions options)
    : members_(std::move(members)),
      lagging_(std::move(lagging)),
      options_((options.Check(), std::move(options))),
      newest_s_(-std::numeric_limits<double>::infinity()),
      lagging_newest_s_(newest_s_) {
  if (members_.empty() || members_.size() > kMostMembers || members_.size() != lagging_.size())
    throw Error(options_.name + ": expected 1 to 8 members, and as many that lag behind",
                ErrorKind::kUsage);
  const auto size = static_cast<Eigen::Index>(members_.size());
  for (Record* record : {&near_, &far_}) {
    record->products = Eigen::MatrixXd::Zero(size, size);
    record->weights = Eigen::VectorXd::Constant(size, 1.0 / static_cast<double>(size));
  }
}

void Combination::SetMap(std::shared_ptr<const OccupancyGrid> map) {
  for (Members* members : {&members_, &lagging_})
    for (auto& member : *members) member->SetMap(map);
}

void Combination::AddMeasurements(Span<const SignalMeasurement> measurements) {
  CheckMeasurements(measurements);
  fresh_.insert(fresh_.end(), measurements.begin(), measurements.end());
}

void Combination::Update(double now_s) {
  std::size_t begin = 0;
  while (begin < fresh_.size()) {
    const double end_s = fresh_[begin].link.time_s + options_.step_s;
    std::size_t end = begin + 1;
    while (end < fresh_.size() && fresh_[end].link.time_s < end_s) ++end;
    Learn({fresh_.data() + begin, end - begin}, end == fresh_.size() ? now_s : end_s);
    begin = end;
  }
  fresh_.clear();
  now_s_ = now_s;
}

void Combination::Learn(Span<const SignalMeasurement> measurements, double now_s) {
  const double begin_s = measurements[0].link.time_s;
  // Not over a pause: what comes after it is further ahead.
  const bool is_next = begin_s - newest_s_ <= 2 * options_.step_s;
  const bool is_far = begin_s - lagging_newest_s_ <= options_.far_s + 2 * options_.step_s;
  if (is_next) Score(members_, measurements, &near_);
  if (is_far) Score(lagging_, measurements, &far_);
  const auto size = static_cast<Eigen::Index>(members_.size());
  Weigh(Eigen::VectorXd::Constant(size, 1.0 / static_cast<double>(size)), 1, &near_);
  Weigh(near_.weights, near_.scale, &far_);

  for (auto& member : members_) {
    member->AddMeasurements(measurements);
    member->Update(now_s);
  }
  recent_.insert(recent_.end(), measurements.begin(), measurements.end());
  newest_s_ = recent_.back().link.time_s;
  std::size_t old = 0;
  while (old < recent_.size() && recent_[old].link.time_s < now_s - options_.far_s) ++old;
  if (old == 0) return;
  for (auto& member : lagging_) {
    member->AddMeasurements({recent_.data(), old});
    member->Update(now_s - options_.far_s);
  }
  lagging_newest_s_ = recent_[old - 1].link.time_s;
  recent_.erase(recent_.begin(), recent_.begin() + static_cast<std::ptrdiff_t>(old));
}

void Combination::Score(const Members& members, Span<const SignalMeasurement> measurements,
                        Record* record) {
  std::vector<SignalLink> links;
  for (const SignalMeasurement& measurement : measurements) links.push_back(measurement.link);
  const std::size_t size = members.size();
  std::vector<SignalPrediction> of_member(links.size()), of_link(links.size() * size);
  for (std::size_t k = 0; k < size; ++k) {
    members[k]->Predict(links, {of_member.data(), of_member.size()});
    for (std::size_t i = 0; i < links.size(); ++i) of_link[i * size + k] = of_member[i];
  }
  Eigen::VectorXd errors(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!measurements[i].is_heard) continue;
    const SignalPrediction* predictions = of_link.data() + i * size;
    for (std::size_t k = 0; k < size; ++k)
      errors[static_cast<Eigen::Index>(k)] = measurements[i].dbm - predictions[k].dbm;
    const SignalPrediction mixed = Mixed(record->weights, predictions);
    const double scaled = (measurements[i].dbm - mixed.dbm) / mixed.sigma_db;
    record->products += errors * errors.transpose();
    record->scaled_squares += scaled * scaled;
    ++record->count;
  }
}

void Combination::Weigh(const Eigen::VectorXd& prior_weights, double prior_scale,
                        Record* record) const {
  const double prior = options_.prior_count;
  record->scale = std::sqrt((record->scaled_squares + prior * prior_scale * prior_scale) /
                            (record->count + prior));
  record->weights = prior_weights;
  if (record->count == 0) return;
  const double variance = record->products.diagonal().mean() / record->count;
  record->weights = SimplexMinimum(record->products, prior * variance, prior_weights);
}

void Combination::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  const std::size_t size = members_.size();
  std::vector<SignalPrediction> of_member(links.size()), of_link(links.size() * size);
  for (std::size_t k = 0; k < size; ++k) {
    members_[k]->Predict(links, {of_member.data(), of_member.size()});
    for (std::size_t i = 0; i < links.size(); ++i) of_link[i * size + k] = of_member[i];
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    const double ahead_s = links[i].time_s - now_s_ - options_.step_s / 2;  // than when scored
    const double far = std::sqrt(std::clamp(ahead_s / options_.far_s, 0.0, 1.0));
    predictions[i] =
        Mixed((1 - far) * near_.weights + far * far_.weights, of_link.data() + i * size);
    predictions[i].sigma_db *= (1 - far) * near_.scale + far * far_.scale;
  }
}

}  // namespace graticule
