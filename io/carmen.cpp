#include "graticule/io/carmen.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "graticule/io/robot_laser.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/key.hpp"

namespace graticule {
namespace {

// Logs have poses with six digits: what differs by less is the same laser.
constexpr double kSameGeometry = 1e-3;
constexpr double kNoReturnFrom = 0.99;  // of the largest reading

bool HasPrefix(std::string_view word, std::string_view prefix) {
  return word.size() > prefix.size() && word.substr(0, prefix.size()) == prefix &&
         word.find_first_not_of("0123456789", prefix.size()) == std::string_view::npos;
}

bool IsLaser(std::string_view word) {
  return word == "FLASER" || HasPrefix(word, "ROBOTLASER") || HasPrefix(word, "RAWLASER");
}

bool Near(const PlanarPose& a, const PlanarPose& b) {
  return std::abs(a.x - b.x) < kSameGeometry && std::abs(a.y - b.y) < kSameGeometry &&
         std::abs(WrappedAngle(a.yaw - b.yaw)) < kSameGeometry;
}

/// When, and at which byte of the file, a message is.
struct Times {
  double message = 0, logger = 0;
  std::size_t offset = 0;
};

struct Odometry {
  double time = 0;
  PlanarPose odom_from_robot;
};

/// How the times of one clock run.
struct Clock {
  std::size_t backwards = 0, standing = 0;  // steps, from a scan to the next
  bool IsUsable(std::size_t scans) const { return 2 * standing < scans; }
};

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, const CarmenOptions& options)
      : text_(text), reader_(text, name), options_(options) {
    if (options.laser_offset) mounted_ = *options.laser_offset;
  }

  /// The log that is returned has one robot, without a name.
  std::pair<LaserLog, CarmenSummary> Read() {
    ChooseLaser();
    while (reader_.NextLine()) {
      const std::size_t scans = log_.scans.size(), ranges = log_.ranges.size();
      try {
        ReadLine();
      } catch (const Error& error) {
        Undo(scans, ranges);
        Skip(error);
      }
    }
    ChooseTimes();
    RefuseBackwards();
    if (needs_odometry_) Interpolate();
    FindNoReturn();
    summary_.scans = log_.scans.size();
    if (summary_.scans == 0)
      reader_.FailAt(0, "no " + summary_.laser + " message of this log is whole");
    return {std::move(log_), std::move(summary_)};
  }

 private:
  void Undo(std::size_t scans, std::size_t ranges) {
    log_.scans.resize(scans);
    log_.ranges.resize(ranges);
    times_.resize(scans);
  }

  void Skip(const Error& error) {
    if (!options_.skip_bad) throw error;
    if (summary_.skipped++ == 0) summary_.first_skipped = error.what();
  }

  // What the log has decides which messages are read: CARMEN may log a laser in several ways.
  void ChooseLaser() {
    std::map<std::string, std::size_t> lasers;
    bool is_empty = true;
    TextReader words(text_, reader_.Name());
    while (words.NextLine()) {
      is_empty = false;
      const std::string_view word = words.Word();
      if (IsLaser(word)) ++lasers[std::string(word)];
    }
    if (is_empty) reader_.FailAt(0, "the file is empty");
    summary_.laser = options_.laser;
    for (const char* laser : {"ROBOTLASER1", "FLASER", "RAWLASER1"})
      if (summary_.laser.empty() && lasers.count(laser)) summary_.laser = laser;
    if (summary_.laser.empty() && !lasers.empty()) summary_.laser = lasers.begin()->first;
    if (!lasers.count(summary_.laser))
      reader_.FailAt(0, summary_.laser.empty()
                            ? "there is no laser message (FLASER, ROBOTLASER1, RAWLASER1) in "
                              "this CARMEN log"
                            : "there is no " + Quoted(summary_.laser) + " message in this log");
    needs_odometry_ = HasPrefix(summary_.laser, "RAWLASER");
  }

  void ReadLine() {
    const std::string_view word = reader_.Word();
    if (word[0] == '#') return;
    if (word == summary_.laser) {
      if (word == "FLASER") return ReadFlaser();
      return ReadLaser();
    }
    if (word == "ODOM" && needs_odometry_) return ReadOdometry();
    if (word == "PARAM") return ReadParameter();
    if (word == "NMEAGGA" && options_.read_fixes) return ReadFix();
    ++summary_.other_messages[std::string(word.substr(0, 32))];
  }

  // PARAM name value..: only the laser's place matters, and most values are not numbers.
  void ReadParameter() {
    if (reader_.Word("the parameter's name") != "robot_frontlaser_offset") return;
    const double offset = reader_.Double("the front laser's offset");
    if (summary_.laser == "FLASER" || needs_odometry_)
      summary_.logged_laser_offset = PlanarPose{offset, 0, 0};
    if (options_.laser_offset) return;
    mounted_.x = offset;
    for (const std::uint32_t geometry : mounted_geometries_)
      log_.geometries[geometry].robot_from_laser = mounted_;
  }

  void ReadOdometry() {
    Odometry odometry;
    odometry.odom_from_robot = ReadPose("x of the odometry", "y", "yaw");
    for (const char* what : {"the speed", "the turn rate", "the acceleration"})
      reader_.Double(what);
    const Times times = ReadTimes();
    odometry_.push_back({times.message, odometry.odom_from_robot});
    logger_odometry_.push_back({times.logger, odometry.odom_from_robot});
  }

  // Degrees and minutes, ddmm.mmmm, and the letter of the hemisphere.
  double ReadAngle(const char* what, const char* positive, const char* negative, double most) {
    const double written = reader_.Double(what);
    const double degrees = std::floor(written / 100);
    const double angle = degrees + (written - 100 * degrees) / 60;
    if (!(written >= 0) || angle > most) reader_.FailExpected("a place on the Earth", what);
    if (reader_.Accept(positive)) return angle;
    if (reader_.Accept(negative)) return -angle;
    reader_.Word("the hemisphere");
    reader_.FailExpected((std::string(positive) + " or " + negative).c_str(), "the hemisphere");
  }

  void ReadFix() {
    reader_.Double("the number of the receiver");
    reader_.Double("the time of day");
    GnssFix fix;
    fix.antenna.latitude = ReadAngle("the latitude", "N", "S", 90);
    fix.antenna.longitude = ReadAngle("the longitude", "E", "W", 180);
    const std::uint64_t quality = reader_.Integer("the quality");
    reader_.Double("the number of satellites");
    const double dilution = reader_.Double("the dilution of precision");
    reader_.Double("the sea level");
    fix.antenna.height = reader_.Double("the height");
    for (const char* what : {"the geoid's sea level", "the geoid's height", "the data's age"})
      reader_.Double(what);
    fix.sigma_m = GnssSigma(quality, dilution);
    const Times times = ReadTimes();
    if (quality == 0) return;
    fix.time = times.message;
    summary_.fixes.push_back(fix);
    logger_fix_times_.push_back(times.logger);
  }

  void ReadFlaser() {
    LaserScan scan = Begin(reader_.Integer("the number of ranges"));
    ReadPose("x of the laser", "y of the laser", "yaw of the laser");
    scan.odom_from_robot = ReadPose("x of the odometry", "y", "yaw");
    const double n = scan.beams;
    LaserGeometry geometry;
    geometry.first_angle = -M_PI / 2;
    geometry.step = M_PI / (scan.beams % 2 ? std::max(n - 1, 1.0) : n);
    Finish(scan, Mounted(geometry));
  }

  void ReadLaser() {
    LaserGeometry geometry;
    reader_.Double("the type of the laser");
    geometry.first_angle = reader_.Double("the first angle");
    reader_.Double("the field of view");
    geometry.step = reader_.Double("the step of the angle");
    geometry.max_range = reader_.Double("the largest range");
    if (!(geometry.max_range > 0)) reader_.FailExpected("a range above 0", "the largest range");
    reader_.Double("the accuracy");
    reader_.Double("the remission mode");
    LaserScan scan = Begin(reader_.Integer("the number of ranges"));
    const std::uint64_t remissions = reader_.Integer("the number of remissions");
    for (std::uint64_t i = 0; i < remissions; ++i) reader_.Double("a remission");
    if (needs_odometry_) return Finish(scan, Mounted(geometry));
    const PlanarPose odom_from_laser = ReadPose("x of the laser", "y of the laser", "its yaw");
    scan.odom_from_robot = ReadPose("x of the robot", "y of the robot", "its yaw");
    for (const char* what : {"the speed", "the turn rate", "the forward safety distance",
                             "the side safety distance", "the turn axis"})
      reader_.Double(what);
    geometry.robot_from_laser = Inverse(scan.odom_from_robot) * odom_from_laser;
    if (!summary_.logged_laser_offset) summary_.logged_laser_offset = geometry.robot_from_laser;
    if (options_.laser_offset) geometry.robot_from_laser = *options_.laser_offset;
    Finish(scan, Intern(geometry));
  }

  LaserScan Begin(std::uint64_t beams) {
    if (beams == 0) reader_.FailExpected("at least one range", nullptr);
    LaserScan scan;
    scan.first_range = log_.ranges.size();
    for (std::uint64_t i = 0; i < beams; ++i) {
      const double range = reader_.Double("a range");
      if (range < 0 || range > 1e6) reader_.FailExpected("a range from 0 to 1e6 m", nullptr);
      log_.ranges.push_back(static_cast<float>(range));
    }
    scan.beams = static_cast<std::uint32_t>(beams);
    return scan;
  }

  void Finish(LaserScan scan, std::uint32_t geometry) {
    const Times times = ReadTimes();
    scan.geometry = geometry;
    log_.scans.push_back(scan);
    times_.push_back(times);
  }

  Times ReadTimes() {
    Times times;
    times.offset = reader_.LineOffset();
    times.message = reader_.Double("the time");
    reader_.Word("the host");
    times.logger = reader_.Double("the logger's time");
    reader_.ExpectEnd();
    return times;
  }

  PlanarPose ReadPose(const char* x, const char* y, const char* yaw) {
    PlanarPose pose;
    pose.x = reader_.Double(x);
    pose.y = reader_.Double(y);
    pose.yaw = reader_.Double(yaw);
    return pose;
  }

  std::uint32_t Mounted(LaserGeometry geometry) {
    geometry.robot_from_laser = mounted_;
    const std::uint32_t id = Intern(geometry);
    if (std::find(mounted_geometries_.begin(), mounted_geometries_.end(), id) ==
        mounted_geometries_.end())
      mounted_geometries_.push_back(id);
    return id;
  }

  std::uint32_t Intern(const LaserGeometry& geometry) {
    std::vector<LaserGeometry>& all = log_.geometries;
    for (std::size_t i = all.size(); i-- > 0;)
      if (all[i].first_angle == geometry.first_angle && all[i].step == geometry.step &&
          all[i].max_range == geometry.max_range &&
          Near(all[i].robot_from_laser, geometry.robot_from_laser))
        return static_cast<std::uint32_t>(i);
    all.push_back(geometry);
    return static_cast<std::uint32_t>(all.size() - 1);
  }

  Clock ClockOf(double Times::*member) const {
    Clock clock;
    double latest = -HUGE_VAL;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      const double time = times_[i].*member;
      if (i > 0) clock.standing += time == times_[i - 1].*member;
      clock.backwards += time < latest - options_.time_jitter;
      latest = std::max(latest, time);
    }
    return clock;
  }

  void ChooseTimes() {
    const Clock message = ClockOf(&Times::message), logger = ClockOf(&Times::logger);
    const std::size_t scans = times_.size();
    if (logger.IsUsable(scans) &&
        (!message.IsUsable(scans) || logger.backwards < message.backwards))
      summary_.times = LogTimes::kLogger;
    else if (!message.IsUsable(scans))
      summary_.times = LogTimes::kNone;
    for (std::size_t i = 0; i < scans; ++i)
      log_.scans[i].time = summary_.times == LogTimes::kMessage  ? times_[i].message
                           : summary_.times == LogTimes::kLogger ? times_[i].logger
                                                                 : static_cast<double>(i);
    if (summary_.times == LogTimes::kLogger) {
      odometry_ = std::move(logger_odometry_);
      for (std::size_t i = 0; i < summary_.fixes.size(); ++i)
        summary_.fixes[i].time = logger_fix_times_[i];
    }
  }

  void RefuseBackwards() {
    std::size_t kept = 0, line = 1, offset = 0;
    double latest = -HUGE_VAL;
    for (std::size_t i = 0; i < log_.scans.size(); ++i) {
      LaserScan scan = log_.scans[i];
      const std::string_view passed = text_.substr(offset, times_[i].offset - offset);
      line += static_cast<std::size_t>(std::count(passed.begin(), passed.end(), '\n'));
      offset = times_[i].offset;
      scan.line = line;
      if (scan.time < latest - options_.time_jitter) {
        Skip(Error(std::string(reader_.Name()), line, 1,
                   "expected a time not before that of the scans before (by more than " +
                       Shown(options_.time_jitter) + " s of jitter), found one " +
                       Shown(latest - scan.time) + " s earlier"));
        continue;
      }
      latest = std::max(latest, scan.time);
      log_.scans[kept++] = scan;
    }
    log_.scans.resize(kept);
  }

  void Interpolate() {
    if (odometry_.empty() || summary_.times == LogTimes::kNone)
      reader_.FailAt(0, odometry_.empty()
                            ? "there is no ODOM message that says where the laser was"
                            : "the times do not say which ODOM message belongs to which scan");
    std::stable_sort(odometry_.begin(), odometry_.end(),
                     [](const Odometry& a, const Odometry& b) { return a.time < b.time; });
    for (LaserScan& scan : log_.scans) {
      const auto after =
          std::lower_bound(odometry_.begin(), odometry_.end(), scan.time,
                           [](const Odometry& a, double time) { return a.time < time; });
      if (after == odometry_.begin() || after == odometry_.end()) {
        scan.odom_from_robot =
            after == odometry_.end() ? odometry_.back().odom_from_robot : after->odom_from_robot;
        continue;
      }
      const Odometry& before = *(after - 1);
      scan.odom_from_robot = Interpolated(before.odom_from_robot, after->odom_from_robot,
                                          (scan.time - before.time) / (after->time - before.time));
    }
  }

  // Where no message says what "no return" is, the log does: it is the largest value, give or take
  // the codes that lasers of this kind have for why (81.83 to 81.91; 51.05 to 51.22).
  void FindNoReturn() {
    if (summary_.laser != "FLASER") return;
    std::vector<float> largest(log_.geometries.size());
    for (const LaserScan& scan : log_.scans)
      for (const float range : log_.RangesOf(scan))
        largest[scan.geometry] = std::max(largest[scan.geometry], range);
    for (const std::uint32_t id : mounted_geometries_)
      log_.geometries[id].max_range = kNoReturnFrom * static_cast<double>(largest[id]);
  }

  std::string_view text_;
  TextReader reader_;
  const CarmenOptions& options_;
  LaserLog log_;
  CarmenSummary summary_;
  bool needs_odometry_ = false;
  PlanarPose mounted_;  // where PARAM says that the laser is
  std::vector<std::uint32_t> mounted_geometries_;
  std::vector<Times> times_;  // of the scans
  std::vector<Odometry> odometry_, logger_odometry_;
  std::vector<double> logger_fix_times_;
};

}  // namespace

CarmenSummary ParseCarmen(std::string_view text, const std::string& name,
                          const CarmenOptions& options, LaserLog* log) {
  const auto robot = static_cast<std::uint32_t>(log->robots.size());
  const std::string family =
      options.robot.empty() ? "robot" + std::to_string(robot + 1) : options.robot;
  if (std::find(log->robots.begin(), log->robots.end(), family) != log->robots.end())
    throw Error("there is a robot " + Quoted(family) + " already", ErrorKind::kUsage);
  (void)Key(family, 0);  // refuses what cannot be the family of keys

  auto [own, summary] = Reader(text, name, options).Read();
  for (LaserScan& scan : own.scans) {
    scan.robot = robot;
    scan.geometry += static_cast<std::uint32_t>(log->geometries.size());
    scan.first_range += log->ranges.size();
  }
  for (GnssFix& fix : summary.fixes) fix.robot = family;
  log->robots.push_back(family);
  log->scans.insert(log->scans.end(), own.scans.begin(), own.scans.end());
  log->ranges.insert(log->ranges.end(), own.ranges.begin(), own.ranges.end());
  log->geometries.insert(log->geometries.end(), own.geometries.begin(), own.geometries.end());
  return summary;
}

std::string FormatCarmen(const LaserLog& log, std::size_t robot) {
  std::string text;
  for (const LaserScan& scan : log.scans)
    if (scan.robot == robot) AppendRobotLaser(log, scan, &text);
  return text;
}

}  // namespace graticule
