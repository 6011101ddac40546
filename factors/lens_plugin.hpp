#pragma once

#include <string>
#include <vector>

#include "graticule/solver/registry.hpp"

namespace graticule {

/// Makes a loaded plug-in's lenses camera models that CameraModelOf knows, by name, in the whole
/// process and for ever, as the library itself stays; `types` has the plug-in's types already
/// (LoadPlugin).  Returns their names: none where a plug-in has no lens.  The same plug-in again is
/// no mistake.  Throws Error (kMissingType): a table that is not right, a lens without its types, a
/// name already taken; no lens of the plug-in is known then.
std::vector<std::string> LoadLenses(const std::string& file, const Registry& types);

}  // namespace graticule
