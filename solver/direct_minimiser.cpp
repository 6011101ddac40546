#include "graticule/solver/direct_minimiser.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "graticule/solver/normal_equations.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

// The step of an old factorisation is taken where the new equations would have it between so much
// and so much as long: the two then hardly differ where it matters.
constexpr double kLeastStretch = 0.8, kMostStretch = 1.25;
// ... and is believed where it gains at least so much of what it promised.
constexpr double kReuseKeeps = 0.75;
// The gain of a step not taken is known to a digit at least: so far below the tolerance it is.
constexpr double kSurelyBelow = 0.1;
// From this radius on damping changes no step.
constexpr double kHardlyDamped = 1e10;
constexpr int kInvalidSteps = 5;  // in a row, as Ceres
constexpr double kLeastRadius = 1e-32;

double Dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double LargestOf(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

template <class... Values>
std::string Text(const char* format, Values... values) {
  char text[160];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

// What is added to the diagonal: that of the Jacobian's scaled columns, within bounds, over the
// radius of the trust region.
class Damping {
 public:
  void Prepare(const SolveOptions& options, const std::vector<double>& diagonal) {
    if (options.method == Method::kGaussNewton) least_ = std::numeric_limits<double>::min();
    for (const double value : diagonal) {
      const double scale = options.jacobi_scaling ? 1 / (1 + std::sqrt(value)) : 1;
      square_of_scale_.push_back(scale * scale);
    }
  }
  double Of(std::size_t i, double diagonal, double radius) const {
    const double scaled = std::clamp(diagonal * square_of_scale_[i], least_, 1e32);
    return scaled / (radius * square_of_scale_[i]);
  }

 private:
  double least_ = 1e-6;
  std::vector<double> square_of_scale_;
};

}  // namespace

class DirectMinimiser::Machine {
 public:
  Machine(const Evaluation& evaluation, const SolveOptions& options,
          const std::optional<Loss>& replaced, const std::vector<char>& is_held,
          std::vector<double>* data)
      : options_(options),
        equations_(evaluation, replaced, is_held, options.threads),
        x_(*data),
        candidate_(*data) {}

  void Run(const Observer& watch, Report* report);

  std::vector<double> initial_chi2;
  std::vector<double> FinalChi2() const {
    return is_current_ ? equations_.Chi2() : std::vector<double>();
  }

 private:
  bool IsUndamped() const { return options_.method == Method::kGaussNewton; }
  double Tolerance() const { return options_.function_tolerance * objective_; }
  bool Linearise(const std::vector<double>& at, double* objective);
  bool Evaluate(const std::vector<double>& at, double* objective);
  bool SolveForStep();
  bool ReuseFactor();
  bool Factorise();
  bool TryStep();
  void Shorten();
  void Damp();
  bool End(Termination termination, std::string message);
  bool HasConverged();
  bool HasConverged(bool is_valid);
  bool Record(const Observer& watch);

  const SolveOptions& options_;
  NormalEquations equations_;
  std::vector<double>& x_;
  std::vector<double> candidate_, step_, product_, diagonal_, damped_;
  Damping damping_;
  double radius_ = 0, most_radius_ = 0, decrease_factor_ = 2;

  double objective_ = 0;
  double promise_ = 0;      // what the step should gain
  double reached_ = 0;      // the objective where it leads; infinite where there is none
  bool is_reused_ = false;  // it is an old factorisation's
  bool is_shortened_ = false;
  bool has_factor_ = false;   // of an accepted point, and hardly damped
  bool is_current_ = true;    // the equations are those at x
  bool is_cautious_ = false;  // a step failed: look before the equations are made
  int invalid_ = 0;           // steps in a row that could not be solved for

  Stopwatch total_, clock_;
  Iteration row_;
  Report* report_ = nullptr;
};

bool DirectMinimiser::Machine::End(Termination termination, std::string message) {
  report_->termination = termination;
  report_->message = std::move(message);
  return true;
}

bool DirectMinimiser::Machine::Linearise(const std::vector<double>& at, double* objective) {
  clock_.Restart();
  const bool good = equations_.Linearise(at.data(), objective) && std::isfinite(*objective);
  report_->timing.evaluate += clock_.Elapsed().wall;
  return good;
}

bool DirectMinimiser::Machine::Evaluate(const std::vector<double>& at, double* objective) {
  clock_.Restart();
  const bool good = equations_.Objective(at.data(), objective) && std::isfinite(*objective);
  report_->timing.evaluate += clock_.Elapsed().wall;
  return good;
}

bool DirectMinimiser::Machine::SolveForStep() {
  step_ = equations_.Gradient();
  for (double& value : step_) value = -value;
  return equations_.System().SolveFactorised(step_.data(), 1);
}

// The step of the last factorisation, where it will do.  Ends where it would not matter.
bool DirectMinimiser::Machine::ReuseFactor() {
  is_reused_ = false;
  if (!has_factor_ || !SolveForStep()) return false;
  // Along it the new equations are least at `stretch` times its length.
  const double slope = -Dot(step_, equations_.Gradient());
  equations_.System().Multiply(step_, &product_);
  const double stretch = slope / Dot(step_, product_);
  const double gain = 0.5 * std::max(1.0, stretch) * slope;
  if (gain <= kSurelyBelow * Tolerance())
    return End(Termination::kConverged,
               Text("function tolerance reached: a further step would gain %.3g of the "
                    "objective, tolerance %.3g",
                    gain / objective_, options_.function_tolerance));
  is_reused_ = stretch >= kLeastStretch && stretch <= kMostStretch;
  promise_ = 0.5 * stretch * slope;
  for (double& value : step_) value *= stretch;
  return false;
}

// The step of the damped equations.
bool DirectMinimiser::Machine::Factorise() {
  BlockSystem& system = equations_.System();
  system.CopyDiagonal(&diagonal_);
  damped_ = diagonal_;
  for (std::size_t i = 0; i < damped_.size(); ++i)
    damped_[i] += damping_.Of(i, diagonal_[i], radius_);
  system.SetDiagonal(damped_);
  const bool good = system.Factorise() && SolveForStep();
  system.SetDiagonal(diagonal_);
  has_factor_ = good && options_.reuse_factorisation && radius_ >= kHardlyDamped;
  if (!good) return false;
  promise_ = -0.5 * Dot(step_, equations_.Gradient());
  for (std::size_t i = 0; i < step_.size(); ++i)
    promise_ += 0.5 * step_[i] * step_[i] * (damped_[i] - diagonal_[i]);
  return promise_ > 0;
}

// Where the step leads.  True where it gains enough to be accepted.
bool DirectMinimiser::Machine::TryStep() {
  equations_.Plus(x_.data(), step_.data(), candidate_.data());
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  if (is_cautious_) {
    if (!Evaluate(candidate_, &reached_)) reached_ = kNowhere;
  } else {
    if (!Linearise(candidate_, &reached_)) reached_ = kNowhere;
    is_current_ = false;
  }
  if (reached_ > objective_ && !is_reused_ && radius_ >= kHardlyDamped) {
    Shorten();
    if (!Evaluate(candidate_, &reached_)) reached_ = kNowhere;
  }
  return (objective_ - reached_) / promise_ > (is_reused_ ? kReuseKeeps : 1e-3);
}

// As far as the parabola through what is known says.
void DirectMinimiser::Machine::Shorten() {
  const double share = std::clamp(promise_ / (reached_ - objective_ + 2 * promise_), 0.1, 0.5);
  for (double& value : step_) value *= share;
  promise_ *= share * (2 - share);
  equations_.Plus(x_.data(), step_.data(), candidate_.data());
  is_shortened_ = is_cautious_ = true;
}

void DirectMinimiser::Machine::Damp() {
  radius_ /= decrease_factor_;
  decrease_factor_ *= 2;
}

// Before a step.
bool DirectMinimiser::Machine::HasConverged() {
  if (equations_.Size() == 0) return End(Termination::kConverged, "nothing is free to move");
  if (row_.gradient_max_norm <= options_.gradient_tolerance)
    return End(Termination::kConverged, Text("gradient tolerance reached: %.3g <= %.3g",
                                             row_.gradient_max_norm, options_.gradient_tolerance));
  return false;
}

// After it.
bool DirectMinimiser::Machine::HasConverged(bool is_valid) {
  if (!is_valid) return false;
  if (row_.step_norm <=
      options_.parameter_tolerance * (equations_.Norm(x_.data()) + options_.parameter_tolerance))
    return End(Termination::kConverged,
               Text("parameter tolerance reached: a step of %.3g", row_.step_norm));
  if (std::isfinite(reached_) && (row_.accepted || !is_reused_) &&
      std::abs(row_.objective_change) <= Tolerance())
    return End(Termination::kConverged,
               Text("function tolerance reached: %.3g of the objective, tolerance %.3g",
                    row_.objective_change / objective_, options_.function_tolerance));
  if (radius_ < kLeastRadius)
    return End(Termination::kConverged, "the trust region shrank to nothing");
  return false;
}

// True where the observer said stop.
bool DirectMinimiser::Machine::Record(const Observer& watch) {
  row_.objective = objective_;
  row_.trust_region_radius = radius_;
  row_.seconds = total_.Elapsed().wall;
  report_->final_objective = objective_;
  report_->iterations.push_back(row_);
  if (!watch.on_iteration || watch.on_iteration(row_)) return false;
  return End(Termination::kCancelled, "the observer said stop");
}

void DirectMinimiser::Machine::Run(const Observer& watch, Report* report) {
  report_ = report;
  report->linear_solver =
      std::string("block_normal_cholesky (") + equations_.System().Factoriser() + ")";
  report->parameters = static_cast<std::size_t>(equations_.Size());
  report->initial_objective = report->final_objective = std::numeric_limits<double>::quiet_NaN();
  radius_ = IsUndamped() ? 1e32 : options_.initial_trust_region_radius;
  most_radius_ = std::max(radius_, options_.max_trust_region_radius);

  if (!Linearise(x_, &objective_)) {
    is_current_ = false;
    End(Termination::kFailed, "the initial residuals and Jacobians could not be evaluated");
    return;
  }
  equations_.System().CopyDiagonal(&diagonal_);
  damping_.Prepare(options_, diagonal_);
  report->initial_objective = objective_;
  initial_chi2 = equations_.Chi2();
  row_.gradient_max_norm = LargestOf(equations_.Gradient());
  if (Record(watch)) return;

  while (!HasConverged()) {
    if (double same = 0; !is_current_ && !Linearise(x_, &same)) {
      End(Termination::kFailed, "the Jacobians could not be evaluated");
      return;
    }
    is_current_ = true;
    clock_.Restart();
    bool ended = ReuseFactor();
    if (!ended && ++row_.number > options_.max_iterations)
      ended = End(Termination::kNoConvergence,
                  Text("the limit of %d iterations was reached", options_.max_iterations));
    if (!ended && options_.time_limit_s > 0 && total_.Elapsed().wall > options_.time_limit_s)
      ended = End(Termination::kTimeLimit,
                  Text("the limit of %g s was reached", options_.time_limit_s));
    const bool is_valid = !ended && (is_reused_ || Factorise());
    report->timing.linear_solve += clock_.Elapsed().wall;
    if (ended) return;

    is_shortened_ = false;
    row_.accepted = is_valid && TryStep();
    row_.reused_factor = is_reused_;
    row_.step_norm = is_valid ? std::sqrt(Dot(step_, step_)) : 0;
    row_.objective_change = is_valid && std::isfinite(reached_) ? objective_ - reached_ : 0;
    if (row_.accepted) {
      const double quality = row_.objective_change / promise_;
      x_.swap(candidate_);
      objective_ = reached_;
      if (is_cautious_ && !Linearise(x_, &reached_)) {
        End(Termination::kFailed, "the Jacobians could not be evaluated");
        return;
      }
      is_current_ = true;
      is_cautious_ = false;
      row_.gradient_max_norm = LargestOf(equations_.Gradient());
      if (!is_reused_ && !is_shortened_) {
        radius_ =
            std::min(most_radius_, radius_ / std::max(1.0 / 3, 1 - std::pow(2 * quality - 1, 3)));
        decrease_factor_ = 2;
      }
    } else {
      has_factor_ = false;
      if (!is_reused_) {
        is_cautious_ = true;
        Damp();
      }
    }
    if (Record(watch)) return;
    invalid_ = is_valid ? 0 : invalid_ + 1;
    if (invalid_ >= kInvalidSteps) {
      End(Termination::kFailed, "the normal equations are not positive definite");
      return;
    }
    if (HasConverged(is_valid)) return;
  }
}

bool DirectMinimiser::Serves(const SolveOptions& options) {
  return (options.method == Method::kLevenbergMarquardt ||
          options.method == Method::kGaussNewton) &&
         (options.linear_solver == LinearSolver::kAutomatic ||
          options.linear_solver == LinearSolver::kSparseNormalCholesky) &&
         options.linear_algebra == LinearAlgebra::kSuiteSparse && !options.nonmonotonic_steps;
}

DirectMinimiser::DirectMinimiser(const Evaluation& evaluation, const SolveOptions& options,
                                 const std::optional<Loss>& replaced,
                                 const std::vector<char>& is_held, std::vector<double>* data)
    : machine_(std::make_unique<Machine>(evaluation, options, replaced, is_held, data)) {}

DirectMinimiser::~DirectMinimiser() = default;

void DirectMinimiser::Run(const Observer& watch, Report* report) { machine_->Run(watch, report); }

std::vector<double> DirectMinimiser::TakeInitialChi2() { return std::move(machine_->initial_chi2); }

std::vector<double> DirectMinimiser::TakeFinalChi2() { return machine_->FinalChi2(); }

}  // namespace graticule
