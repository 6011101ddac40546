#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/key.hpp"
#include "graticule/solver/loss.hpp"
#include "graticule/solver/noise.hpp"
#include "graticule/solver/plugin_abi.h"
#include "graticule/solver/schema.hpp"

namespace graticule {

/// What a kind of factor states: its schema, and the functions that evaluate it.
struct FactorType {
  std::string name;  ///< "between_se2/1"
  FactorSchema schema;
  std::string summary;
  std::string
      origin;  ///< "built-in", the plug-in's file, or "" for a type known only from a file's header
  /// Null for a type known only from a file's header: it can be read, described, sliced and
  /// written, not solved.
  const graticule_factor_type_v1* table = nullptr;

  bool Known() const { return table != nullptr; }
  bool IsRelative() const { return table && (table->flags & GRATICULE_FACTOR_RELATIVE); }
  bool HasTangentJacobians() const {
    return table && (table->flags & GRATICULE_FACTOR_TANGENT_JACOBIANS);
  }
};

/// A type from a C table, checked.  Throws Error (kMissingType).
FactorType MakeFactorType(const graticule_factor_type_v1& table, std::string origin);

/// One statement about some variables: data, evaluated only inside the solver.
struct Factor {
  std::string type;                 ///< "between_se2/1"
  std::vector<Key> keys;            ///< in the schema's order
  std::vector<double> measurement;  ///< laid out as the schema says
  Noise noise;
  Loss loss;
  std::string source;  ///< who said so: "odometry", "loop"; may be empty
};

/// Position of a variable or factor in its graph: stable, counted from 0 in the order of adding.
using VariableId = std::uint32_t;
using FactorId = std::uint32_t;

/// A factor as a graph stores it, seen through pointers: valid until the graph changes.
struct FactorView {
  const FactorType* type = nullptr;
  Span<const VariableId> variables;
  Span<const double> measurement;
  NoiseView noise;
  std::uint32_t noise_id = 0;  ///< equal ids: equal noise
  Loss loss;
  std::string_view source;
};

}  // namespace graticule
