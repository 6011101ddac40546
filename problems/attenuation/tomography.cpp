#include "graticule/problems/attenuation/tomography.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "graticule/factors/normal_tail.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kLanes = 16;
constexpr double kGrowth = 1.2;         // samples are drawn anew when rows have grown by this
constexpr double kNoiseGrowth = 1.05;   // noise is estimated anew
constexpr double kSampleGrowth = 1.01;  // sixteen samples are brought up to date
constexpr int kSampleIterationsAnUpdate = 4;
constexpr int kUpdatesASample = 6;        // an iteration of sixteen costs four of the mean's
constexpr double kSampleTolerance = .01;  // of sums of about as many squares as there are unknowns
constexpr int kSampleIterations = 200;
constexpr int kRounds = 6;
constexpr double kHastyShare = .01;  // of all noise: enough to know the noise to 1e-4

}  // namespace

std::uint64_t Tomography::SeedOf(std::size_t lane) const { return options_.seed * 1000 + lane; }

Tomography::Tomography(TomographyOptions options)
    : options_((options.Check(), std::move(options))),
      rows_(options_),
      system_(options_),
      sigma_db_(options_.sigma_db),
      correlation_(std::max(0.0, options_.correlation)),
      weight_sigma_db_(sigma_db_),
      weight_correlation_(correlation_) {
  TakeRows(0);
  TakeUnknowns(true);
  UpdatePosterior(true);
}

void Tomography::SetMap(std::shared_ptr<const OccupancyGrid> map) {
  if (!options_.uses_map) return;
  SetClassMap(map ? std::make_shared<const ClassMap>(*map, options_.class_of) : nullptr);
}

void Tomography::SetClassMap(std::shared_ptr<const ClassMap> map) {
  if (map && map->ClassCount() > static_cast<int>(options_.classes.size()) &&
      !options_.classes.empty())
    throw Error("a map of " + std::to_string(map->ClassCount()) + " classes; " +
                std::to_string(options_.classes.size()) + " have a prior");
  rows_.SetMap(std::move(map));
  book_.Clear();
}

void Tomography::AddMeasurements(Span<const SignalMeasurement> measurements) {
  rows_.Add(measurements);
}

void Tomography::TakeRows(double now_s) {
  system_.Set(rows_, weight_sigma_db_, weight_correlation_, now_s);
  for (std::size_t at = 0; at < perturbed_.size(); ++at) {
    if (system_.IsAnew()) {
      perturbed_[at].clear();
    } else if (!perturbed_[at].empty()) {
      system_.Perturb(SeedOf(at), &perturbed_[at]);
    }
  }
}

/// Brings x_ to the unknowns that there are now, with what was learnt of those that were.
void Tomography::TakeUnknowns(bool is_anew) {
  const std::vector<double> old = std::move(x_);
  const std::size_t old_head = head_.size(), head = system_.HeadSize();
  x_.assign(system_.Size(), 0);
  std::vector<std::int64_t> from(x_.size(), -1);
  for (std::size_t i = 0; i < std::min(head, old_head); ++i) from[i] = static_cast<std::int64_t>(i);
  if (!is_anew) {  // numbers kept
    for (std::size_t i = 0; old_head + i < old.size() && head + i < from.size(); ++i)
      from[head + i] = static_cast<std::int64_t>(old_head + i);
  } else {
    for (std::size_t i = 0; i < cells_.Count(); ++i) {
      const AttenuationCell& cell = cells_.At(i);
      const std::int32_t now = rows_.Cells().Find(cell.material, cell.x, cell.y);
      if (now >= 0)
        from[head + static_cast<std::size_t>(now)] = static_cast<std::int64_t>(old_head + i);
    }
  }
  for (std::size_t i = 0; i < x_.size(); ++i)
    x_[i] = from[i] >= 0 ? old[static_cast<std::size_t>(from[i])] : system_.PriorMean(i);
  for (auto& lanes : lanes_) {
    const std::vector<SignalSystem::Lanes> was = std::move(lanes);
    lanes.assign(x_.size(), SignalSystem::Lanes::Zero());
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (from[i] >= 0) lanes[i] = was[static_cast<std::size_t>(from[i])];
  }
  if (is_anew || head != old_head) {
    last_step_ = {};
    last_lane_steps_.assign(last_lane_steps_.size(), {});
  }
  head_.resize(head);
}

void Tomography::Update(double now_s) {
  last_iterations_ = 0;
  const bool is_anew = rows_.Trace();
  TakeRows(now_s);
  if (is_anew || x_.size() != system_.Size()) TakeUnknowns(is_anew);
  const double size = static_cast<double>(rows_.EntryCount() + rows_.Count());
  const bool is_batch = is_anew || size > kGrowth * size_at_update_;
  const int most = is_batch ? options_.max_iterations : options_.update_iterations;
  const bool is_noise_due = is_batch || size > kNoiseGrowth * size_at_noise_;
  const bool all_samples = is_batch || lanes_.empty();
  size_at_update_ = size;
  const double hasty = kHastyShare * sigma_db_ * std::sqrt(static_cast<double>(rows_.Count()));
  // Weights depend on the noise that the solution leaves: to and fro, at first without haste.
  for (int round = 0; is_batch && options_.estimate_sigma && round < kRounds; ++round) {
    SolveMean(now_s, std::max(options_.tolerance, hasty), most);
    if (round == 0) UpdatePosterior(false);
    if (!EstimateNoise()) break;
    TakeRows(now_s);
  }
  SolveMean(now_s, options_.tolerance, most);
  UpdatePosterior(all_samples);
  if (options_.estimate_sigma && is_noise_due) {
    size_at_noise_ = size;
    if (EstimateNoise()) {
      TakeRows(now_s);
      SolveMean(now_s, options_.tolerance, most);
    }
  }
  if (is_anew || cells_.Count() != rows_.Cells().Count()) cells_ = rows_.Cells();
  head_.assign(x_.begin(), x_.begin() + static_cast<std::ptrdiff_t>(system_.HeadSize()));
  attenuation_.assign(x_.begin() + static_cast<std::ptrdiff_t>(system_.HeadSize()), x_.end());
}

/// Weights and targets of rows whose residual does not count by its square: a step of Newton's
/// method for packets not heard, of iterated weights for a loss.
void Tomography::Linearise() {
  std::vector<SignalEquation>& equations = system_.ChangeEquations();
  for (std::size_t i = 0; i < rows_.Count(); ++i) {
    const SignalRow& row = rows_.At(i);
    SignalEquation& equation = equations[i];
    const double predicted = system_.Predict(equation, x_.data());
    if (!row.is_heard) {
      // -log Phi(z), z = (floor - predicted) / sigma: slope -h, curvature h (h + z) by z.
      const double z = (row.dbm - predicted) / sigma_db_;
      const double hazard = NormalHazard(z), curvature = std::max(hazard * (hazard + z), 1e-12);
      equation.target_dbm = predicted - sigma_db_ * hazard / curvature;
      equation.weight *= curvature;
    } else if (options_.loss.kind != LossKind::kNone) {
      const double off = (row.dbm - predicted) / sigma_db_;
      double rho[3];
      EvaluateLoss(options_.loss, equation.weight * off * off, rho);
      equation.weight *= rho[1];
    }
  }
}

void Tomography::SolveMean(double now_s, double tolerance, int most) {
  const bool is_linear = options_.loss.kind == LossKind::kNone && rows_.AllHeard();
  for (int round = 0; round < (is_linear ? 1 : 50); ++round) {
    const std::vector<double> before = x_;
    if (!is_linear) {
      TakeRows(now_s);
      Linearise();
    }
    system_.Prepare();
    last_iterations_ += system_.Solve(system_.RightHandSide(), tolerance, most, &x_, &last_step_);
    double moved = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
      moved = std::max(moved, std::abs(x_[i] - before[i]));
    if (moved < tolerance) break;
  }
}

/// Noise of two kinds: what measurements from one place have in common, and what they have not.
bool Tomography::EstimateNoise() {
  CountDegreesOfFreedom();
  const auto has_changed = [&] {
    if (std::abs(sigma_db_ - weight_sigma_db_) <= 0.01 * weight_sigma_db_ &&
        std::abs(correlation_ - weight_correlation_) <= 0.02)
      return false;
    weight_sigma_db_ = sigma_db_;
    weight_correlation_ = correlation_;
    return true;
  };
  double rows = 0, inverse = 0, left = 0, within = 0, spare = 0, weighted = 0;
  for (std::size_t i = 0; i < rows_.Count(); ++i) {
    const SignalRow& row = rows_.At(i);
    if (!row.is_heard) continue;
    const double off = row.dbm - system_.Predict(system_.Equations()[i], x_.data());
    rows += 1;
    inverse += 1 / row.count;
    left += off * off;
    weighted += row.count / (1 + (row.count - 1) * correlation_) * off * off;
    within += row.scatter;
    spare += row.count - 1;
  }
  const double believed = options_.sigma_weight * options_.sigma_db * options_.sigma_db;
  const double rows_left = std::max(0.0, rows - degrees_of_freedom_);
  if (options_.correlation >= 0) {
    // Whitened: a row's own square and its scatter, each of noise 1.
    const double own = 1 - correlation_;
    const double sum = weighted + (own > 0 ? within / own : 0);
    sigma_db_ =
        std::sqrt((believed + sum) / (options_.sigma_weight + rows_left + (own > 0 ? spare : 0)));
    return has_changed();
  }
  if (spare < options_.sigma_weight) {
    sigma_db_ = std::sqrt((believed + left) / (options_.sigma_weight + rows_left));
    correlation_ = 0;
    return has_changed();
  }
  const double own = within / spare;
  const double share = rows > 0 ? rows_left / rows : 0;
  const double common = std::max(0.0, (left - own * inverse * share) / std::max(1.0, rows_left));
  const double measured = common + own;
  sigma_db_ = std::sqrt((believed + rows_left * measured) / (options_.sigma_weight + rows_left));
  correlation_ = std::min(0.99, common / std::max(measured, 1e-12));
  return has_changed();
}

void Tomography::RefreshPosterior() { UpdatePosterior(true); }

void Tomography::UpdatePosterior(bool all) {
  const std::size_t size = x_.size(), count = static_cast<std::size_t>(options_.samples) / kLanes;
  is_exact_ = size <= static_cast<std::size_t>(options_.exact_up_to);
  if (is_exact_) {
    lanes_.clear();
    perturbed_.clear();
    InvertPosterior();
    return;
  }
  if (lanes_.size() != count) {
    lanes_.assign(count, std::vector<SignalSystem::Lanes>(size, SignalSystem::Lanes::Zero()));
    perturbed_.assign(count, {});
    last_lane_steps_.assign(count, {});
    lane_size_.assign(count, 0);
    all = true;
  }
  const double entries = static_cast<double>(rows_.EntryCount() + rows_.Count());
  const double tolerance = kSampleTolerance * std::sqrt(static_cast<double>(size));
  if (!all && ++updates_ % kUpdatesASample != 0) return;
  for (std::size_t turn = 0; turn < count; ++turn) {
    const std::size_t at = next_lane_;
    if (!all && entries < kSampleGrowth * lane_size_[at]) break;
    if (perturbed_[at].empty()) system_.Perturb(SeedOf(at), &perturbed_[at]);
    const int most = all ? kSampleIterations : kSampleIterationsAnUpdate;
    fresh_lane_ = at;
    // What is left to do is left to its next turn: none waits for one that is never done.
    if (system_.Solve(perturbed_[at], tolerance, most, &lanes_[at], &last_lane_steps_[at]) < most)
      lane_size_[at] = entries;
    next_lane_ = (at + 1) % count;
    if (!all) break;
  }
}

void Tomography::InvertPosterior() {
  const Eigen::MatrixXd dense = system_.Dense();
  covariance_ = dense.llt().solve(Eigen::MatrixXd::Identity(dense.rows(), dense.cols()));
}

/// How many of the measurements' squares the unknowns take up: the trace of N^-1 A'WA.
void Tomography::CountDegreesOfFreedom() {
  if (!is_exact_) {
    if (lanes_.empty()) return;
    degrees_of_freedom_ =
        std::clamp(system_.DegreesOfFreedom(SeedOf(fresh_lane_), lanes_[fresh_lane_]), 0.0,
                   0.9 * static_cast<double>(rows_.Count()));
    return;
  }
  if (covariance_.rows() != static_cast<Eigen::Index>(x_.size())) return;
  degrees_of_freedom_ = static_cast<double>(x_.size());
  for (std::size_t i = 0; i < x_.size(); ++i)
    degrees_of_freedom_ -= system_.PriorWeight(i) * VarianceOf(i);
  const AttenuationCells& cells = rows_.Cells();
  for (std::size_t i = 0; i < cells.Count(); ++i)
    for (const std::int32_t other : {cells.Right(i), cells.Up(i)}) {
      if (other < 0) continue;
      const auto a = static_cast<Eigen::Index>(system_.HeadSize() + i);
      const auto b = static_cast<Eigen::Index>(system_.HeadSize()) + other;
      degrees_of_freedom_ -=
          system_.SmoothWeight() * (covariance_(a, a) + covariance_(b, b) - 2 * covariance_(a, b));
    }
}

double Tomography::VarianceOf(std::size_t unknown) const {
  if (is_exact_) {
    const auto i = static_cast<Eigen::Index>(unknown);
    return covariance_(i, i);
  }
  double sum = 0;
  for (const auto& lanes : lanes_) sum += static_cast<double>(lanes[unknown].square().mean());
  return lanes_.empty() ? 0 : sum / static_cast<double>(lanes_.size());
}

}  // namespace graticule
