#pragma once

// Internal to the readers of detections: what every list of corners has to keep to.

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "graticule/io/detections.hpp"

namespace graticule {

/// Where each corner is on the target: one place for all views.
class PlacesOnTarget {
 public:
  /// What is wrong, if the corner's id has another place already.
  std::optional<std::string> Add(const DetectedCorner& corner) {
    const auto [known, added] = places_.emplace(corner.id, corner.in_target);
    if (added || known->second == corner.in_target) return std::nullopt;
    return "corner " + std::to_string(corner.id) + " has another place on the target elsewhere";
  }

 private:
  std::map<int, std::array<double, 3>> places_;
};

/// The ids of one view.
class IdsOfView {
 public:
  /// What is wrong, if the id is there already.
  std::optional<std::string> Add(int id) {
    if (ids_.insert(id).second) return std::nullopt;
    return "corner " + std::to_string(id) + " is in this view already";
  }

 private:
  std::set<int> ids_;
};

inline std::string SizeText(const ImageSize& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

}  // namespace graticule
