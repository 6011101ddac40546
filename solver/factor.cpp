#include "graticule/solver/factor.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {

FactorType MakeFactorType(const graticule_factor_type_v1& table, std::string origin) {
  const auto refuse = [&](const std::string& why) {
    throw Error(origin + ": factor type refused: " + why, ErrorKind::kMissingType);
  };
  if (table.size < sizeof(graticule_factor_type_v1)) refuse("its table is too short for version 1");
  if (!table.name || !IsTypeName(table.name)) refuse("its name is not of the form name/version");
  const std::string name = table.name;
  if (!table.schema) refuse(name + " has no schema");
  if (!table.create || !table.evaluate || !table.destroy)
    refuse(name + " lacks create, evaluate or destroy");
  FactorType type;
  type.name = name;
  try {
    type.schema = ParseFactorSchema(table.schema);
  } catch (const Error& error) {
    refuse(name + ": " + error.what());
  }
  type.summary = table.summary ? table.summary : "";
  type.origin = std::move(origin);
  type.table = &table;
  return type;
}

}  // namespace graticule
