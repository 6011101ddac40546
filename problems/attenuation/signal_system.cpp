#include "graticule/problems/attenuation/signal_system.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace graticule {
namespace {

using Lanes = SignalSystem::Lanes;

constexpr std::int32_t kBlock = 4;  // cells, a side of a block that moves together
constexpr std::size_t kMostBlocks = 160;

double Scalar(double, double value) { return value; }
float Scalar(const Lanes&, double value) { return static_cast<float>(value); }
void SetZero(double* v) { *v = 0; }
void SetZero(Lanes* v) { v->setZero(); }

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

template <class V>
std::vector<V> Zeros(std::size_t size) {
  V zero;
  SetZero(&zero);
  return std::vector<V>(size, zero);
}

/// Sixteen signs (Steele, Lea, Flood 2014, as in problems/random.hpp) for one term.
Lanes Signs(std::uint64_t seed, std::uint64_t kind, std::uint64_t index) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + kind * 0xd1342543de82ef95u + index + 1;
  for (int i = 0; i < 2; ++i) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    z += 0x9e3779b97f4a7c15u;
  }
  Lanes signs;
  for (int lane = 0; lane < 16; ++lane) signs[lane] = (z >> (lane + 20)) & 1 ? 1.f : -1.f;
  return signs;
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

void SignalSystem::Set(const SignalRows& rows, double sigma_db, double correlation, double now_s) {
  rows_ = &rows;
  sigma_db_ = sigma_db;
  head_ = HeadSize(options_.bias, rows.RadioCount());
  prior_.resize(Size());
  for (std::size_t i = 0; i < prior_.size(); ++i) prior_[i] = PriorWeight(i);
  equations_.resize(rows.Count());
  for (std::size_t i = 0; i < rows.Count(); ++i) {
    const SignalRow& row = rows.At(i);
    double weight = row.count / (1 + (row.count - 1) * correlation);
    if (options_.forget_s > 0) weight *= std::exp((row.time_s - now_s) / options_.forget_s);
    equations_[i] = {row.log_distance,
                     row.dbm,
                     weight,
                     ReceiverBias(options_.bias, row.receiver),
                     TransmitterBias(options_.bias, row.transmitter),
                     row.first,
                     row.size};
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
  for (const SignalEquation& row : equations_) {
    const auto log_distance = Scalar(unit, row.log_distance), weight = Scalar(unit, row.weight);
    const std::int32_t* cell = all_cells + row.first;
    const double* length = all_lengths + row.first;
    V sum = x[0] - x[1] * log_distance;
    if (row.receiver >= 0) sum += x[row.receiver] + x[row.transmitter];
    for (std::size_t k = 0; k < row.size; ++k)
      sum -= x[head_ + static_cast<std::size_t>(cell[k])] * Scalar(unit, length[k]);
    sum *= weight;
    to[0] += sum;
    to[1] -= sum * log_distance;
    if (row.receiver >= 0) {
      to[row.receiver] += sum;
      to[row.transmitter] += sum;
    }
    for (std::size_t k = 0; k < row.size; ++k)
      to[head_ + static_cast<std::size_t>(cell[k])] -= sum * Scalar(unit, length[k]);
  }
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

void SignalSystem::Prepare() {
  const AttenuationCells& cells = rows_->Cells();
  b_.assign(Size(), 0);
  std::vector<double>& diagonal = inverse_diagonal_;
  diagonal.assign(Size(), 0);
  for (const SignalEquation& row : equations_) {
    const double pull = row.weight * row.target_dbm;
    b_[0] += pull;
    b_[1] -= pull * row.log_distance;
    if (row.receiver >= 0) {
      b_[static_cast<std::size_t>(row.receiver)] += pull;
      b_[static_cast<std::size_t>(row.transmitter)] += pull;
    }
    const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
    const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
    for (std::size_t k = 0; k < row.size; ++k) {
      const std::size_t at = head_ + static_cast<std::size_t>(cell[k]);
      b_[at] -= pull * length[k];
      diagonal[at] += row.weight * length[k] * length[k];
    }
  }
  const double smooth = SmoothWeight();
  for (std::size_t i = 0; i < cells.Count(); ++i)
    for (const std::int32_t other : {cells.Right(i), cells.Up(i)}) {
      if (other < 0) continue;
      diagonal[head_ + i] += smooth;
      diagonal[head_ + static_cast<std::size_t>(other)] += smooth;
    }
  for (std::size_t i = 0; i < Size(); ++i) {
    b_[i] += prior_[i] * PriorMean(i);
    diagonal[i] = 1 / (diagonal[i] + prior_[i]);
  }
  // A preconditioner need not be of the latest rows; it must fit the unknowns.
  const std::size_t size = rows_->EntryCount() + equations_.size();
  if (coarse_at_head_ != head_ || coarse_at_cells_ > cells.Count() || size < coarse_at_entries_ ||
      5 * size > 6 * coarse_at_entries_) {
    MakeCoarse();
    coarse_at_entries_ = size;
  } else if (block_of_.size() < cells.Count()) {
    block_of_.resize(cells.Count(), -1);
  }
}

void SignalSystem::MakeCoarse() {
  const AttenuationCells& cells = rows_->Cells();
  coarse_at_head_ = head_;
  coarse_at_cells_ = cells.Count();
  std::size_t blocks = 0;
  for (std::int32_t side = kBlock;; side *= 2) {
    std::map<std::tuple<std::uint32_t, std::int32_t, std::int32_t>, std::int32_t> found;
    block_of_.resize(cells.Count());
    const auto floored = [side](std::int32_t v) {
      return v >= 0 ? v / side : -((-v - 1) / side) - 1;
    };
    for (std::size_t i = 0; i < cells.Count(); ++i) {
      const AttenuationCell& cell = cells.At(i);
      const auto key = std::make_tuple(cell.material, floored(cell.x), floored(cell.y));
      block_of_[i] = found.emplace(key, static_cast<std::int32_t>(found.size())).first->second;
    }
    blocks = found.size();
    if (blocks <= kMostBlocks || side > (1 << 28)) break;
  }
  const Eigen::MatrixXd coarse = Condensed(block_of_, blocks);
  coarse_inverse_ = coarse.llt().solve(Eigen::MatrixXd::Identity(coarse.rows(), coarse.cols()));
}

Eigen::MatrixXd SignalSystem::Condensed(const std::vector<std::int32_t>& block_of,
                                        std::size_t blocks) const {
  const AttenuationCells& cells = rows_->Cells();
  const auto size = static_cast<Eigen::Index>(head_ + blocks);
  Eigen::MatrixXd coarse = Eigen::MatrixXd::Zero(size, size);
  std::vector<std::pair<Eigen::Index, double>> terms;
  for (const SignalEquation& row : equations_) {
    terms.assign({{0, 1.0}, {1, -row.log_distance}});
    if (row.receiver >= 0) {
      terms.emplace_back(row.receiver, 1.0);
      terms.emplace_back(row.transmitter, 1.0);
    }
    const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
    const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
    const std::size_t before = terms.size();
    for (std::size_t k = 0; k < row.size; ++k) {
      const auto block =
          static_cast<Eigen::Index>(head_) + block_of[static_cast<std::size_t>(cell[k])];
      std::size_t at = before;
      while (at < terms.size() && terms[at].first != block) ++at;
      if (at == terms.size()) terms.emplace_back(block, 0.0);
      terms[at].second -= length[k];
    }
    for (const auto& [i, a] : terms)
      for (const auto& [j, b] : terms) coarse(i, j) += row.weight * a * b;
  }
  const double smooth = SmoothWeight();
  for (std::size_t i = 0; i < cells.Count(); ++i) {
    const auto a = static_cast<Eigen::Index>(head_) + block_of[i];
    coarse(a, a) += PriorWeight(head_ + i);
    for (const std::int32_t other : {cells.Right(i), cells.Up(i)}) {
      if (other < 0) continue;
      const auto b = static_cast<Eigen::Index>(head_) + block_of[static_cast<std::size_t>(other)];
      if (a == b) continue;
      coarse(a, a) += smooth;
      coarse(b, b) += smooth;
      coarse(a, b) -= smooth;
      coarse(b, a) -= smooth;
    }
  }
  for (std::size_t i = 0; i < head_; ++i)
    coarse(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += PriorWeight(i);
  return coarse;
}

Eigen::MatrixXd SignalSystem::Dense() const {
  std::vector<std::int32_t> each(rows_->Cells().Count());
  std::iota(each.begin(), each.end(), 0);
  return Condensed(each, each.size());
}

template <class V>
void SignalSystem::Precondition(const std::vector<V>& r, std::vector<V>* z) const {
  const V unit{};
  const auto size = static_cast<std::size_t>(coarse_inverse_.rows());
  std::vector<V> sums = Zeros<V>(size), moves = Zeros<V>(size);
  for (std::size_t i = 0; i < head_; ++i) sums[i] = r[i];
  for (std::size_t i = head_; i < r.size(); ++i) {
    const std::int32_t block = block_of_[i - head_];
    if (block >= 0) sums[head_ + static_cast<std::size_t>(block)] += r[i];
  }
  for (std::size_t j = 0; j < size; ++j) {
    const double* column = coarse_inverse_.data() + j * size;
    const V sum = sums[j];
    for (std::size_t i = 0; i < size; ++i) moves[i] += sum * Scalar(unit, column[i]);
  }
  for (std::size_t i = 0; i < head_; ++i) (*z)[i] = moves[i];
  for (std::size_t i = head_; i < r.size(); ++i) {
    const std::int32_t block = block_of_[i - head_];
    (*z)[i] = r[i] * Scalar(unit, inverse_diagonal_[i]);
    if (block >= 0) (*z)[i] += moves[head_ + static_cast<std::size_t>(block)];
  }
}

template <class V>
int SignalSystem::Solve(const std::vector<V>& b, double tolerance, int max_iterations,
                        std::vector<V>* x) const {
  std::vector<V> r, z = b, direction, product;
  Multiply(*x, &r);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
  Precondition(r, &z);
  direction = z;
  V along = Dot(r, z);
  int iteration = 0;
  for (; iteration < max_iterations; ++iteration) {
    if (!(Largest(along) > tolerance * tolerance)) break;
    Multiply(direction, &product);
    const V step = Ratio(along, Dot(direction, product));
    for (std::size_t i = 0; i < b.size(); ++i) {
      (*x)[i] += direction[i] * step;
      r[i] -= product[i] * step;
    }
    Precondition(r, &z);
    const V before = along;
    along = Dot(r, z);
    const V turn = Ratio(along, before);
    for (std::size_t i = 0; i < b.size(); ++i) direction[i] = z[i] + direction[i] * turn;
  }
  return iteration;
}

template int SignalSystem::Solve(const std::vector<double>&, double, int,
                                 std::vector<double>*) const;
template int SignalSystem::Solve(const std::vector<Lanes>&, double, int, std::vector<Lanes>*) const;

std::vector<SignalSystem::Lanes> SignalSystem::Perturbations(std::uint64_t seed) const {
  std::vector<Lanes> b = Zeros<Lanes>(Size());
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    const SignalEquation& row = equations_[i];
    const Lanes pull = Signs(seed, 0, i) * static_cast<float>(std::sqrt(row.weight));
    b[0] += pull;
    b[1] -= pull * static_cast<float>(row.log_distance);
    if (row.receiver >= 0) {
      b[static_cast<std::size_t>(row.receiver)] += pull;
      b[static_cast<std::size_t>(row.transmitter)] += pull;
    }
    const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
    const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
    for (std::size_t k = 0; k < row.size; ++k)
      b[head_ + static_cast<std::size_t>(cell[k])] -= pull * static_cast<float>(length[k]);
  }
  const AttenuationCells& cells = rows_->Cells();
  for (std::size_t i = 0; i < cells.Count(); ++i) {
    std::uint64_t kind = 1;
    for (const std::int32_t other : {cells.Right(i), cells.Up(i)}) {
      const Lanes pull = Signs(seed, kind++, i) * static_cast<float>(std::sqrt(SmoothWeight()));
      if (other < 0) continue;
      b[head_ + i] += pull;
      b[head_ + static_cast<std::size_t>(other)] -= pull;
    }
  }
  for (std::size_t i = 0; i < Size(); ++i)
    b[i] += Signs(seed, 3, i) * static_cast<float>(std::sqrt(PriorWeight(i)));
  return b;
}

}  // namespace graticule
