// One scan into a 0.1 m grid: MRPT's COccupancyGridMap2D::insertObservation beside our drawing of
// the scan and adding of its votes, over all scans of two recorded logs, in one run.
//
//   graticule_mapping_mrpt --benchmark_repetitions=5
//
// Built where Debian's libmrpt-maps-dev is there.  Both cut ranges at 25 m and pass over readings
// without return; MRPT's map has its full size from the beginning.  Counter `a_scan`: CPU time
// of a scan.

#include <benchmark/benchmark.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "graticule/io/carmen.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/g2o_laser.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/problems/mapping/scan_points.hpp"
#include "graticule/problems/mapping/vote_grid.hpp"

namespace graticule {
namespace {

constexpr double kResolution = 0.1, kMaxRange = 25;

struct PlacedScans {
  LaserLog log;
  std::vector<PlanarPose> world_from_robot;
};

PlacedScans Killian() {
  const std::string path = std::string(GRATICULE_DATA_DIR) + "/mapping/killian_g2o/killian.g2o.gz";
  G2oLaser laser = ParseG2oLaser(ReadFile(path), path);
  return {std::move(laser.log), std::move(laser.world_from_robot)};
}

// Its dead reckoning is corrected already.
PlacedScans Campus() {
  const std::string path =
      std::string(GRATICULE_DATA_DIR) + "/mapping/ple_carmen/freiburg-campus-corrected.log.gz";
  PlacedScans placed;
  ParseCarmen(ReadFile(path), path, {}, &placed.log);
  for (const LaserScan& scan : placed.log.scans)
    placed.world_from_robot.push_back(scan.odom_from_robot);
  return placed;
}

void CountScans(benchmark::State* state, const PlacedScans& placed) {
  state->counters["a_scan"] = benchmark::Counter(
      static_cast<double>(placed.log.scans.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// `publish`: labels after every scan too, as a map that is read all the time would need.  What the
// votes lie in is there already, as MRPT's map is: a pass before the first that counts.
void Ours(benchmark::State& state, const PlacedScans& placed, bool publish) {
  ScanReader reader(RangeUse{kMaxRange, false});
  Rasteriser rasteriser(kResolution);
  std::vector<ScanTile> tiles;
  VoteGrid votes{VoteRule()};
  std::shared_ptr<const OccupancyMap> map = std::make_shared<OccupancyMap>(kResolution);
  MapChange change;
  const auto pass = [&] {
    for (std::size_t i = 0; i < placed.log.scans.size(); ++i) {
      const LaserScan& scan = placed.log.scans[i];
      rasteriser.Draw(reader.Read(placed.log.GeometryOf(scan), placed.log.RangesOf(scan)),
                      placed.world_from_robot[i], &tiles);
      for (const ScanTile& tile : tiles) votes.Replace({tile.index, {}, {}}, tile);
      if (publish) map = votes.Publish(map, &change);
    }
  };
  pass();
  for (auto _ : state) {
    state.PauseTiming();
    votes.Clear();
    map = votes.Publish(map, &change);
    state.ResumeTiming();
    pass();
  }
  CountScans(&state, placed);
}

mrpt::obs::CObservation2DRangeScan ObservationOf(const LaserLog& log, const LaserScan& scan) {
  const LaserGeometry& geometry = log.GeometryOf(scan);
  const Span<const float> ranges = log.RangesOf(scan);
  mrpt::obs::CObservation2DRangeScan observation;
  observation.resizeScan(ranges.size());
  observation.aperture = static_cast<float>(geometry.step * static_cast<double>(scan.beams - 1));
  observation.maxRange = static_cast<float>(geometry.max_range);
  const PlanarPose& at = geometry.robot_from_laser;
  // MRPT's beams lie evenly about its sensor's axis.
  observation.sensorPose = mrpt::poses::CPose3D(
      at.x, at.y, 0, at.yaw + geometry.first_angle + 0.5 * geometry.step * (scan.beams - 1), 0, 0);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const bool is_range =
        std::isfinite(ranges[i]) && ranges[i] > 0 && ranges[i] < geometry.max_range;
    observation.setScanRange(i, is_range ? ranges[i] : 0);
    observation.setScanRangeValidity(i, is_range);
  }
  return observation;
}

void Mrpt(benchmark::State& state, const PlacedScans& placed) {
  std::vector<mrpt::obs::CObservation2DRangeScan> observations;
  std::vector<mrpt::poses::CPose3D> poses;
  double left = std::numeric_limits<double>::infinity(), bottom = left, right = -left, top = -left;
  for (std::size_t i = 0; i < placed.log.scans.size(); ++i) {
    const PlanarPose& pose = placed.world_from_robot[i];
    observations.push_back(ObservationOf(placed.log, placed.log.scans[i]));
    poses.emplace_back(pose.x, pose.y, 0, pose.yaw, 0, 0);
    left = std::min(left, pose.x), right = std::max(right, pose.x);
    bottom = std::min(bottom, pose.y), top = std::max(top, pose.y);
  }
  constexpr double kBeyond = kMaxRange + 5;
  for (auto _ : state) {
    state.PauseTiming();
    {
      mrpt::maps::COccupancyGridMap2D map(
          static_cast<float>(left - kBeyond), static_cast<float>(right + kBeyond),
          static_cast<float>(bottom - kBeyond), static_cast<float>(top + kBeyond),
          static_cast<float>(kResolution));
      map.insertionOptions.maxDistanceInsertion = static_cast<float>(kMaxRange);
      map.insertionOptions.considerInvalidRangesAsFreeSpace = false;
      state.ResumeTiming();
      for (std::size_t i = 0; i < observations.size(); ++i)
        map.insertObservation(observations[i], poses[i]);
      benchmark::DoNotOptimize(map.getCell(0, 0));
      state.PauseTiming();
    }
    state.ResumeTiming();
  }
  CountScans(&state, placed);
}

}  // namespace
}  // namespace graticule

int main(int argc, char** argv) {
  using namespace graticule;
  const PlacedScans killian = Killian(), campus = Campus();
  for (const auto& [name, placed] :
       {std::pair("killian", &killian), std::pair("campus", &campus)}) {
    const std::string suffix = std::string("/") + name;
    const PlacedScans& scans = *placed;
    const auto add = [&](const std::string& what, auto run) {
      benchmark::RegisterBenchmark((what + suffix).c_str(), run)->Unit(benchmark::kMillisecond);
    };
    add("mrpt", [&scans](benchmark::State& state) { Mrpt(state, scans); });
    add("ours", [&scans](benchmark::State& state) { Ours(state, scans, false); });
    add("ours_published", [&scans](benchmark::State& state) { Ours(state, scans, true); });
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
