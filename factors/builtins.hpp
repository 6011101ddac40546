#pragma once

#include "graticule/solver/registry.hpp"

namespace graticule {

/// The registry with every built-in variable and factor type: what a program starts from.
Registry Builtins();

}  // namespace graticule
