// A plug-in: two factors of an automotive radar.  Nothing of Graticule is linked, only its headers
// are read.

#include <graticule/factors/sdk.hpp>

#include <cmath>
#include <stdexcept>

namespace {

/// The target is as far from the radar as measured.
/// Residual [m]: |target - radar| - range; zero when they agree.
struct RadarRange {
  static constexpr const char* kName = "radar_range/1";
  static constexpr const char* kSchema = "radar:se2/1 target:point2/1 | range:m";
  static constexpr const char* kSummary = "distance from a radar to a target";
  static constexpr bool kRelative = true;

  double range_m;

  explicit RadarRange(graticule::Measurement m) : range_m(m[0]) {
    if (range_m <= 0) throw std::invalid_argument("range: expected a distance above 0 m");
  }

  // T is double, or a number that carries its derivatives: use it for whatever depends on the
  // variables.
  template <class T>
  bool operator()(const T* radar, const T* target, T* residual) const {
    using std::sqrt;
    const T dx = target[0] - radar[0], dy = target[1] - radar[1];
    const T squared = dx * dx + dy * dy;
    if (!(squared > 0.0)) return false;  // no derivative where the target is the radar
    residual[0] = sqrt(squared) - range_m;
    return true;
  }
};

/// A resting target comes nearer as fast as the Doppler shift says.
/// Residual [m/s]: range rate minus measured; the radar's velocity is in the frame of the radar,
/// and the range rate of a resting target is minus its part along the line of sight; zero when they
/// agree.
struct RadarDoppler {
  static constexpr const char* kName = "radar_doppler/1";
  static constexpr const char* kSchema =
      "radar:se2/1 target:point2/1 velocity:vector2/1 | range_rate:m/s";
  static constexpr const char* kSummary = "range rate of a resting target, seen by a moving radar";
  static constexpr bool kRelative = true;

  double range_rate_m_s;

  explicit RadarDoppler(graticule::Measurement m) : range_rate_m_s(m[0]) {}

  template <class T>
  bool operator()(const T* radar, const T* target, const T* velocity, T* residual) const {
    using std::cos, std::sin, std::sqrt;
    const T c = cos(radar[2]), s = sin(radar[2]);
    const T dx = target[0] - radar[0], dy = target[1] - radar[1];
    const T x = c * dx + s * dy, y = c * dy - s * dx;  // target in the radar's frame
    const T squared = x * x + y * y;
    if (!(squared > 0.0)) return false;
    residual[0] = -(velocity[0] * x + velocity[1] * y) / sqrt(squared) - range_rate_m_s;
    return true;
  }
};

}  // namespace

GRATICULE_PLUGIN("radar", "1.0.0", "BSD-3-Clause", RadarRange, RadarDoppler)
