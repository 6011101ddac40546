#pragma once

#include <vector>

#include "graticule/io/laser_log.hpp"

namespace graticule {

/// A point that a laser saw, and how the surface lies there.
struct SurfacePoint {
  float x = 0, y = 0;    ///< m
  float nx = 0, ny = 0;  ///< unit normal of the surface, towards the laser; zero: not known
};

struct SurfaceOptions {
  double min_range = 0.15;  ///< m; nearer readings are the robot itself, or 0 for "nothing"
  double max_range = 30;    ///< m; readings from there on are not used
  double spacing = 0.04;    ///< m; points along a surface are thinned to this
};

/// What a scan saw, in its robot's frame.  Readings at or above the laser's own largest range saw
/// nothing.  A normal is that of the line through the neighbours along the sweep, where these lie
/// close together and on a line, and the beam does not graze it.
std::vector<SurfacePoint> SurfacePoints(const LaserLog& log, const LaserScan& scan,
                                        const SurfaceOptions& options = {});

/// Points of surfaces between readings that lie far apart on them, 0.1 m from one to the next.
/// Where a beam hits a wall far off, or slantingly, its neighbours hit it metres away, and the
/// next sweep hits it at the same places seen from the robot, wherever that has gone: against
/// readings alone such a wall says that the robot has not moved.
std::vector<SurfacePoint> PointsBetween(const LaserLog& log, const LaserScan& scan,
                                        const SurfaceOptions& options = {});

/// Adds the points, seen from another frame, to `to`.
void AppendTransformed(const std::vector<SurfacePoint>& points, const PlanarPose& frame,
                       std::vector<SurfacePoint>* to);

}  // namespace graticule
