#pragma once

#include <string>
#include <vector>

namespace graticule::test {

/// The first thing that is wrong with a page's or a drawing's tags, or "": each that opens closes,
/// in order.  Does not know which elements HTML allows where.
inline std::string TagFault(const std::string& text) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while ((at = text.find('<', at)) != std::string::npos) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) return "'<' without '>'";
    const std::string tag = text.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag.empty()) return "empty tag";
    if (tag[0] == '!' || tag.back() == '/') continue;
    const bool closes = tag[0] == '/';
    const std::size_t begin = closes ? 1 : 0;
    const std::string name = tag.substr(begin, tag.find_first_of(" \n", begin) - begin);
    if (!closes) {
      if (name != "meta") open.push_back(name);
      if (name == "style") at = text.find("</style>", at);
      continue;
    }
    if (open.empty() || open.back() != name)
      return "</" + name + "> closes <" + (open.empty() ? "nothing" : open.back()) + ">";
    open.pop_back();
  }
  return open.empty() ? "" : "<" + open.back() + "> stays open";
}

inline std::size_t Count(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++count;
  return count;
}

/// Nothing is fetched from elsewhere: the only address is SVG's namespace.
inline bool IsSelfContained(const std::string& page) {
  return Count(page, "http") == Count(page, "xmlns=\"http://www.w3.org/2000/svg\"") &&
         Count(page, "<script") == 0 && Count(page, "url(") == 0 && Count(page, "@import") == 0;
}

}  // namespace graticule::test
