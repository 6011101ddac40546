#include "graticule/solver/registry.hpp"

#include "graticule/solver/error.hpp"
#include "graticule/solver/gaussian.hpp"

namespace graticule {
namespace {

template <class Type>
void AddOnce(std::map<std::string, Type, std::less<>>* types, Type type, const char* what) {
  const auto [it, added] = types->emplace(type.name, type);
  if (!added)
    throw Error(std::string(what) + " type " + type.name + " from " + type.origin +
                    " is already taken, by " + it->second.origin,
                ErrorKind::kMissingType);
}

template <class Type>
std::vector<const Type*> List(const std::map<std::string, Type, std::less<>>& types) {
  std::vector<const Type*> list;
  for (const auto& [name, type] : types) list.push_back(&type);
  return list;
}

}  // namespace

void Registry::Add(VariableType type) {
  VariableType vector;
  if (MakeVectorType(type.name, &vector) || type.name == kAnyVariable)
    throw Error(
        "variable type " + type.name + " from " + type.origin + " is already taken, by built-in",
        ErrorKind::kMissingType);
  AddOnce(&variables_, std::move(type), "variable");
}

void Registry::Add(FactorType type) {
  if (type.name == kGaussian)
    throw Error(
        "factor type " + type.name + " from " + type.origin + " is already taken, by built-in",
        ErrorKind::kMissingType);
  for (const Block& block : type.schema.blocks)
    if (!FindVariableType(block.variable_type))
      throw Error("factor type " + type.name + " from " + type.origin + " needs variable type " +
                      block.variable_type + ", which nobody provides",
                  ErrorKind::kMissingType);
  AddOnce(&factors_, std::move(type), "factor");
}

std::optional<VariableType> Registry::FindVariableType(std::string_view name) const {
  const auto it = variables_.find(name);
  if (it != variables_.end()) return it->second;
  VariableType vector;
  if (MakeVectorType(name, &vector)) return vector;
  return std::nullopt;
}

std::optional<FactorType> Registry::FindFactorType(std::string_view name) const {
  if (name == kGaussian) return GaussianType();
  const auto it = factors_.find(name);
  return it == factors_.end() ? std::nullopt : std::optional(it->second);
}

std::vector<const VariableType*> Registry::VariableTypes() const { return List(variables_); }
std::vector<const FactorType*> Registry::FactorTypes() const { return List(factors_); }

}  // namespace graticule
