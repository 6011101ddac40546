#include "graticule/problems/mapping/map_extent.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "graticule/problems/mapping/occupancy_map.hpp"
#include "graticule/problems/mapping/rasteriser.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

void MapExtent::Include(std::size_t node, const PlanarPose& pose, double reach) {
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y) || !std::isfinite(pose.yaw))
    throw Error("the pose of node " + std::to_string(node) + " is not finite");
  if (any_ && pose.x - reach >= left_ && pose.x + reach <= right_ && pose.y - reach >= bottom_ &&
      pose.y + reach <= top_)
    return;
  MapExtent grown = *this;
  grown.left_ = any_ ? std::min(left_, pose.x - reach) : pose.x - reach;
  grown.right_ = any_ ? std::max(right_, pose.x + reach) : pose.x + reach;
  grown.bottom_ = any_ ? std::min(bottom_, pose.y - reach) : pose.y - reach;
  grown.top_ = any_ ? std::max(top_, pose.y + reach) : pose.y + reach;
  grown.any_ = true;
  // A quarter of what a PageGrid holds: it grows by more than it has to.
  const double page = resolution_ * kTileSide * kPageSide;
  const double pages =
      ((grown.right_ - grown.left_) / page + 2) * ((grown.top_ - grown.bottom_) / page + 2);
  const double cell =
      std::max({-grown.left_, grown.right_, -grown.bottom_, grown.top_}) / resolution_;
  if (!(pages < static_cast<double>(OccupancyMap::Pages::kMaxPages) / 4) ||
      !(cell < Rasteriser::kMaxCell))
    throw Error("the pose of node " + std::to_string(node) + ", (" + Shown(pose.x) + ", " +
                Shown(pose.y) + "), is too far away: the map would have more cells than it can");
  *this = grown;
}

}  // namespace graticule
