#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/factor.hpp"
#include "graticule/solver/variable.hpp"

namespace graticule {

/// The variable and factor types that are known, by name.  A plain value, passed along, never
/// global: `Registry types = Builtins();` (factors/builtins.hpp), then plug-ins (solver/plugin.hpp)
/// are added to it.
class Registry {
 public:
  /// Throws Error (kMissingType) if the name is taken, naming both origins, or a factor type's
  /// schema names a variable type that is not here.
  void Add(VariableType type);
  void Add(FactorType type);

  /// The type of that name, if there is one.  `vectorN/1`, and the factor
  /// `gaussian/1` (what variables that left said about those that stay), need no adding.
  std::optional<VariableType> FindVariableType(std::string_view name) const;
  std::optional<FactorType> FindFactorType(std::string_view name) const;

  std::vector<const VariableType*> VariableTypes() const;  ///< by name
  std::vector<const FactorType*> FactorTypes() const;      ///< by name

 private:
  std::map<std::string, VariableType, std::less<>> variables_;
  std::map<std::string, FactorType, std::less<>> factors_;
};

}  // namespace graticule
