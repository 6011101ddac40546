#include "graticule/problems/attenuation/residual_gp.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "graticule/problems/attenuation/log_fit.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kTogether = 32;  // predictions of a link that share their points
constexpr double kTogether_m = 0.6;    // where their links are no further apart

std::pair<std::uint32_t, std::uint32_t> RadiosOf(const SignalLink& link) {
  return std::minmax(link.receiver, link.transmitter);
}

double Square(double x) { return x * x; }

}  // namespace

struct ResidualGp::Columns {
  Eigen::ArrayX3d receiver_m, transmitter_m;
  Eigen::ArrayXd time_s;
  std::vector<std::uint32_t> receiver, transmitter;

  void Take(const std::vector<Point>& points, const std::uint32_t* chosen, std::size_t count) {
    const auto size = static_cast<Eigen::Index>(count);
    if (time_s.size() < size) {
      receiver_m.resize(size, 3);
      transmitter_m.resize(size, 3);
      time_s.resize(size);
      receiver.resize(count);
      transmitter.resize(count);
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      const SignalLink& link = points[chosen[i]].link;
      receiver_m.row(i) = link.receiver_m.transpose();
      transmitter_m.row(i) = link.transmitter_m.transpose();
      time_s[i] = link.time_s;
      receiver[i] = link.receiver;
      transmitter[i] = link.transmitter;
    }
  }
};

/// Memory that predictions use again and again.
struct ResidualGp::Workspace {
  Columns columns;
  Eigen::MatrixXd matrix, cross;
  Eigen::VectorXd weights;
  Eigen::ArrayXd straight, turned;
};

void ResidualGpOptions::Check() const {
  for (const double value : {place.length_m, place_db, link_db, link_s, offset_db, noise_db})
    if (!(value > 0) || !std::isfinite(value))
      throw Error(
          name + ": a deviation, length or time is " + Shown(value) + "; expected above zero",
          ErrorKind::kUsage);
  for (const double value : {radio_db, merge_m, merge_s})
    if (!(value >= 0) || !std::isfinite(value))
      throw Error(
          name + ": radio_db, merge_m or merge_s is " + Shown(value) + "; expected zero or above",
          ErrorKind::kUsage);
  if (newest + nearest == 0) throw Error(name + ": no points to predict from", ErrorKind::kUsage);
}

ResidualGp::ResidualGp(std::unique_ptr<SignalPredictor> mean, ResidualGpOptions options)
    : mean_(std::move(mean)),
      options_((options.Check(), std::move(options))),
      index_(0.5, options_.merge_m) {}

void ResidualGp::AddMeasurements(Span<const SignalMeasurement> measurements) {
  CheckMeasurements(measurements);
  mean_->AddMeasurements(measurements);
  for (const SignalMeasurement& measurement : measurements)
    if (measurement.is_heard) Merge(measurement);
}

void ResidualGp::Merge(const SignalMeasurement& measurement) {
  const SignalLink& link = measurement.link;
  std::vector<std::uint32_t>& own = of_link_[RadiosOf(link)];
  if (!own.empty()) {
    Point& last = points_[own.back()];
    if (last.link.receiver == link.receiver &&
        link.time_s - last.first.time_s <= options_.merge_s &&
        (link.receiver_m - last.first.receiver_m).norm() <= options_.merge_m &&
        (link.transmitter_m - last.first.transmitter_m).norm() <= options_.merge_m) {
      const double part = 1 / ++last.count;
      last.dbm += part * (measurement.dbm - last.dbm);
      last.link.time_s += part * (link.time_s - last.link.time_s);
      last.link.receiver_m += part * (link.receiver_m - last.link.receiver_m);
      last.link.transmitter_m += part * (link.transmitter_m - last.link.transmitter_m);
      return;
    }
  }
  const auto number = static_cast<std::uint32_t>(points_.size());
  own.push_back(number);
  points_.push_back({link, measurement.dbm, 1, link});
  index_.Add(number, link);
}

void ResidualGp::Covariances(const Columns& points, Eigen::Index from, const SignalLink& link,
                             Workspace* work, Eigen::Ref<Eigen::VectorXd> values) const {
  const Eigen::Index count = values.size();
  const PlaceKernel& place = options_.place;
  const auto distance = [&](const Eigen::ArrayX3d& ends, const Eigen::Vector3d& end) {
    const auto rows = ends.middleRows(from, count);
    return ((rows.col(0) - end.x()).square() + (rows.col(1) - end.y()).square() +
            (rows.col(2) - end.z()).square())
        .sqrt();
  };
  const double variance = Square(options_.place_db);
  if (place.power == 1 && place.support_m == 0) {  // a product of exponentials is one of the sum
    auto straight = work->straight.head(count), turned = work->turned.head(count);
    straight = distance(points.receiver_m, link.receiver_m);
    straight += distance(points.transmitter_m, link.transmitter_m);
    turned = distance(points.receiver_m, link.transmitter_m);
    turned += distance(points.transmitter_m, link.receiver_m);
    straight = (straight / -place.length_m).exp();
    turned = (turned / -place.length_m).exp();
    values = variance / 2 * (straight + turned);
  } else {
    SignalLink other;
    for (Eigen::Index i = 0; i < count; ++i) {
      other.receiver_m = points.receiver_m.row(from + i).transpose();
      other.transmitter_m = points.transmitter_m.row(from + i).transpose();
      values[i] = variance * PairSimilarity(place, other, link);
    }
  }
  const double radio = Square(options_.radio_db);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::uint32_t receiver = points.receiver[from + i],
                        transmitter = points.transmitter[from + i];
    const int shared = (receiver == link.receiver) + (receiver == link.transmitter) +
                       (transmitter == link.receiver) + (transmitter == link.transmitter);
    if (shared == 0) continue;
    values[i] += shared * radio;
    if (shared >= 2)
      values[i] += Square(options_.offset_db) +
                   Square(options_.link_db) *
                       std::exp(-std::abs(points.time_s[from + i] - link.time_s) / options_.link_s);
  }
}

/// Of the process at a link, without noise.
double ResidualGp::Variance(const SignalLink& link) const {
  return Square(options_.place_db) * PairSimilarity(options_.place, link, link) +
         2 * Square(options_.radio_db) + Square(options_.offset_db) + Square(options_.link_db);
}

void ResidualGp::PointsFor(const SignalLink& link,
                           std::vector<std::pair<double, std::uint32_t>>* heap,
                           std::vector<std::uint32_t>* chosen) const {
  const std::size_t begin = chosen->size();
  const auto own = of_link_.find(RadiosOf(link));
  std::uint32_t first_of_newest = UINT32_MAX;
  if (own != of_link_.end() && options_.newest > 0) {
    const auto& mine = own->second;
    const std::size_t count = std::min(options_.newest, mine.size());
    chosen->insert(chosen->end(), mine.end() - static_cast<std::ptrdiff_t>(count), mine.end());
    first_of_newest = (*chosen)[begin];
  }
  const auto radios = RadiosOf(link);
  index_.Nearest(
      link, options_.nearest, [&](std::uint32_t i) -> const SignalLink& { return points_[i].link; },
      [&](std::uint32_t i) { return i < first_of_newest || RadiosOf(points_[i].link) != radios; },
      heap);
  for (const auto& found : *heap) chosen->push_back(found.second);
  std::sort(chosen->begin() + static_cast<std::ptrdiff_t>(begin), chosen->end());
}

void ResidualGp::SetResiduals(const std::vector<std::uint32_t>& points,
                              std::vector<double>* values) const {
  std::vector<SignalLink> links;
  links.reserve(points.size());
  for (const std::uint32_t i : points) links.push_back(points_[i].link);
  std::vector<SignalPrediction> expected(links.size());
  mean_->Predict(links, {expected.data(), expected.size()});
  values->resize(points_.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    (*values)[points[k]] = points_[points[k]].dbm - expected[k].dbm;
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
  std::vector<SignalLink> sorted;
  std::vector<SignalPrediction> answers;
  sorted.reserve(order.size());
  answers.reserve(order.size());
  for (const std::size_t i : order) {
    sorted.push_back(links[i]);
    answers.push_back(predictions[i]);
  }
  // Groups that share their points: where each begins, among the links and among the points.
  std::vector<std::size_t> groups = {0}, firsts = {0};
  std::vector<std::uint32_t> chosen;
  std::vector<std::pair<double, std::uint32_t>> heap;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    for (; end < sorted.size() && end - begin < kTogether; ++end)
      if (RadiosOf(sorted[end]) != RadiosOf(sorted[begin]) ||
          LinkDistance(sorted[end], sorted[begin]) > kTogether_m)
        break;
    PointsFor(sorted[begin + (end - begin) / 2], &heap, &chosen);
    groups.push_back(end);
    firsts.push_back(chosen.size());
  }
  std::vector<std::uint32_t> distinct = chosen;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::vector<double> residuals;
  SetResiduals(distinct, &residuals);
  Workspace work;
  for (std::size_t g = 0; g + 1 < groups.size(); ++g) {
    const std::size_t begin = groups[g], size = groups[g + 1] - begin;
    PredictTogether(chosen.data() + firsts[g], firsts[g + 1] - firsts[g], residuals,
                    {sorted.data() + begin, size}, &work, {answers.data() + begin, size});
  }
  for (std::size_t k = 0; k < order.size(); ++k) predictions[order[k]] = answers[k];
}

bool ResidualGp::Factorise(const std::uint32_t* chosen, std::size_t count, Workspace* work) const {
  const auto size = static_cast<Eigen::Index>(count);
  work->columns.Take(points_, chosen, count);
  if (work->matrix.rows() < size) {
    work->matrix.resize(size, size);
    work->straight.resize(size);
    work->turned.resize(size);
    work->weights.resize(size);
  }
  for (Eigen::Index j = 0; j < size; ++j) {
    const Point& point = points_[chosen[j]];
    Covariances(work->columns, j, point.link, work, work->matrix.col(j).segment(j, size - j));
    work->matrix(j, j) += Square(options_.noise_db) / point.count;
  }
  Eigen::Ref<Eigen::MatrixXd> matrix = work->matrix.topLeftCorner(size, size);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(matrix).info() == Eigen::Success;
}

void ResidualGp::PredictTogether(const std::uint32_t* chosen, std::size_t count,
                                 const std::vector<double>& residuals, Span<const SignalLink> links,
                                 Workspace* work, Span<SignalPrediction> predictions) const {
  if (!Factorise(chosen, count, work)) return;  // not with noise above zero
  const auto size = static_cast<Eigen::Index>(count);
  const auto width = static_cast<Eigen::Index>(links.size());
  if (work->cross.rows() < size || work->cross.cols() < width)
    work->cross.resize(size, static_cast<Eigen::Index>(kTogether));
  auto cross = work->cross.topLeftCorner(size, width);
  auto weights = work->weights.head(size);
  for (Eigen::Index q = 0; q < width; ++q)
    Covariances(work->columns, 0, links[q], work, cross.col(q));
  for (Eigen::Index i = 0; i < size; ++i) weights[i] = residuals[chosen[i]];
  const auto half = work->matrix.topLeftCorner(size, size).triangularView<Eigen::Lower>();
  half.solveInPlace(weights);
  half.solveInPlace(cross);
  for (Eigen::Index q = 0; q < width; ++q) {
    predictions[q].dbm += cross.col(q).dot(weights);
    const double variance = Variance(links[q]) - cross.col(q).squaredNorm();
    predictions[q].sigma_db = std::sqrt(std::max(variance, 0.0) + Square(options_.noise_db));
  }
}

}  // namespace graticule
