#pragma once

#include <string>

namespace graticule {

/// A value of nlohmann's as text, on one line or indented by so many blanks.  Bytes that are not
/// UTF-8 become U+FFFD: names of files and what stands in them may hold any, and the library's own
/// `dump` throws there.  A template, so that this header does without the library's, which takes
/// seconds to compile.
template <class Json>
std::string JsonText(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace graticule
