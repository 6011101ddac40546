#include "graticule/solver/values.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {

Span<const double> Values::At(const Key& key) const {
  const VariableId id = layout_ ? layout_->Find(key) : Layout::kNone;
  if (id == Layout::kNone) throw Error("there is no variable " + key.ToString());
  return (*this)[id];
}

}  // namespace graticule
