#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// One number of a variable, measurement or residual: its name and unit ("" where it has none).
/// Written `x:m`, `yaw:rad`, `qw`.
struct Field {
  std::string name;
  std::string unit;
};
using Fields = std::vector<Field>;

/// Where a schema names this as a block's type, variables of every type may stand there: the
/// solver's own gaussian/1 alone may (solver/gaussian.hpp).
constexpr const char* kAnyVariable = "any/1";

/// A variable that a factor type touches: the role it plays there and its variable type.
struct Block {
  std::string role;           ///< "a"
  std::string variable_type;  ///< "se2/1"
};

/// What a factor type joins, measures and returns.  Written
///
///     a:se2/1 b:se2/1 | x:m y:m yaw:rad | x:m y:m yaw:rad
///
/// blocks | measurement | residual.  Where the third part is missing the residual has the fields of
/// the measurement.  A `*` after the last block or the last measurement field: it comes any number
/// of times (zero or more times after its first).  A residual field with `*`: its count is known
/// only to the factor.
struct FactorSchema {
  std::vector<Block> blocks;
  bool repeats_last_block = false;
  Fields measurement;
  bool repeats_last_measurement = false;
  Fields residual;
  bool repeats_last_residual = false;

  /// True if a factor may have this many blocks / measured numbers.
  bool AcceptsBlocks(std::size_t count) const;
  bool AcceptsMeasurement(std::size_t count) const;
  /// The type that block number `i` must have.
  const std::string& BlockType(std::size_t i) const;
};

/// Reads the notation above.  Throws Error that names what is wrong.
FactorSchema ParseFactorSchema(std::string_view text);
std::string ToString(const FactorSchema& schema);

/// Reads `x:m y:m yaw:rad`.  Throws Error.
Fields ParseFields(std::string_view text);
std::string ToString(const Fields& fields);

/// True for `name/version`: letters, digits, `_`, then a slash and a positive number.
bool IsTypeName(std::string_view name);

}  // namespace graticule
