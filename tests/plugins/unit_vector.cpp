// A plug-in with a variable type of its own: directions in space, and a factor that measures one.

#include <graticule/factors/sdk.hpp>

#include <Eigen/Dense>

namespace {

/// A direction: a unit vector, changed along two axes across it.
struct UnitVector3 {
  static constexpr const char* kName = "unit_vector3/1";
  static constexpr const char* kFields = "x y z";
  static constexpr const char* kTangent = "u:rad v:rad";
  static constexpr const char* kSummary = "direction in space: unit vector";

  using Vector = Eigen::Map<const Eigen::Vector3d>;

  // Two axes across x, the same for the same x.
  static Eigen::Matrix<double, 3, 2> Across(const double* x) {
    const Eigen::Vector3d n = Vector(x);
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Index axis = 0;
    n.cwiseAbs().minCoeff(&axis);
    least(axis) = 1;
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = n.cross(least).normalized();
    across.col(1) = n.cross(across.col(0));
    return across;
  }

  static void Plus(const double* x, const double* delta, double* x_plus_delta) {
    const Eigen::Vector3d turn = Across(x) * Eigen::Vector2d(delta[0], delta[1]);
    const double angle = turn.norm();
    const double ratio = angle > 1e-9 ? std::sin(angle) / angle : 1;
    Eigen::Map<Eigen::Vector3d>(x_plus_delta, 3) =
        (std::cos(angle) * Vector(x) + ratio * turn).normalized();
  }

  static void PlusJacobian(const double* x, double* jacobian) {
    Eigen::Map<Eigen::Matrix<double, 3, 2, Eigen::RowMajor>>(jacobian, 3, 2) = Across(x);
  }

  static void Minus(const double* y, const double* x, double* y_minus_x) {
    const Eigen::Vector2d flat = Across(x).transpose() * Vector(y);
    const double sine = flat.norm();
    const double ratio = sine > 1e-9 ? std::atan2(sine, Vector(x).dot(Vector(y))) / sine : 1;
    Eigen::Map<Eigen::Vector2d>(y_minus_x, 2) = ratio * flat;
  }

  static bool Normalise(double* x) {
    Eigen::Map<Eigen::Vector3d> n(x);
    if (!(std::abs(n.norm() - 1) < 1e-3)) return false;
    n.normalize();
    return true;
  }
};

/// A direction was measured, as a vector.
/// Residual: difference of the unit vectors, zero when they agree.
struct DirectionFactor {
  static constexpr const char* kName = "direction/1";
  static constexpr const char* kSchema = "direction:unit_vector3/1 | x y z";
  static constexpr const char* kSummary = "direction in space was measured";
  static constexpr int kBlockSizes[] = {3};

  double x, y, z;
  explicit DirectionFactor(graticule::Measurement m) : x(m[0]), y(m[1]), z(m[2]) {}

  template <class T>
  bool operator()(const T* direction, T* residual) const {
    residual[0] = direction[0] - x;
    residual[1] = direction[1] - y;
    residual[2] = direction[2] - z;
    return true;
  }
};

}  // namespace

GRATICULE_PLUGIN("directions", "1.0.0", "MIT", DirectionFactor, UnitVector3)
