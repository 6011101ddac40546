#include "fuzz.hpp"
#include "graticule/io/document.hpp"

namespace {

// Every place is in the file, and names and values are pairs.
void Walk(const graticule::DocumentNode& node) {
  if (node.IsMap() && node.keys.size() != node.values.size()) std::abort();
  for (const graticule::DocumentNode& value : node.values) Walk(value);
}

}  // namespace

// The first byte chooses the language.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  if (text.empty()) return;
  if (text[0] == '<')
    Walk(ParseXml(text, "fuzz.xml"));
  else if (text[0] == '{' || text[0] == '#')
    Walk(ParsePythonLiteral(text, "fuzz.cameramodel"));
  else
    Walk(ParseYaml(text, "fuzz.yaml"));
}
