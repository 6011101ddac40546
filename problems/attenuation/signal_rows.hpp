#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "graticule/io/signal_log.hpp"
#include "graticule/problems/attenuation/ray.hpp"
#include "graticule/problems/attenuation/tomography_options.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// What a link said from nearly one place: the mean of one or more measurements.
struct SignalRow {
  std::uint32_t receiver = 0, transmitter = 0;
  bool is_heard = true;
  double count = 0;    ///< measurements
  double time_s = 0;   ///< mean
  double dbm = 0;      ///< mean; the floor where nothing was heard
  double scatter = 0;  ///< sum of squared differences from the mean
  Eigen::Vector3d receiver_m = Eigen::Vector3d::Zero();     ///< mean
  Eigen::Vector3d transmitter_m = Eigen::Vector3d::Zero();  ///< mean
  double log_distance = 0;                                  ///< log10 of metres
  std::size_t first = 0, size = 0;                          ///< of the lengths in cells
};

/// A coarse cell of one class whose attenuation is unknown.
struct AttenuationCell {
  std::uint32_t material;
  std::int32_t x, y;
};

/// The cells that are estimated, numbered in the order in which rays came to them.
class AttenuationCells {
 public:
  static constexpr std::int32_t kNone = -1;

  std::size_t Count() const { return cells_.size(); }
  const AttenuationCell& At(std::size_t i) const { return cells_[i]; }
  /// kNone where it is not estimated.
  std::int32_t Find(std::uint32_t material, std::int32_t x, std::int32_t y) const {
    const std::int64_t dx = std::int64_t{x} - x0_, dy = std::int64_t{y} - y0_;
    if (dx < 0 || dy < 0 || dx >= width_ || dy >= height_ || material >= classes_) return kNone;
    return index_[static_cast<std::size_t>((material * height_ + dy) * width_ + dx)];
  }
  /// The neighbour to the right / above, of the same class; or kNone.
  std::int32_t Right(std::size_t i) const { return right_[i]; }
  std::int32_t Up(std::size_t i) const { return up_[i]; }

  /// Makes a cell, and those of its class within the margin, unknowns; returns its number.
  std::int32_t Touch(std::uint32_t material, std::int32_t x, std::int32_t y, int margin);
  void Clear();

 private:
  void Cover(std::uint32_t material, std::int32_t x, std::int32_t y, int margin);
  std::int32_t Place(std::uint32_t material, std::int32_t x, std::int32_t y);
  std::int32_t& Slot(std::uint32_t material, std::int32_t x, std::int32_t y) {
    return index_[static_cast<std::size_t>((material * height_ + (y - y0_)) * width_ + (x - x0_))];
  }

  std::vector<AttenuationCell> cells_;
  std::vector<std::int32_t> right_, up_;
  std::vector<char> is_touched_;
  std::int64_t x0_ = 0, y0_ = 0, width_ = 0, height_ = 0, classes_ = 0;
  std::vector<std::int32_t> index_;  // class by class, row by row
};

/// Measurements as rows of a linear model: merged, traced, and traced again where the map changes.
/// The rows depend on the measurements in their order, not on how they were handed over.
class SignalRows {
 public:
  explicit SignalRows(const TomographyOptions& options) : options_(options) {}

  void SetMap(std::shared_ptr<const ClassMap> map);
  const ClassMap* Map() const { return map_.get(); }

  /// Throws Error (kInput), with nothing added: a number that is not finite, a strength above +30
  /// dBm or below -200, a place too far outside of the map, a radio that listens to itself.
  void Add(Span<const SignalMeasurement> measurements);
  /// Throws Error as Add does.
  void CheckLink(const SignalLink& link) const;

  /// Traces what is new or changed since; after SetMap all.  Cells keep their numbers unless the
  /// map was set: then true is returned, and they are numbered anew.
  bool Trace();
  /// The rows that the last Trace traced.
  const std::vector<std::size_t>& Traced() const { return traced_; }
  /// Lengths that a row had before it was traced again stay where they were, until this changes.
  std::size_t Generation() const { return generation_; }

  std::size_t Count() const { return rows_.size(); }
  const SignalRow& At(std::size_t i) const { return rows_[i]; }
  const std::int32_t* CellsOf(const SignalRow& row) const { return cell_.data() + row.first; }
  const double* LengthsOf(const SignalRow& row) const { return length_m_.data() + row.first; }
  const AttenuationCells& Cells() const { return cells_; }
  /// One more than the highest radio that a measurement named.
  std::uint32_t RadioCount() const { return radio_count_; }
  double MeasurementCount() const { return measurement_count_; }
  /// False where a row is of packets not heard.
  bool AllHeard() const { return all_heard_; }
  /// Lengths in cells, of all rows.
  std::size_t EntryCount() const { return entries_; }

  /// log10 of the distance, as the model has it.
  double LogDistance(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const;
  /// A tracer through this map.
  RayTracer Tracer() const;

 private:
  struct Open {
    std::size_t row;
    Eigen::Vector3d receiver_m, transmitter_m;
    double time_s;
  };
  void AddOne(const SignalMeasurement& measurement);
  bool Belongs(const SignalMeasurement& measurement, const Open& open) const;
  void TraceRow(SignalRow* row, RayTracer* tracer);
  void DropOldEntries();

  TomographyOptions options_;
  std::shared_ptr<const ClassMap> map_;
  std::vector<SignalRow> rows_;
  std::map<std::tuple<std::uint32_t, std::uint32_t, bool>, Open> open_;
  std::vector<std::size_t> changed_, traced_;
  std::vector<char> is_changed_;
  std::vector<std::int32_t> cell_;
  std::vector<double> length_m_;
  std::size_t entries_ = 0, generation_ = 0;
  AttenuationCells cells_;
  std::uint32_t radio_count_ = 0;
  double measurement_count_ = 0;
  bool is_map_new_ = false, all_heard_ = true;
};

}  // namespace graticule
