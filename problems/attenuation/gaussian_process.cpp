#include "graticule/problems/attenuation/gaussian_process.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/problems/attenuation/tune.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kSparseBelow = 0.3;       // share of entries; above, a dense factor is quicker
constexpr std::size_t kFewest = 30;        // points, where a share would be fewer
constexpr std::size_t kLearnFrom = 250;    // points the likelihood is taken of
constexpr std::size_t kLearnAtLeast = 60;  // measurements before anything is learnt

}  // namespace

GaussianProcessOptions GaussianProcessOptions::Mrgp() {
  GaussianProcessOptions options;
  options.name = "mrgp";
  options.is_pair = false;
  options.place = {28.75, 2, 20, 3};
  options.sigma_f_db = 1;
  options.sigma_d_db = 1.5;
  options.share = 0.05;
  options.learn = false;
  return options;
}

void GaussianProcessOptions::Check() const {
  const auto expect = [&](const char* what, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw Error(name + ": " + what + " is " + Shown(value) + "; expected above zero",
                  ErrorKind::kUsage);
  };
  expect("the length", place.length_m);
  expect("sigma_f", sigma_f_db);
  expect("sigma_d", sigma_d_db);
  expect("the share of points", share);
  expect("the number of points", static_cast<double>(max_points));
  if (!(place.support_m >= 0) || !(place.taper >= 0))
    throw Error(name + ": the support and its taper are not below zero", ErrorKind::kUsage);
}

GaussianProcess::GaussianProcess(GaussianProcessOptions options) : options_(std::move(options)) {
  options_.Check();
}

void GaussianProcess::AddMeasurements(Span<const SignalMeasurement> measurements) {
  mean_.AddMeasurements(measurements);
  all_.insert(all_.end(), measurements.begin(), measurements.end());
}

double GaussianProcess::Covariance(const SignalLink& a, const SignalLink& b) const {
  return options_.sigma_f_db * options_.sigma_f_db *
         (options_.is_pair ? PairSimilarity(options_.place, a, b)
                           : ThesisSimilarity(options_.place, a, b));
}

void GaussianProcess::ChoosePoints() {
  const double wanted =
      std::max(options_.share * static_cast<double>(all_.size()), static_cast<double>(kFewest));
  const std::size_t count =
      std::min({all_.size(), options_.max_points, static_cast<std::size_t>(wanted)});
  const std::size_t newest = count == all_.size() ? count : (count + 1) / 2;
  const std::size_t older = all_.size() - newest, spread = count - newest;
  points_.clear();
  for (std::size_t k = 0; k < spread; ++k)
    points_.push_back(all_[(2 * k + 1) * older / (2 * spread)]);
  points_.insert(points_.end(), all_.end() - static_cast<std::ptrdiff_t>(newest), all_.end());
}

void GaussianProcess::Factorise() {
  const auto count = static_cast<Eigen::Index>(points_.size());
  std::vector<SignalLink> links;
  for (const SignalMeasurement& point : points_) links.push_back(point.link);
  std::vector<SignalPrediction> expected(links.size());
  mean_.Predict(links, {expected.data(), expected.size()});
  Eigen::VectorXd residuals(count);
  for (Eigen::Index i = 0; i < count; ++i) residuals[i] = points_[i].dbm - expected[i].dbm;

  const double noise = options_.sigma_d_db * options_.sigma_d_db;
  is_sparse_ = false;
  if (options_.place.support_m > 0) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index i = 0; i < count; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) {
        const double value = Covariance(links[i], links[j]) + (i == j ? noise : 0);
        if (value != 0) entries.emplace_back(i, j, value);
      }
    is_sparse_ = static_cast<double>(entries.size()) <
                 kSparseBelow * static_cast<double>(count) * static_cast<double>(count + 1) / 2;
    if (is_sparse_) {
      Eigen::SparseMatrix<double> matrix(count, count);
      matrix.setFromTriplets(entries.begin(), entries.end());
      for (jitter_ = 0;; jitter_ = jitter_ > 0 ? 2 * jitter_ : noise / 16) {
        sparse_.setShift(jitter_);
        sparse_.compute(matrix);
        if (sparse_.info() == Eigen::Success) break;
      }
      weights_ = sparse_.solve(residuals);
      return;
    }
  }
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      matrix(i, j) = Covariance(links[i], links[j]) + (i == j ? noise : 0);
  for (jitter_ = 0;; jitter_ = jitter_ > 0 ? 2 * jitter_ : noise / 16) {
    if (jitter_ > 0) matrix.diagonal().array() += jitter_ / (jitter_ > noise / 16 ? 2 : 1);
    dense_.compute(matrix);
    if (dense_.info() == Eigen::Success) break;
  }
  weights_ = dense_.solve(residuals);
}

double GaussianProcess::LogLikelihood(const std::vector<std::size_t>& some,
                                      const Eigen::VectorXd& residuals) {
  const auto count = static_cast<Eigen::Index>(some.size());
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      matrix(i, j) = Covariance(all_[some[i]].link, all_[some[j]].link) +
                     (i == j ? options_.sigma_d_db * options_.sigma_d_db : 0);
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return -HUGE_VAL;
  return -0.5 * residuals.dot(factor.solve(residuals)) -
         factor.matrixLLT().diagonal().array().log().sum();
}

void GaussianProcess::Learn() {
  const std::size_t count = std::min(kLearnFrom, all_.size());
  std::vector<std::size_t> some;
  std::vector<SignalLink> links;
  for (std::size_t k = 0; k < count; ++k) {
    some.push_back((2 * k + 1) * all_.size() / (2 * count));
    links.push_back(all_[some.back()].link);
  }
  std::vector<SignalPrediction> expected(count);
  mean_.Predict(links, {expected.data(), count});
  Eigen::VectorXd residuals(static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k)
    residuals[static_cast<Eigen::Index>(k)] = all_[some[k]].dbm - expected[k].dbm;

  const auto take = [&](const std::vector<double>& logs) {
    options_.place.length_m = std::exp(logs[0]);
    options_.sigma_f_db = std::exp(logs[1]);
    options_.sigma_d_db = std::exp(logs[2]);
  };
  CompassOptions search;
  search.first_step = 0.5;
  search.last_step = 0.06;
  search.lower = {std::log(0.05), std::log(0.05), std::log(0.1)};
  search.upper = {std::log(100.0), std::log(50.0), std::log(50.0)};
  const std::vector<double> start = {std::log(options_.place.length_m),
                                     std::log(options_.sigma_f_db), std::log(options_.sigma_d_db)};
  take(CompassSearch(
           [&](const std::vector<double>& logs) {
             take(logs);
             return -LogLikelihood(some, residuals);
           },
           start, search)
           .best);
}

void GaussianProcess::Update(double now_s) {
  mean_.Update(now_s);
  if (all_.empty()) return;
  if (options_.learn && all_.size() >= std::max(kLearnAtLeast, 2 * learnt_at_)) {
    Learn();
    learnt_at_ = all_.size();
  }
  ChoosePoints();
  Factorise();
}

void GaussianProcess::Predict(Span<const SignalLink> links,
                              Span<SignalPrediction> predictions) const {
  mean_.Predict(links, predictions);
  if (points_.empty()) return;
  const auto count = static_cast<Eigen::Index>(points_.size());
  constexpr std::size_t kTogether = 64;
  for (std::size_t begin = 0; begin < links.size(); begin += kTogether) {
    const auto width = static_cast<Eigen::Index>(std::min(kTogether, links.size() - begin));
    Eigen::MatrixXd cross(count, width);
    for (Eigen::Index q = 0; q < width; ++q)
      for (Eigen::Index i = 0; i < count; ++i)
        cross(i, q) = Covariance(points_[i].link, links[begin + q]);
    const Eigen::MatrixXd solved =
        is_sparse_ ? Eigen::MatrixXd(sparse_.solve(cross)) : Eigen::MatrixXd(dense_.solve(cross));
    for (Eigen::Index q = 0; q < width; ++q) {
      SignalPrediction& prediction = predictions[begin + q];
      prediction.dbm += cross.col(q).dot(weights_);
      const double process = Covariance(links[begin + q], links[begin + q]);
      const double noise = options_.sigma_d_db * options_.sigma_d_db;
      prediction.sigma_db =
          std::sqrt(std::max(process - cross.col(q).dot(solved.col(q)), 0.0) + noise);
    }
  }
}

}  // namespace graticule
