#pragma once

// Internal to detection: corners where four squares meet, found from those that are known already.

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "graticule/io/grey_image.hpp"
#include "graticule/problems/calibration/target.hpp"

namespace graticule {

/// How the target lies in the image near a corner: pixel = origin + slope * (place - corner's).
struct LocalMap {
  Eigen::Vector2d pixel;
  Eigen::Matrix2d slope;  ///< px/m
};

/// Finds saddles of a target in one image.
class SaddleFinder {
 public:
  /// `free_m` is how far from a corner nothing else is on the target along its rows and columns.
  SaddleFinder(const GreyImage& image, const std::vector<TargetCorner>& corners, double free_m);

  /// Looks for a corner (into the list) where it is expected; keeps it where it is found.
  bool Try(std::size_t corner, const LocalMap& expected);
  /// A corner that something else has found, to be polished.
  void Put(std::size_t corner, const Eigen::Vector2d& pixel) { found_[corner] = pixel; }
  /// From the corners that are kept to those near them, again and again.
  void Grow(double pitch_m);
  /// Once more with the neighbours' local maps, from where they say where that is far off; lets go
  /// of what does not fit them.
  void Polish(double pitch_m);

  const std::map<std::size_t, Eigen::Vector2d>& Found() const { return found_; }

 private:
  std::optional<LocalMap> FromNeighbours(std::size_t corner, double reach_m,
                                         bool with_itself) const;
  std::optional<Eigen::Vector2d> Refine(std::size_t corner, const LocalMap& expected) const;
  bool IsSaddle(std::size_t corner, const Eigen::Vector2d& pixel,
                const Eigen::Matrix2d& slope) const;
  double Shade(const Eigen::Vector2d& pixel) const;
  int Width() const { return static_cast<int>(image_.width); }
  int Height() const { return static_cast<int>(image_.height); }

  const GreyImage& image_;
  const std::vector<TargetCorner>& corners_;
  double free_m_;
  std::map<std::size_t, Eigen::Vector2d> found_;
};

}  // namespace graticule
