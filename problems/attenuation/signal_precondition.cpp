#include <Eigen/Cholesky>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "graticule/problems/attenuation/signal_system_parts.hpp"

namespace graticule {
namespace {

using Lanes = SignalSystem::Lanes;

constexpr std::int32_t kBlock = 4;  // cells, a side of a block that moves together
constexpr std::size_t kMostBlocks = 256;

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

}  // namespace

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

template void SignalSystem::Precondition(const std::vector<double>&, std::vector<double>*) const;
template void SignalSystem::Precondition(const std::vector<Lanes>&, std::vector<Lanes>*) const;

}  // namespace graticule
