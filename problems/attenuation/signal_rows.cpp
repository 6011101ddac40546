#include "graticule/problems/attenuation/signal_rows.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr double kHighestDbm = 30, kLowestDbm = -200;
constexpr std::int64_t kMostCells = 1 << 24;
constexpr std::uint32_t kMostRadios = 1 << 20;
constexpr std::size_t kSampledRows = 256;  // say how many lengths there will be

std::string Where(const SignalLink& link) { return "at " + Shown(link.time_s) + " s: "; }

}  // namespace

std::int32_t AttenuationCells::Touch(std::uint32_t material, std::int32_t x, std::int32_t y,
                                     int margin) {
  const std::int32_t found = Find(material, x, y);
  if (found != kNone && is_touched_[static_cast<std::size_t>(found)]) return found;
  Cover(material, x, y, margin);
  const std::int32_t cell = Place(material, x, y);
  is_touched_[static_cast<std::size_t>(cell)] = 1;
  for (int dy = -margin; dy <= margin; ++dy)
    for (int dx = -margin; dx <= margin; ++dx) Place(material, x + dx, y + dy);
  return cell;
}

std::int32_t AttenuationCells::Place(std::uint32_t material, std::int32_t x, std::int32_t y) {
  std::int32_t& slot = Slot(material, x, y);
  if (slot != kNone) return slot;
  slot = static_cast<std::int32_t>(cells_.size());
  cells_.push_back({material, x, y});
  right_.push_back(Find(material, x + 1, y));
  up_.push_back(Find(material, x, y + 1));
  is_touched_.push_back(0);
  const std::int32_t left = Find(material, x - 1, y), below = Find(material, x, y - 1);
  if (left != kNone) right_[static_cast<std::size_t>(left)] = slot;
  if (below != kNone) up_[static_cast<std::size_t>(below)] = slot;
  return slot;
}

void AttenuationCells::Cover(std::uint32_t material, std::int32_t x, std::int32_t y, int margin) {
  const std::int64_t low_x = std::int64_t{x} - margin, high_x = std::int64_t{x} + margin + 1;
  const std::int64_t low_y = std::int64_t{y} - margin, high_y = std::int64_t{y} + margin + 1;
  if (material < classes_ && low_x >= x0_ && low_y >= y0_ && high_x <= x0_ + width_ &&
      high_y <= y0_ + height_)
    return;
  const bool is_first = cells_.empty();
  std::int64_t x0 = is_first ? low_x : std::min(low_x, x0_);
  std::int64_t y0 = is_first ? low_y : std::min(low_y, y0_);
  std::int64_t x1 = is_first ? high_x : std::max(high_x, x0_ + width_);
  std::int64_t y1 = is_first ? high_y : std::max(high_y, y0_ + height_);
  // Grown by a quarter, so that a mission that goes on and on costs a constant a cell.
  const std::int64_t more_x = (x1 - x0) / 4 + 2, more_y = (y1 - y0) / 4 + 2;
  if (x0 < x0_ || is_first) x0 -= more_x;
  if (y0 < y0_ || is_first) y0 -= more_y;
  if (x1 > x0_ + width_ || is_first) x1 += more_x;
  if (y1 > y0_ + height_ || is_first) y1 += more_y;
  const std::int64_t classes = std::max<std::int64_t>(classes_, std::int64_t{material} + 1);
  if ((x1 - x0) > kMostCells / classes / (y1 - y0))
    throw Error("rays span " + std::to_string(x1 - x0) + " x " + std::to_string(y1 - y0) +
                " cells of attenuation, above " + std::to_string(kMostCells) +
                " in all; are positions in metres?");
  x0_ = x0;
  y0_ = y0;
  width_ = x1 - x0;
  height_ = y1 - y0;
  classes_ = classes;
  index_.assign(static_cast<std::size_t>(classes_ * width_ * height_), kNone);
  for (std::size_t i = 0; i < cells_.size(); ++i)
    Slot(cells_[i].material, cells_[i].x, cells_[i].y) = static_cast<std::int32_t>(i);
}

void AttenuationCells::Clear() { *this = AttenuationCells(); }

void SignalRows::SetMap(std::shared_ptr<const ClassMap> map) {
  map_ = std::move(map);
  is_map_new_ = true;
}

RayTracer SignalRows::Tracer() const {
  return RayTracer(options_.uses_map ? map_.get() : nullptr, options_.cell_m);
}

double SignalRows::LogDistance(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const {
  return std::log10(std::max(options_.near_m, (a_m - b_m).norm()));
}

void SignalRows::CheckLink(const SignalLink& link) const {
  if (!std::isfinite(link.time_s)) throw Error("a time is not a number");
  if (!link.receiver_m.allFinite() || !link.transmitter_m.allFinite())
    throw Error(Where(link) + "a position is not a number");
  if (link.receiver == link.transmitter)
    throw Error(Where(link) + "radio " + std::to_string(link.receiver) + " listens to itself");
  if (std::max(link.receiver, link.transmitter) >= kMostRadios)
    throw Error(Where(link) + "a radio's number is above " + std::to_string(kMostRadios));
  for (const Eigen::Vector3d* end : {&link.receiver_m, &link.transmitter_m}) {
    const auto place = [end] { return "(" + Shown(end->x()) + ", " + Shown(end->y()) + ")"; };
    if (end->cwiseAbs().maxCoeff() > 1e6)
      throw Error(Where(link) + place() + " is more than 1000 km off; expected metres");
    if (!options_.uses_map || !map_) continue;
    const double outside = map_->DistanceOutside(end->head<2>());
    if (outside > options_.outside_m)
      throw Error(Where(link) + place() + " is " + Shown(outside) +
                  " m outside of the map; at most " + Shown(options_.outside_m) +
                  " m are allowed (outside_m)");
  }
}

void SignalRows::Add(Span<const SignalMeasurement> measurements) {
  for (const SignalMeasurement& m : measurements) {
    CheckLink(m.link);
    if (!(m.dbm >= kLowestDbm && m.dbm <= kHighestDbm))
      throw Error(Where(m.link) + "a strength of " + Shown(m.dbm) +
                  " dBm; expected -200 to +30 (is it a loss, or a quality in percent?)");
  }
  for (const SignalMeasurement& m : measurements) AddOne(m);
}

bool SignalRows::Belongs(const SignalMeasurement& m, const Open& open) const {
  const SignalRow& row = rows_[open.row];
  if (!row.is_heard && row.dbm != m.dbm) return false;
  const double apart = (m.link.receiver_m - m.link.transmitter_m).norm();
  const double within = std::min(options_.merge_m, options_.merge_share * apart);
  return (m.link.receiver_m - open.receiver_m).norm() <= within &&
         (m.link.transmitter_m - open.transmitter_m).norm() <= within &&
         std::abs(m.link.time_s - open.time_s) <= options_.merge_s;
}

void SignalRows::AddOne(const SignalMeasurement& given) {
  SignalMeasurement m = given;
  SignalLink& link = m.link;
  radio_count_ = std::max({radio_count_, link.receiver + 1, link.transmitter + 1});
  measurement_count_ += 1;
  // Both directions say the same where a radio's bias is the same in both.
  if (options_.bias != RadioBias::kEnds && link.transmitter < link.receiver) {
    std::swap(link.receiver, link.transmitter);
    std::swap(link.receiver_m, link.transmitter_m);
  }
  const auto key = std::make_tuple(link.receiver, link.transmitter, m.is_heard);
  const auto found = open_.find(key);
  if (found == open_.end() || !Belongs(m, found->second)) {
    const Open open = {rows_.size(), link.receiver_m, link.transmitter_m, link.time_s};
    open_.insert_or_assign(key, open);
    SignalRow row;
    row.receiver = link.receiver;
    row.transmitter = link.transmitter;
    row.is_heard = m.is_heard;
    all_heard_ = all_heard_ && m.is_heard;
    rows_.push_back(row);
    is_changed_.push_back(0);
  }
  const std::size_t at = open_.at(key).row;
  SignalRow& row = rows_[at];
  row.count += 1;
  const double part = 1 / row.count, off = m.dbm - row.dbm;
  row.dbm += part * off;
  row.scatter += off * (m.dbm - row.dbm);
  if (row.count == 1) row.scatter = 0;
  row.time_s += part * (link.time_s - row.time_s);
  row.receiver_m += part * (link.receiver_m - row.receiver_m);
  row.transmitter_m += part * (link.transmitter_m - row.transmitter_m);
  if (!is_changed_[at]) changed_.push_back(at);
  is_changed_[at] = 1;
}

void SignalRows::TraceRow(SignalRow* row, RayTracer* tracer) {
  row->log_distance = LogDistance(row->receiver_m, row->transmitter_m);
  entries_ -= row->size;
  row->first = cell_.size();
  row->size = 0;
  if (options_.classes.empty()) return;
  for (const RayPiece& piece : tracer->Trace(row->receiver_m, row->transmitter_m)) {
    const int margin = options_.cell_m > 0 ? options_.margin_cells : 0;
    cell_.push_back(cells_.Touch(piece.material, piece.x, piece.y, margin));
    length_m_.push_back(piece.length_m);
  }
  row->size = cell_.size() - row->first;
  entries_ += row->size;
}

bool SignalRows::Trace() {
  RayTracer tracer = Tracer();
  const bool all = is_map_new_;
  if (cell_.size() > 2 * entries_ + 4096) DropOldEntries();
  if (all) {
    ++generation_;
    cells_.Clear();
    cell_.clear();
    length_m_.clear();
    entries_ = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (i == kSampledRows) {  // copied once, not at each doubling
        const std::size_t guess = cell_.size() / kSampledRows * rows_.size() * 5 / 4;
        cell_.reserve(guess);
        length_m_.reserve(guess);
      }
      rows_[i].size = 0;
      TraceRow(&rows_[i], &tracer);
    }
  } else {
    for (const std::size_t i : changed_) TraceRow(&rows_[i], &tracer);
  }
  for (const std::size_t i : changed_) is_changed_[i] = 0;
  traced_.swap(changed_);
  changed_.clear();
  is_map_new_ = false;
  return all;
}

void SignalRows::DropOldEntries() {
  ++generation_;
  std::vector<std::int32_t> cell;
  std::vector<double> length_m;
  cell.reserve(entries_ * 5 / 4);
  length_m.reserve(entries_ * 5 / 4);
  for (SignalRow& row : rows_) {
    const auto from = static_cast<std::ptrdiff_t>(row.first);
    const auto to = static_cast<std::ptrdiff_t>(row.first + row.size);
    row.first = cell.size();
    cell.insert(cell.end(), cell_.begin() + from, cell_.begin() + to);
    length_m.insert(length_m.end(), length_m_.begin() + from, length_m_.begin() + to);
  }
  cell_.swap(cell);
  length_m_.swap(length_m);
}

}  // namespace graticule
