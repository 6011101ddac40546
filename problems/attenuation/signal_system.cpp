#include "graticule/problems/attenuation/signal_system.hpp"

#include <cmath>

#include "graticule/problems/attenuation/signal_system_parts.hpp"

namespace graticule {
namespace {

using Lanes = SignalSystem::Lanes;

double Ratio(double a, double b) { return b > 0 ? a / b : 0; }
Lanes Ratio(const Lanes& a, const Lanes& b) { return (b > 0).select(a / b, Lanes::Zero()); }
double Largest(double v) { return v; }
double Largest(const Lanes& v) { return static_cast<double>(v.maxCoeff()); }

template <class V>
V Dot(const std::vector<V>& a, const std::vector<V>& b) {
  V sum;
  SetZero(&sum);
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

std::int32_t SignalSystem::ReceiverBias(RadioBias kind, std::uint32_t radio) {
  if (kind == RadioBias::kNone) return -1;
  const auto r = static_cast<std::int32_t>(radio);
  return kind == RadioBias::kRadio ? 2 + r : 2 + 2 * r;
}

std::int32_t SignalSystem::TransmitterBias(RadioBias kind, std::uint32_t radio) {
  const std::int32_t bias = ReceiverBias(kind, radio);
  return kind == RadioBias::kEnds ? bias + 1 : bias;
}

std::size_t SignalSystem::HeadSize(RadioBias kind, std::uint32_t radios) {
  if (kind == RadioBias::kNone) return 2;
  return 2 + std::size_t{radios} * (kind == RadioBias::kRadio ? 1 : 2);
}

SignalEquation SignalSystem::EquationOf(std::size_t i) const {
  const SignalRow& row = rows_->At(i);
  double weight = row.count / (1 + (row.count - 1) * correlation_);
  if (options_.forget_s > 0) weight *= std::exp((row.time_s - now_s_) / options_.forget_s);
  return {row.log_distance,
          row.dbm,
          weight,
          ReceiverBias(options_.bias, row.receiver),
          TransmitterBias(options_.bias, row.transmitter),
          row.first,
          row.size};
}

void SignalSystem::Set(const SignalRows& rows, double sigma_db, double correlation, double now_s) {
  const std::size_t head = HeadSize(options_.bias, rows.RadioCount());
  is_anew_ = !has_sums_ || is_altered_ || rows_ != &rows || generation_ != rows.Generation() ||
             head_ != head || sigma_db_ != sigma_db || correlation_ != correlation ||
             options_.forget_s > 0;
  rows_ = &rows;
  generation_ = rows.Generation();
  head_ = head;
  sigma_db_ = sigma_db;
  correlation_ = correlation;
  now_s_ = now_s;
  is_altered_ = false;
  changes_.clear();
  cells_before_ = is_anew_ ? 0 : prior_.size() - head_;
  prior_.resize(Size());
  for (std::size_t i = is_anew_ ? 0 : head_ + cells_before_; i < Size(); ++i)
    prior_[i] = PriorWeight(i);
  const std::size_t before = equations_.size();
  equations_.resize(rows.Count());
  if (is_anew_) {
    has_sums_ = false;
    for (std::size_t i = 0; i < rows.Count(); ++i) equations_[i] = EquationOf(i);
    return;
  }
  b_.resize(Size(), 0);
  diagonal_.resize(Size(), 0);
  for (const std::size_t i : rows.Traced()) {
    changes_.push_back({i, {}});
    if (i < before) {
      changes_.back().before = equations_[i];
      AddToSums(equations_[i], -1);
    }
    equations_[i] = EquationOf(i);
    AddToSums(equations_[i], 1);
  }
  AddPriors(cells_before_, head_ + cells_before_);
}

void SignalSystem::AddToSums(const SignalEquation& row, double sign) {
  AddTerms(row, sign * row.weight * row.target_dbm, &b_);
  const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
  const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
  for (std::size_t k = 0; k < row.size; ++k)
    diagonal_[head_ + static_cast<std::size_t>(cell[k])] +=
        sign * row.weight * length[k] * length[k];
}

/// Smoothness and priors of cells from one on, priors of unknowns from another on.
void SignalSystem::AddPriors(std::size_t from_cell, std::size_t from_unknown) {
  const double smooth = SmoothWeight();
  ForNewPairs(from_cell, [&](std::size_t a, std::size_t b, std::uint64_t) {
    diagonal_[head_ + a] += smooth;
    diagonal_[head_ + b] += smooth;
  });
  for (std::size_t i = from_unknown; i < Size(); ++i) {
    b_[i] += prior_[i] * PriorMean(i);
    diagonal_[i] += prior_[i];
  }
}

double SignalSystem::PriorMean(std::size_t i) const {
  if (i == 0) return options_.l0_dbm;
  if (i == 1) return options_.slope_db;
  if (i < head_) return 0;
  return options_.classes[rows_->Cells().At(i - head_).material].rho_db_per_m;
}

double SignalSystem::PriorWeight(std::size_t i) const {
  const auto of = [this](double sigma) { return sigma_db_ * sigma_db_ / (sigma * sigma); };
  if (i == 0) return of(options_.l0_sigma_db);
  if (i == 1) return of(options_.slope_sigma_db);
  if (i < head_) return of(options_.bias_sigma_db);
  return of(options_.sigma_db / options_.classes[rows_->Cells().At(i - head_).material].phi);
}

double SignalSystem::SmoothWeight() const {
  const double weight = options_.lambda * sigma_db_ / options_.sigma_db;
  return weight * weight;
}

double SignalSystem::Predict(const SignalEquation& row, const double* x) const {
  double sum = x[0] - row.log_distance * x[1];
  if (row.receiver >= 0) sum += x[row.receiver] + x[row.transmitter];
  const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
  const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
  for (std::size_t k = 0; k < row.size; ++k)
    sum -= length[k] * x[head_ + static_cast<std::size_t>(cell[k])];
  return sum;
}

template <class V>
void SignalSystem::Multiply(const std::vector<V>& x, std::vector<V>* y) const {
  *y = Zeros<V>(x.size());
  std::vector<V>& to = *y;
  const V unit{};
  const std::int32_t* all_cells = rows_->CellsOf(SignalRow{});
  const double* all_lengths = rows_->LengthsOf(SignalRow{});
  const V* x_cells = x.data() + head_;
  V* to_cells = to.data() + head_;
  // L0 and the slope are in every row: kept out of memory.
  const V l0 = x[0], slope = x[1];
  V zero;
  SetZero(&zero);
  V to_l0 = zero, to_slope = zero;
  for (const SignalEquation& row : equations_) {
    const auto log_distance = Scalar(unit, row.log_distance), weight = Scalar(unit, row.weight);
    const std::int32_t* cell = all_cells + row.first;
    const double* length = all_lengths + row.first;
    // Four at once, in two sums: one addition need not wait for the other.
    V sum = l0 - slope * log_distance, other = zero;
    if (row.receiver >= 0) sum += x[row.receiver] + x[row.transmitter];
    std::size_t k = 0;
    for (; k + 4 <= row.size; k += 4) {
      sum -= x_cells[cell[k]] * Scalar(unit, length[k]);
      other -= x_cells[cell[k + 1]] * Scalar(unit, length[k + 1]);
      sum -= x_cells[cell[k + 2]] * Scalar(unit, length[k + 2]);
      other -= x_cells[cell[k + 3]] * Scalar(unit, length[k + 3]);
    }
    for (; k < row.size; ++k) sum -= x_cells[cell[k]] * Scalar(unit, length[k]);
    sum = (sum + other) * weight;
    to_l0 += sum;
    to_slope -= sum * log_distance;
    if (row.receiver >= 0) {
      to[row.receiver] += sum;
      to[row.transmitter] += sum;
    }
    for (k = 0; k + 4 <= row.size; k += 4) {
      to_cells[cell[k]] -= sum * Scalar(unit, length[k]);
      to_cells[cell[k + 1]] -= sum * Scalar(unit, length[k + 1]);
      to_cells[cell[k + 2]] -= sum * Scalar(unit, length[k + 2]);
      to_cells[cell[k + 3]] -= sum * Scalar(unit, length[k + 3]);
    }
    for (; k < row.size; ++k) to_cells[cell[k]] -= sum * Scalar(unit, length[k]);
  }
  to[0] = to_l0;
  to[1] = to_slope;
  const AttenuationCells& cells = rows_->Cells();
  const auto smooth = Scalar(unit, SmoothWeight());
  for (std::size_t i = 0; i < cells.Count(); ++i)
    for (const std::int32_t other : {cells.Right(i), cells.Up(i)}) {
      if (other < 0) continue;
      const std::size_t a = head_ + i, b = head_ + static_cast<std::size_t>(other);
      const V pull = (x[a] - x[b]) * smooth;
      to[a] += pull;
      to[b] -= pull;
    }
  for (std::size_t i = 0; i < x.size(); ++i) to[i] += x[i] * Scalar(unit, prior_[i]);
}

template <class V>
int SignalSystem::Solve(const std::vector<V>& b, double tolerance, int max_iterations,
                        std::vector<V>* x, LastStep<V>* last) const {
  LastStep<V> none;
  std::vector<V>& direction = (last ? last : &none)->direction;
  std::vector<V>& product = (last ? last : &none)->product;
  V zero;
  SetZero(&zero);
  direction.resize(b.size(), zero);
  product.resize(b.size(), zero);
  std::vector<V> r, z = b;
  Multiply(*x, &r);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
  V along_last = Dot(direction, product);
  int iteration = 0;
  for (;; ++iteration) {
    Precondition(r, &z);
    if (iteration == max_iterations || !(Largest(Dot(r, z)) > tolerance * tolerance)) break;
    const V turn = Ratio(Dot(z, product), along_last);
    for (std::size_t i = 0; i < b.size(); ++i) direction[i] = z[i] - direction[i] * turn;
    Multiply(direction, &product);
    along_last = Dot(direction, product);
    const V step = Ratio(Dot(r, direction), along_last);
    for (std::size_t i = 0; i < b.size(); ++i) {
      (*x)[i] += direction[i] * step;
      r[i] -= product[i] * step;
    }
  }
  return iteration;
}

template int SignalSystem::Solve(const std::vector<double>&, double, int, std::vector<double>*,
                                 LastStep<double>*) const;
template int SignalSystem::Solve(const std::vector<Lanes>&, double, int, std::vector<Lanes>*,
                                 LastStep<Lanes>*) const;

}  // namespace graticule
