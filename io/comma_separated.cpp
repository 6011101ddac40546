#include "graticule/io/comma_separated.hpp"

#include "graticule/io/text.hpp"

namespace graticule {

std::string CommasAsBlanks(std::string_view text, const std::string& name) {
  std::string blanks(text);
  bool is_empty = true, is_comment = false;  // the place since the last comma; the line
  bool is_line_empty = true;
  for (std::size_t i = 0; i < blanks.size(); ++i) {
    char& c = blanks[i];
    if (c == '\n' || c == '\r') {
      is_empty = is_line_empty = true;
      is_comment = false;
    } else if (c == ',') {
      if (is_empty && !is_comment)
        TextReader(text, name).FailAt(i, "expected a value before this comma");
      is_empty = true;
      c = ' ';
    } else if (c != ' ' && c != '\t') {
      if (is_line_empty) is_comment = c == '#';
      is_empty = is_line_empty = false;
    }
  }
  return blanks;
}

}  // namespace graticule
