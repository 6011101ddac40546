#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// " (did you mean 'huber'?)", or "" where nothing is near: for errors about names that do not
/// exist.
std::string DidYouMean(std::string_view wrong, const std::vector<std::string_view>& names);

}  // namespace graticule
