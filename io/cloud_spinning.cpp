// Scans of rotating LIDARs: KITTI's files (Geiger et al. 2012), and their grid.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "graticule/io/cloud_fields.hpp"
#include "graticule/io/cloud_files.hpp"

namespace graticule {
namespace {

constexpr double kTurn = 6.283185307179586;
constexpr std::size_t kBytesOfPoint = 16;

// Counter-clockwise from straight ahead, in [0, 2 pi).
double Azimuth(const Eigen::Vector3f& point) {
  const double angle = std::atan2(point.y(), point.x());
  return angle < 0 ? std::min(angle + kTurn, std::nextafter(kTurn, 0)) : angle;
}

double Elevation(const Eigen::Vector3f& point) {
  return std::atan2(point.z(), std::hypot(point.x(), point.y()));
}

struct Return {
  std::size_t index;
  double azimuth;
};

using Rows = std::vector<std::vector<Return>>;

Rows SplitWhereTheAzimuthWraps(const std::vector<Return>& returns) {
  Rows rows(1);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (i > 0 && returns[i].azimuth < returns[i - 1].azimuth - kTurn / 2) rows.emplace_back();
    rows.back().push_back(returns[i]);
  }
  return rows;
}

Rows SplitByElevation(const PointCloud& cloud, const std::vector<Return>& returns,
                      std::size_t beams) {
  double low = kTurn, high = -kTurn;
  for (const Return& one : returns) {
    low = std::min(low, Elevation(cloud.in_sensor[one.index]));
    high = std::max(high, Elevation(cloud.in_sensor[one.index]));
  }
  const double step = high > low ? (high - low) / static_cast<double>(beams - 1) : 1;
  Rows rows(beams);
  for (const Return& one : returns) {
    const double down = (high - Elevation(cloud.in_sensor[one.index])) / step;
    rows[std::min(beams - 1, static_cast<std::size_t>(std::lround(down)))].push_back(one);
  }
  return rows;
}

// Between neighbours of a row that are not separated by missing returns; rows are sorted.
double AzimuthStep(const Rows& rows) {
  std::vector<double> steps;
  for (const auto& row : rows)
    for (std::size_t i = 1; i < row.size(); ++i)
      steps.push_back(row[i].azimuth - row[i - 1].azimuth);
  if (steps.empty()) return kTurn;
  std::nth_element(steps.begin(), steps.begin() + static_cast<long>(steps.size() / 2), steps.end());
  const double median = steps[steps.size() / 2];
  double sum = 0, count = 0;
  for (const double step : steps)
    if (step <= 1.5 * median) {
      sum += step;
      ++count;
    }
  // The finest encoders have 36,000 steps; 2^17 columns are enough.
  return std::max(sum / count, kTurn / (1 << 17));
}

}  // namespace

PointCloud ParseKittiScan(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) FailAtByte(name, 0, "there is no point in this cloud");
  if (bytes.size() % kBytesOfPoint != 0)
    FailAtByte(name, bytes.size() / kBytesOfPoint * kBytesOfPoint,
               "the last point is cut short: expected 16 bytes, found " +
                   std::to_string(bytes.size() % kBytesOfPoint));
  CloudFields fields;
  fields.SetFields({{"x"}, {"y"}, {"z"}, {"reflectance"}});
  PointCloud cloud;
  cloud.width = bytes.size() / kBytesOfPoint;
  std::vector<CloudPlace> places;
  for (std::size_t i = 0; i < 4; ++i) places.push_back({4 * i, kBytesOfPoint});
  fields.ReadBinary({bytes, name}, places, cloud.width, &cloud);
  return cloud;
}

PointCloud OrganiseSpinning(const PointCloud& cloud, const SpinningOptions& options) {
  const std::size_t beams = std::max<std::size_t>(2, options.beams);
  std::vector<Return> returns;
  for (std::size_t i = 0; i < cloud.Size(); ++i)
    if (cloud.in_sensor[i].allFinite()) returns.push_back({i, Azimuth(cloud.in_sensor[i])});
  Rows rows = SplitWhereTheAzimuthWraps(returns);
  if (rows.size() < 2 || rows.size() > beams + 2) rows = SplitByElevation(cloud, returns, beams);
  // Clockwise from straight behind: what is ahead is in the middle, left on the left.
  for (auto& row : rows)
    for (Return& one : row) one.azimuth = std::fmod(1.5 * kTurn - one.azimuth, kTurn);
  for (auto& row : rows)
    std::stable_sort(row.begin(), row.end(),
                     [](const Return& a, const Return& b) { return a.azimuth < b.azimuth; });

  const double step = AzimuthStep(rows);
  std::size_t width = 1;
  std::vector<std::size_t> column_of(cloud.Size());
  for (const auto& row : rows) {
    std::size_t next = 0;  // column that is free
    for (const Return& one : row) {
      const std::size_t column =
          std::max(next, static_cast<std::size_t>(std::floor(one.azimuth / step)));
      column_of[one.index] = column;
      next = column + 1;
    }
    width = std::max(width, next);
  }

  PointCloud grid;
  grid.is_spinning = true;
  grid.width = width;
  grid.height = rows.size();
  const std::size_t cells = width * rows.size();
  grid.in_sensor.assign(cells, kNoReturn);
  if (!cloud.colours.empty()) grid.colours.resize(cells);
  if (!cloud.intensities.empty()) grid.intensities.resize(cells);
  if (!cloud.labels.empty()) grid.labels.resize(cells);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (const Return& one : rows[r]) {
      const std::size_t cell = r * width + column_of[one.index];
      grid.in_sensor[cell] = cloud.in_sensor[one.index];
      if (!cloud.colours.empty()) grid.colours[cell] = cloud.colours[one.index];
      if (!cloud.intensities.empty()) grid.intensities[cell] = cloud.intensities[one.index];
      if (!cloud.labels.empty()) grid.labels[cell] = cloud.labels[one.index];
    }
  return grid;
}

}  // namespace graticule
