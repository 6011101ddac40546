#include "fuzz.hpp"
#include "graticule/io/detections.hpp"

// A list of corners, or BabelCalib's three files one after the other, with zeros between.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  const std::size_t first = text.find('\0');
  if (first == std::string_view::npos) {
    ParseCornerList(text, "fuzz.vnl", "camera", {3, 2, 0.1, 640, 480});
    return;
  }
  const std::size_t second = std::min(text.find('\0', first + 1), text.size());
  const auto part = [&](const char* name, std::size_t begin, std::size_t end) {
    return NamedText{name, std::string(text.substr(begin, end - begin))};
  };
  ParseBabelcalib({part("fuzz.orpc", 0, first)}, part("fuzz.dsc", first + 1, second),
                  part("fuzz.tp", std::min(second + 1, text.size()), text.size()));
}
