#include "graticule/io/signal_log.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "graticule/io/csv_table.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kNone = CsvTable::kNone;
constexpr double kLowestDbm = -200, kHighestDbm = 30;
constexpr double kSmallestNanoseconds = 1e15;  // as seconds: 30 million years
constexpr double kTrajectorySlack_s = 1;       // a log may begin a little before its trajectory
constexpr std::string_view kWidePrefix = "rssi_";

/// One end of a link: the columns of its name and position.
struct EndColumns {
  std::size_t name = kNone, x = kNone, y = kNone, z = kNone;
};

class LogReader {
 public:
  LogReader(std::string_view text, const std::string& name, const SignalLogOptions& options)
      : table_(text, name), options_(options) {
    for (const auto& [radio, poses] : options.trajectories)
      ExpectInOrder(poses, "the trajectory of " + Quoted(radio));
    time_ = table_.Find({"time", "time_s", "t", "ts", "stamp", "timestamp"});
    log_.has_time = time_ != kNone;
  }

  SignalLog Read() {
    FindColumns();
    while (table_.Next()) ReadLine();
    if (log_.measurements.empty()) table_.FailLine("there is no measurement in this log");
    if (options_.sort)
      std::stable_sort(log_.measurements.begin(), log_.measurements.end(),
                       [](const SignalMeasurement& a, const SignalMeasurement& b) {
                         return a.link.time_s < b.link.time_s;
                       });
    return std::move(log_);
  }

 private:
  void FindColumns() {
    dbm_ = table_.Find({"dbm", "rssi", "rss", "rss_dbm", "rssi_dbm", "rssi_mean", "signal"});
    heard_ = table_.Find({"heard", "is_heard"});
    mobile_ = {kNone, table_.Find({"x", "x_m"}), table_.Find({"y", "y_m"}),
               table_.Find({"z", "z_m"})};
    if (dbm_ == kNone)
      FindAnchorColumns();
    else
      FindEndColumns();
  }

  void FindEndColumns() {
    receiver_ = {table_.Find({"receiver", "rx", "rx_id"}), table_.Find({"rx_x", "receiver_x"}),
                 table_.Find({"rx_y", "receiver_y"}), table_.Find({"rx_z", "receiver_z"})};
    transmitter_ = {table_.Find({"transmitter", "tx", "tx_id"}),
                    table_.Find({"tx_x", "transmitter_x"}), table_.Find({"tx_y", "transmitter_y"}),
                    table_.Find({"tx_z", "transmitter_z"})};
    if (transmitter_.name == kNone) table_.FailLine("there is no column transmitter");
    for (const EndColumns* end : {&receiver_, &transmitter_})
      if ((end->x == kNone) != (end->y == kNone))
        table_.FailLine("a position needs both its x and its y");
    if (receiver_.name == kNone && receiver_.x == kNone)
      table_.FailLine("there is no column receiver");
    log_.has_height = receiver_.z != kNone || transmitter_.z != kNone || AnchorsHaveHeight();
  }

  void FindAnchorColumns() {
    for (std::size_t i = 0; i < table_.Columns().size(); ++i) {
      const std::string& column = table_.Columns()[i];
      if (column.compare(0, kWidePrefix.size(), kWidePrefix) != 0) continue;
      const std::string id = column.substr(kWidePrefix.size());
      const auto anchor = options_.anchors.find(id);
      if (anchor == options_.anchors.end())
        table_.Fail(i, "where the radio " + Quoted(id) +
                           " stands is not known: it is not among the " +
                           std::to_string(options_.anchors.size()) + " anchors");
      anchors_.emplace_back(i, anchor);
    }
    if (anchors_.empty()) table_.FailLine("there is no column dbm, and no column rssi_ID either");
    if (mobile_.x == kNone || mobile_.y == kNone)
      table_.FailLine("there are no columns x and y of the mobile radio");
    log_.has_height = mobile_.z != kNone || AnchorsHaveHeight();
  }

  bool AnchorsHaveHeight() const {
    return std::any_of(options_.anchors.begin(), options_.anchors.end(),
                       [](const auto& anchor) { return anchor.second.z() != 0; });
  }

  void ReadLine() {
    SignalMeasurement measurement;
    if (time_ != kNone) {
      double& time = measurement.link.time_s;
      time = table_.Number(time_);
      if (time > kSmallestNanoseconds) time *= 1e-9;
      if (std::abs(time) > kSmallestNanoseconds)
        table_.Fail(time_, "expected seconds or nanoseconds, found " + Quoted(table_.Cell(time_)));
      if (!options_.sort && !log_.measurements.empty() &&
          time < log_.measurements.back().link.time_s)
        table_.Fail(time_, "the time goes backwards, from " +
                               Shown(log_.measurements.back().link.time_s) + " by " +
                               Shown(log_.measurements.back().link.time_s - time) + " s");
    }
    if (dbm_ == kNone)
      ReadWide(&measurement);
    else
      ReadLong(&measurement);
  }

  void ReadLong(SignalMeasurement* measurement) {
    SignalLink& link = measurement->link;
    link.receiver = ReadEnd(receiver_, "rx", link.time_s, &link.receiver_m);
    link.transmitter = ReadEnd(transmitter_, "tx", link.time_s, &link.transmitter_m);
    if (link.receiver == link.transmitter)
      table_.Fail(transmitter_.name,
                  "a radio does not hear itself: " + Quoted(table_.Cell(transmitter_.name)));
    measurement->dbm = ReadDbm(dbm_);
    if (heard_ != kNone) {
      const std::string_view cell = table_.Cell(heard_);
      if (cell != "0" && cell != "1")
        table_.Fail(heard_, "expected 0 or 1 (heard), found " + Quoted(cell));
      measurement->is_heard = cell == "1";
    }
    log_.measurements.push_back(*measurement);
  }

  void ReadWide(SignalMeasurement* measurement) {
    SignalLink& link = measurement->link;
    link.receiver_m = ReadPosition(mobile_);
    for (const auto& [column, anchor] : anchors_) {
      if (table_.Cell(column).empty()) continue;
      link.receiver = RadioIndex(options_.mobile);
      link.transmitter = RadioIndex(anchor->first);
      link.transmitter_m = anchor->second;
      measurement->dbm = ReadDbm(column);
      log_.measurements.push_back(*measurement);
    }
  }

  std::uint32_t ReadEnd(const EndColumns& end, const char* nameless, double time_s,
                        Eigen::Vector3d* map_from_radio) {
    const std::string name(end.name == kNone ? nameless : table_.Cell(end.name));
    if (name.empty()) table_.Fail(end.name, "expected the name of a radio, found nothing");
    *map_from_radio = end.x != kNone ? ReadPosition(end) : KnownPosition(end.name, name, time_s);
    return RadioIndex(name);
  }

  Eigen::Vector3d ReadPosition(const EndColumns& end) const {
    return {table_.Number(end.x), table_.Number(end.y), end.z == kNone ? 0 : table_.Number(end.z)};
  }

  Eigen::Vector3d KnownPosition(std::size_t column, const std::string& name, double time_s) const {
    const auto anchor = options_.anchors.find(name);
    if (anchor != options_.anchors.end()) return anchor->second;
    const auto trajectory = options_.trajectories.find(name);
    if (trajectory == options_.trajectories.end() || trajectory->second.empty())
      table_.Fail(column, "where the radio " + Quoted(name) +
                              " is is not known: the log has no position of it, and neither the "
                              "anchors nor a trajectory have");
    const std::vector<StampedPose>& poses = trajectory->second;
    if (time_s < poses.front().stamp_s - kTrajectorySlack_s ||
        time_s > poses.back().stamp_s + kTrajectorySlack_s)
      table_.Fail(column, "the trajectory of " + Quoted(name) + " does not reach to this time");
    const auto next =
        std::upper_bound(poses.begin(), poses.end(), time_s,
                         [](double time, const StampedPose& pose) { return time < pose.stamp_s; });
    const auto place = [](const StampedPose& pose) {
      return Eigen::Vector3d(pose.world_from_body[0], pose.world_from_body[1],
                             pose.world_from_body[2]);
    };
    if (next == poses.begin()) return place(poses.front());
    if (next == poses.end()) return place(poses.back());
    const auto before = next - 1;
    const double part = (time_s - before->stamp_s) / (next->stamp_s - before->stamp_s);
    return (1 - part) * place(*before) + part * place(*next);
  }

  double ReadDbm(std::size_t column) const {
    const double dbm = table_.Number(column);
    if (!(dbm >= kLowestDbm && dbm <= kHighestDbm))
      table_.Fail(column, "expected a strength within -200 and 30 dBm, found " +
                              Quoted(table_.Cell(column)));
    return dbm;
  }

  std::uint32_t RadioIndex(const std::string& name) {
    const auto [radio, is_new] =
        radios_.emplace(name, static_cast<std::uint32_t>(log_.radios.size()));
    if (is_new) log_.radios.push_back(name);
    return radio->second;
  }

  CsvTable table_;
  const SignalLogOptions& options_;
  SignalLog log_;
  std::size_t time_ = kNone, dbm_ = kNone, heard_ = kNone;
  EndColumns receiver_, transmitter_, mobile_;
  std::vector<std::pair<std::size_t, std::map<std::string, Eigen::Vector3d>::const_iterator>>
      anchors_;
  std::unordered_map<std::string, std::uint32_t> radios_;
};

void CheckName(const std::string& name) {
  const bool has_blanks_around = name.empty() || name.front() == ' ' || name.back() == ' ' ||
                                 name.front() == '\t' || name.back() == '\t';
  if (has_blanks_around || name.front() == '#' ||
      name.find_first_of(",\"\r\n") != std::string::npos)
    throw Error("the radio's name " + Quoted(name) + " cannot be written into a signal log");
}

void AppendPosition(std::string* text, const Eigen::Vector3d& map_from_radio, bool has_height) {
  for (int axis = 0; axis < (has_height ? 3 : 2); ++axis) {
    *text += ',';
    AppendNumber(text, map_from_radio[axis]);
  }
}

std::string Format(const SignalLog& log, bool has_positions) {
  for (const std::string& radio : log.radios) CheckName(radio);
  const bool is_censored =
      std::any_of(log.measurements.begin(), log.measurements.end(),
                  [](const SignalMeasurement& measurement) { return !measurement.is_heard; });
  std::string text = log.has_time ? "time," : "";
  text += "receiver,transmitter";
  if (has_positions)
    text += log.has_height ? ",rx_x,rx_y,rx_z,tx_x,tx_y,tx_z" : ",rx_x,rx_y,tx_x,tx_y";
  text += ",dbm";
  text += is_censored ? ",heard\n" : "\n";
  for (const SignalMeasurement& measurement : log.measurements) {
    const SignalLink& link = measurement.link;
    if (log.has_time) {
      AppendNumber(&text, link.time_s);
      text += ',';
    }
    text += log.radios[link.receiver] + "," + log.radios[link.transmitter];
    if (has_positions) {
      AppendPosition(&text, link.receiver_m, log.has_height);
      AppendPosition(&text, link.transmitter_m, log.has_height);
    }
    text += ',';
    AppendNumber(&text, measurement.dbm);
    if (is_censored) text += measurement.is_heard ? ",1" : ",0";
    text += '\n';
  }
  return text;
}

}  // namespace

SignalLog ParseSignalLog(std::string_view text, const std::string& name,
                         const SignalLogOptions& options) {
  return LogReader(text, name, options).Read();
}

SignalLog ReadSignalLog(const std::string& path, const SignalLogOptions& options) {
  return ParseSignalLog(ReadFile(path), path, options);
}

std::map<std::string, Eigen::Vector3d> ParseAnchors(std::string_view text,
                                                    const std::string& name) {
  CsvTable table(text, name);
  const std::size_t id = table.Find({"id", "name", "radio", "anchor"});
  const std::size_t x = table.Find({"x", "x_m"}), y = table.Find({"y", "y_m"});
  const std::size_t z = table.Find({"z", "z_m"});
  if (id == kNone || x == kNone || y == kNone)
    table.FailLine("anchors need the columns id, x and y");
  std::map<std::string, Eigen::Vector3d> anchors;
  while (table.Next()) {
    const Eigen::Vector3d place(table.Number(x), table.Number(y), z == kNone ? 0 : table.Number(z));
    if (table.Cell(id).empty()) table.Fail(id, "expected the name of a radio, found nothing");
    if (!anchors.emplace(std::string(table.Cell(id)), place).second)
      table.Fail(id, "the radio " + Quoted(table.Cell(id)) + " was there before");
  }
  return anchors;
}

std::string FormatSignalLog(const SignalLog& log) { return Format(log, true); }

std::string FormatSignalLogWithoutPositions(const SignalLog& log) { return Format(log, false); }

void WriteSignalLog(const SignalLog& log, const std::string& path) {
  WriteFile(path, FormatSignalLog(log));
}

}  // namespace graticule
