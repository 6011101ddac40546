#pragma once

#include <string>
#include <string_view>

#include "graticule/solver/plugin_abi.h"
#include "graticule/solver/schema.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// What a variable is made of: its stored fields, and how a small change in its tangent space is
/// applied.
///
/// Built in: `se2/1` [x y yaw], `so3/1` [qx qy qz qw], `se3/1` [x y z qx qy qz qw], `point2/1`,
/// `point3/1`, `bal_camera/1`, and `vectorN/1` for any N up to 4096.  Tangent order is translation,
/// rotation, applied on the right: x + d = x * Exp(d), with the translation not coupled to the
/// rotation.
struct VariableType {
  std::string name;
  Fields fields;
  Fields tangent;
  std::string summary;
  std::string
      origin;  ///< "built-in", the plug-in's file, or "" for a type known only from a file's header
  bool known = false;  ///< false: can be read, described and written, not solved
  /// The manifold's functions; null for vectors of R^n and for types that are not known.
  const graticule_variable_type_v1* manifold = nullptr;

  int Size() const { return static_cast<int>(fields.size()); }
  int TangentSize() const { return static_cast<int>(tangent.size()); }

  /// x_plus_delta = x [+] delta.  The output must not overlap the inputs.
  void Plus(const double* x, const double* delta, double* x_plus_delta) const;
  /// y_minus_x such that x [+] y_minus_x = y.
  void Minus(const double* y, const double* x, double* y_minus_x) const;
  /// d(x [+] delta)/d(delta) at 0: Size() x TangentSize(), row-major.
  void PlusJacobian(const double* x, double* jacobian) const;
  /// d((y [+] delta) [-] x)/d(delta) at 0: TangentSize() x TangentSize(), row-major.  Exact for
  /// vectors and the built-in manifolds; for a plug-in's, which has no function for it, central
  /// differences, good to about 1e-9 of the fields' size.
  void MinusJacobian(const double* y, const double* x, double* jacobian) const;
  /// Brings x onto the manifold.  False if it is too far off to be meant (a quaternion of norm 2).
  bool Normalise(double* x) const;
};

/// True for se2/1 and se3/1.
inline bool IsPose(const VariableType& type) {
  return type.name == "se2/1" || type.name == "se3/1";
}

/// A type from a C table, checked: sizes, names, schema, null functions.  Throws Error
/// (kMissingType).
VariableType MakeVariableType(const graticule_variable_type_v1& table, std::string origin);

/// `vectorN/1`, or false if the name is not one of those.
bool MakeVectorType(std::string_view name, VariableType* type);

/// The tables of se2, so3, se3, point2, point3 and bal_camera.
Span<const graticule_variable_type_v1* const> BuiltinVariableTables();

}  // namespace graticule
