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
constexpr std::size_t kMostBlocks = 256;

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

std::vector<double> Moved(const Eigen::MatrixXf& by, const std::vector<double>& sums) {
  const Eigen::Map<const Eigen::VectorXd> all(sums.data(), by.rows());
  const Eigen::VectorXf moved = by * all.cast<float>();
  return {moved.data(), moved.data() + moved.size()};
}
std::vector<Lanes> Moved(const Eigen::MatrixXf& by, const std::vector<Lanes>& sums) {
  using Columns = Eigen::Matrix<float, Eigen::Dynamic, 16, Eigen::RowMajor>;
  std::vector<Lanes> moved = sums;
  Eigen::Map<Columns>(moved[0].data(), by.rows(), 16).noalias() =
      by * Eigen::Map<const Columns>(sums[0].data(), by.rows(), 16);
  return moved;
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

/// Adds a row's terms, times `pull`.
template <class V>
void SignalSystem::AddTerms(const SignalEquation& row, const V& pull, std::vector<V>* to) const {
  std::vector<V>& sums = *to;
  sums[0] += pull;
  sums[1] -= pull * Scalar(pull, row.log_distance);
  if (row.receiver >= 0) {
    sums[static_cast<std::size_t>(row.receiver)] += pull;
    sums[static_cast<std::size_t>(row.transmitter)] += pull;
  }
  const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
  const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
  for (std::size_t k = 0; k < row.size; ++k)
    sums[head_ + static_cast<std::size_t>(cell[k])] -= pull * Scalar(pull, length[k]);
}

void SignalSystem::AddToSums(const SignalEquation& row, double sign) {
  AddTerms(row, sign * row.weight * row.target_dbm, &b_);
  const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
  const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
  for (std::size_t k = 0; k < row.size; ++k)
    diagonal_[head_ + static_cast<std::size_t>(cell[k])] +=
        sign * row.weight * length[k] * length[k];
}

/// Calls f(first, second, which) for neighbours of whom one is a cell numbered `from` or above;
/// `which` is 1 where the second is to the right of the first, 2 where it is above.
template <class F>
void SignalSystem::ForNewPairs(std::size_t from, const F& f) const {
  const AttenuationCells& cells = rows_->Cells();
  for (std::size_t i = from; i < cells.Count(); ++i) {
    const AttenuationCell& cell = cells.At(i);
    const std::int32_t ahead[] = {cells.Right(i), cells.Up(i)};
    const std::int32_t behind[] = {cells.Find(cell.material, cell.x - 1, cell.y),
                                   cells.Find(cell.material, cell.x, cell.y - 1)};
    for (std::uint64_t k = 0; k < 2; ++k) {
      if (ahead[k] >= 0) f(i, static_cast<std::size_t>(ahead[k]), k + 1);
      // Of a new one it was that one's neighbour ahead.
      if (behind[k] >= 0 && static_cast<std::size_t>(behind[k]) < from)
        f(static_cast<std::size_t>(behind[k]), i, k + 1);
    }
  }
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

void SignalSystem::Prepare() {
  const AttenuationCells& cells = rows_->Cells();
  if (!has_sums_ || is_altered_) {
    b_.assign(Size(), 0);
    diagonal_.assign(Size(), 0);
    for (const SignalEquation& row : equations_) AddToSums(row, 1);
    AddPriors(0, 0);
    has_sums_ = true;
  }
  inverse_diagonal_.resize(Size());
  for (std::size_t i = 0; i < Size(); ++i) inverse_diagonal_[i] = 1 / diagonal_[i];
  // A preconditioner need not be of the latest rows; it must fit the unknowns.
  const std::size_t size = rows_->EntryCount() + equations_.size();
  if (coarse_at_head_ != head_ || coarse_at_cells_ > cells.Count() || size < coarse_at_entries_ ||
      10 * size > 13 * coarse_at_entries_) {
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
  const Eigen::MatrixXd inverse =
      coarse.llt().solve(Eigen::MatrixXd::Identity(coarse.rows(), coarse.cols()));
  coarse_inverse_ = (.5 * (inverse + inverse.transpose())).cast<float>();
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
  std::vector<V> sums = Zeros<V>(size);
  for (std::size_t i = 0; i < head_; ++i) sums[i] = r[i];
  for (std::size_t i = head_; i < r.size(); ++i) {
    const std::int32_t block = block_of_[i - head_];
    if (block >= 0) sums[head_ + static_cast<std::size_t>(block)] += r[i];
  }
  const std::vector<V> moves = Moved(coarse_inverse_, sums);
  for (std::size_t i = 0; i < head_; ++i) (*z)[i] = moves[i];
  for (std::size_t i = head_; i < r.size(); ++i) {
    const std::int32_t block = block_of_[i - head_];
    (*z)[i] = r[i] * Scalar(unit, inverse_diagonal_[i]);
    if (block >= 0) (*z)[i] += moves[head_ + static_cast<std::size_t>(block)];
  }
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

void SignalSystem::Perturb(std::uint64_t seed, std::vector<Lanes>* b) const {
  const auto pull = [&](std::size_t row, double weight) -> Lanes {
    return Signs(seed, 0, row) * static_cast<float>(std::sqrt(weight));
  };
  const bool all = is_anew_ || b->empty();
  if (all) b->clear();
  b->resize(Size(), Lanes::Zero());
  if (all) {
    for (std::size_t i = 0; i < equations_.size(); ++i)
      AddTerms(equations_[i], pull(i, equations_[i].weight), b);
  }
  for (std::size_t c = 0; !all && c < changes_.size(); ++c) {
    const std::size_t row = changes_[c].row;
    if (changes_[c].before.weight > 0)
      AddTerms<Lanes>(changes_[c].before, -pull(row, changes_[c].before.weight), b);
    AddTerms(equations_[row], pull(row, equations_[row].weight), b);
  }
  const auto smooth = static_cast<float>(std::sqrt(SmoothWeight()));
  ForNewPairs(all ? 0 : cells_before_, [&](std::size_t from, std::size_t to, std::uint64_t which) {
    const Lanes off = Signs(seed, which, from) * smooth;
    (*b)[head_ + from] += off;
    (*b)[head_ + to] -= off;
  });
  for (std::size_t i = all ? 0 : head_ + cells_before_; i < Size(); ++i)
    (*b)[i] += Signs(seed, 3, i) * static_cast<float>(std::sqrt(prior_[i]));
}

double SignalSystem::DegreesOfFreedom(std::uint64_t seed, const std::vector<Lanes>& x) const {
  double sum = 0;
  for (std::size_t i = 0; i < equations_.size(); ++i) {
    const SignalEquation& row = equations_[i];
    Lanes off = x[0] - x[1] * static_cast<float>(row.log_distance);
    if (row.receiver >= 0)
      off +=
          x[static_cast<std::size_t>(row.receiver)] + x[static_cast<std::size_t>(row.transmitter)];
    const std::int32_t* cell = rows_->CellsOf(SignalRow{}) + row.first;
    const double* length = rows_->LengthsOf(SignalRow{}) + row.first;
    for (std::size_t k = 0; k < row.size; ++k)
      off -= x[head_ + static_cast<std::size_t>(cell[k])] * static_cast<float>(length[k]);
    sum += std::sqrt(row.weight) * static_cast<double>((off * Signs(seed, 0, i)).mean());
  }
  return sum;
}

}  // namespace graticule
