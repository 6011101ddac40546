// One of two plug-ins whose structs have the same C++ name, outside an anonymous namespace.

#include <graticule/factors/sdk.hpp>

struct Scaled {
  static constexpr const char* kName = "scaled_1/1";
  static constexpr const char* kSchema = "x:vector1/1 | x";
  static constexpr const char* kSummary = "1 x";

  double measured;
  explicit Scaled(graticule::Measurement m) : measured(m[0]) {}

  template <class T>
  bool operator()(const T* x, T* residual) const {
    residual[0] = 1.0 * x[0] - measured;
    return true;
  }
};

GRATICULE_PLUGIN("scaled_1", "1.0.0", "MIT", Scaled)
