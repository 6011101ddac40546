#include "graticule/solver/variable.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "graticule/solver/error.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {
namespace {

void Se2Plus(const double* x, const double* delta, double* y) {
  const double c = std::cos(x[2]), s = std::sin(x[2]);
  y[0] = x[0] + c * delta[0] - s * delta[1];
  y[1] = x[1] + s * delta[0] + c * delta[1];
  y[2] = WrapAngle(x[2] + delta[2]);
}

void Se2PlusJacobian(const double* x, double* j) {
  const double c = std::cos(x[2]), s = std::sin(x[2]);
  const double values[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  std::copy(values, values + 9, j);
}

void Se2Minus(const double* y, const double* x, double* delta) {
  const double c = std::cos(x[2]), s = std::sin(x[2]);
  delta[0] = c * (y[0] - x[0]) + s * (y[1] - x[1]);
  delta[1] = c * (y[1] - x[1]) - s * (y[0] - x[0]);
  delta[2] = WrapAngle(y[2] - x[2]);
}

void So3Plus(const double* q, const double* delta, double* y) { QuaternionPlus(q, delta, y); }

// d(q * Exp(d))/d(d) at 0: half of q times the pure quaternions i, j, k.
void QuaternionPlusJacobian(const double* q, double* j, int stride) {
  const double x = q[0] / 2, y = q[1] / 2, z = q[2] / 2, w = q[3] / 2;
  const double rows[4][3] = {{w, -z, y}, {z, w, -x}, {-y, x, w}, {-x, -y, -z}};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 3; ++c) j[r * stride + c] = rows[r][c];
}

void So3PlusJacobian(const double* q, double* j) { QuaternionPlusJacobian(q, j, 3); }

void So3Minus(const double* y, const double* x, double* delta) {
  double relative[4];
  QuaternionInverseProduct(x, y, relative);
  QuaternionLog(relative, delta);
}

// d Log(inverse(p) q Exp(d))/dd at 0: the inverse right Jacobian of SO(3) (Forster, Carlone,
// Dellaert, Scaramuzza: On-Manifold Preintegration, T-RO 2017, equation 8), with its coefficient
// written so that it has no pole at pi.
void So3MinusJacobian(const double* q, const double* p, double* j, int stride) {
  double w[3];
  So3Minus(q, p, w);
  const double squared = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], angle = std::sqrt(squared);
  const double c =
      squared > 1e-4 ? (1 - angle / 2 / std::tan(angle / 2)) / squared : 1.0 / 12 + squared / 720;
  const double cross[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const double square = w[row] * w[column] - (row == column ? squared : 0);
      j[row * stride + column] = (row == column ? 1 : 0) + cross[row][column] / 2 + c * square;
    }
}

void Se2MinusJacobian(const double* y, const double* x, double* j) {
  const double c = std::cos(y[2] - x[2]), s = std::sin(y[2] - x[2]);
  const double values[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  std::copy(values, values + 9, j);
}

void Se3Plus(const double* x, const double* delta, double* y) {
  double moved[3];
  QuaternionRotate(x + 3, delta, moved);
  for (int i = 0; i < 3; ++i) y[i] = x[i] + moved[i];
  QuaternionPlus(x + 3, delta + 3, y + 3);
}

void Se3PlusJacobian(const double* x, double* j) {
  std::fill(j, j + 42, 0.0);
  double r[9];
  QuaternionToMatrix(x + 3, r);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) j[row * 6 + column] = r[row * 3 + column];
  QuaternionPlusJacobian(x + 3, j + 3 * 6 + 3, 6);
}

void Se3Minus(const double* y, const double* x, double* delta) {
  const double moved[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
  const double inverse[4] = {-x[3], -x[4], -x[5], x[6]};
  QuaternionRotate(inverse, moved, delta);
  So3Minus(y + 3, x + 3, delta + 3);
}

void Se3MinusJacobian(const double* y, const double* x, double* j) {
  std::fill(j, j + 36, 0.0);
  double relative[4], r[9];
  QuaternionInverseProduct(x + 3, y + 3, relative);
  QuaternionToMatrix(relative, r);
  for (int row = 0; row < 3; ++row) std::copy(r + 3 * row, r + 3 * row + 3, j + 6 * row);
  So3MinusJacobian(y + 3, x + 3, j + 3 * 6 + 3, 6);
}

int32_t So3Normalise(double* x) { return NormaliseQuaternion(x); }
int32_t Se3Normalise(double* x) { return NormaliseQuaternion(x + 3); }

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr uint32_t kTableSize = sizeof(graticule_variable_type_v1);

constexpr graticule_variable_type_v1 kSe2 = {
    kTableSize,        0,
    "se2/1",           "x:m y:m yaw:rad",
    "x:m y:m yaw:rad", "pose in the plane: world_from_body",
    Se2Plus,           Se2PlusJacobian,
    Se2Minus,          nullptr};
constexpr graticule_variable_type_v1 kSo3 = {kTableSize,
                                             0,
                                             "so3/1",
                                             "qx qy qz qw",
                                             "rx:rad ry:rad rz:rad",
                                             "rotation in space: unit quaternion",
                                             So3Plus,
                                             So3PlusJacobian,
                                             So3Minus,
                                             So3Normalise};
constexpr graticule_variable_type_v1 kSe3 = {kTableSize,
                                             0,
                                             "se3/1",
                                             "x:m y:m z:m qx qy qz qw",
                                             "x:m y:m z:m rx:rad ry:rad rz:rad",
                                             "pose in space: world_from_body, unit quaternion",
                                             Se3Plus,
                                             Se3PlusJacobian,
                                             Se3Minus,
                                             Se3Normalise};
constexpr graticule_variable_type_v1 kPoint2 = {
    kTableSize, 0,       "point2/1", "x:m y:m", "x:m y:m", "point in the plane, in world",
    nullptr,    nullptr, nullptr,    nullptr};
constexpr graticule_variable_type_v1 kPoint3 = {
    kTableSize, 0,       "point3/1", "x:m y:m z:m", "x:m y:m z:m", "point in space, in world",
    nullptr,    nullptr, nullptr,    nullptr};
constexpr graticule_variable_type_v1 kBalCamera = {
    kTableSize,
    0,
    "bal_camera/1",
    "rx:rad ry:rad rz:rad tx ty tz f:px k1 k2",
    "rx:rad ry:rad rz:rad tx ty tz f:px k1 k2",
    "camera of Bundle Adjustment in the Large: camera_from_world as rotation vector and "
    "translation, focal "
    "length, radial distortion",
    nullptr,
    nullptr,
    nullptr,
    nullptr};
constexpr const graticule_variable_type_v1* kTables[] = {&kSe2,    &kSo3,    &kSe3,
                                                         &kPoint2, &kPoint3, &kBalCamera};

[[noreturn]] void Refuse(const std::string& origin, const std::string& why) {
  throw Error(origin + ": variable type refused: " + why, ErrorKind::kMissingType);
}

}  // namespace

Span<const graticule_variable_type_v1* const> BuiltinVariableTables() {
  return {kTables, std::size(kTables)};
}

// A plug-in's functions must not throw; where one does, nan stops whoever needed the numbers, with
// a factor's name attached.

void VariableType::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  if (!manifold) {
    for (int i = 0; i < Size(); ++i) x_plus_delta[i] = x[i] + delta[i];
    return;
  }
  try {
    manifold->plus(x, delta, x_plus_delta);
  } catch (...) {
    std::fill(x_plus_delta, x_plus_delta + Size(), kNan);
  }
}

void VariableType::Minus(const double* y, const double* x, double* y_minus_x) const {
  if (!manifold) {
    for (int i = 0; i < Size(); ++i) y_minus_x[i] = y[i] - x[i];
    return;
  }
  try {
    manifold->minus(y, x, y_minus_x);
  } catch (...) {
    std::fill(y_minus_x, y_minus_x + TangentSize(), kNan);
  }
}

void VariableType::PlusJacobian(const double* x, double* jacobian) const {
  const int n = Size();
  if (!manifold) {
    std::fill(jacobian, jacobian + n * n, 0.0);
    for (int i = 0; i < n; ++i) jacobian[i * n + i] = 1;
    return;
  }
  try {
    manifold->plus_jacobian(x, jacobian);
  } catch (...) {
    std::fill(jacobian, jacobian + n * TangentSize(), kNan);
  }
}

void VariableType::MinusJacobian(const double* y, const double* x, double* jacobian) const {
  if (manifold == &kSe2) return Se2MinusJacobian(y, x, jacobian);
  if (manifold == &kSo3) return So3MinusJacobian(y, x, jacobian, 3);
  if (manifold == &kSe3) return Se3MinusJacobian(y, x, jacobian);
  const auto n = static_cast<std::size_t>(TangentSize());
  std::fill(jacobian, jacobian + n * n, 0.0);
  if (!manifold) {
    for (std::size_t i = 0; i < n; ++i) jacobian[i * n + i] = 1;
    return;
  }
  constexpr double kStep = 6e-6;  // the cube root of double precision
  std::vector<double> delta(n, 0.0), moved(fields.size()), there(n), back(n);
  for (std::size_t c = 0; c < n; ++c) {
    delta[c] = kStep;
    Plus(y, delta.data(), moved.data());
    Minus(moved.data(), x, there.data());
    delta[c] = -kStep;
    Plus(y, delta.data(), moved.data());
    Minus(moved.data(), x, back.data());
    delta[c] = 0;
    for (std::size_t r = 0; r < n; ++r) jacobian[r * n + c] = (there[r] - back[r]) / (2 * kStep);
  }
}

bool VariableType::Normalise(double* x) const {
  if (!manifold || !manifold->normalise) return true;
  try {
    return manifold->normalise(x) != 0;
  } catch (...) {
    return false;
  }
}

VariableType MakeVariableType(const graticule_variable_type_v1& table, std::string origin) {
  if (table.size < kTableSize) Refuse(origin, "its table is too short for version 1");
  if (!table.name || !IsTypeName(table.name))
    Refuse(origin, "its name is not of the form name/version");
  const std::string name = table.name;
  if (!table.fields) Refuse(origin, name + " has no fields");
  VariableType type;
  type.name = name;
  try {
    type.fields = ParseFields(table.fields);
    type.tangent = table.tangent ? ParseFields(table.tangent) : type.fields;
  } catch (const Error& error) {
    Refuse(origin, name + ": " + error.what());
  }
  const bool is_manifold = table.plus || table.plus_jacobian || table.minus || table.normalise;
  if (is_manifold && (!table.plus || !table.plus_jacobian || !table.minus))
    Refuse(origin, name + " has some of plus, plus_jacobian, minus, and not all");
  if (!is_manifold && type.fields.size() != type.tangent.size())
    Refuse(origin, name + " has no plus, so its tangent must have the size of its fields");
  if (type.tangent.size() > type.fields.size())
    Refuse(origin, name + " has a tangent larger than its fields");
  if (type.fields.size() > 4096) Refuse(origin, name + " has more than 4096 fields");
  type.summary = table.summary ? table.summary : "";
  type.origin = std::move(origin);
  type.known = true;
  type.manifold = is_manifold ? &table : nullptr;
  return type;
}

bool MakeVectorType(std::string_view name, VariableType* type) {
  constexpr std::string_view kPrefix = "vector", kSuffix = "/1";
  if (name.size() <= kPrefix.size() + kSuffix.size() || name.substr(0, kPrefix.size()) != kPrefix ||
      name.substr(name.size() - kSuffix.size()) != kSuffix)
    return false;
  const char* begin = name.data() + kPrefix.size();
  const char* end = name.data() + name.size() - kSuffix.size();
  int size = 0;
  const auto [stop, problem] = std::from_chars(begin, end, size);
  if (problem != std::errc() || stop != end || *begin == '0' || *begin == '-' || size > 4096)
    return false;
  *type = VariableType();
  type->name = name;
  for (int i = 0; i < size; ++i) type->fields.push_back({"v" + std::to_string(i), ""});
  type->tangent = type->fields;
  type->summary = "vector of R^" + std::to_string(size);
  type->origin = "built-in";
  type->known = true;
  return true;
}

}  // namespace graticule
