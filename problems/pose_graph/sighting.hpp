#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace graticule {

/// What a factor says of a landmark, its second variable, that it sees from a pose, its first.
enum class Sight : std::uint8_t {
  kNone,  ///< it is no such factor
  kPlanar,
  kSpatial,
  kSpatialOffset,
  kBearing,
  kRange,
  kBearingRange
};

/// By the factor type's name.
Sight SightOf(std::string_view type);

/// Whether one such sighting says where the landmark is.
inline bool SaysAll(Sight sight) {
  return sight != Sight::kNone && sight != Sight::kBearing && sight != Sight::kRange;
}

/// The landmark in the world, from a sighting that says all of it.
void PlaceFromSight(Sight sight, const double* pose, const double* measured, double* landmark);

/// Bearings and ranges of one landmark of the plane.
class PartialSightings {
 public:
  /// Takes in a kBearing or kRange from a pose.
  void Add(Sight sight, const double* pose, const double* measured);
  /// Where the first bearing and the one that crosses it best do, ahead of both: true.  Else an
  /// assumption, and false: on the first bearing at the first range or an assumed 10 m; where there
  /// is no bearing, straight ahead.
  bool Place(double* landmark) const;

 private:
  struct Ray {
    double x_m, y_m, heading_rad;
  };
  static bool Cross(const Ray& a, const Ray& b, double* point);

  std::vector<Ray> rays_;
  double range_m_ = -1;
  Ray range_from_{};
};

}  // namespace graticule
