#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// Parts of a self-contained page: no script, no network; light or dark as the reader's system is,
/// light on paper.  Text is escaped here; what is named `html` is put in as it is.
namespace html {

struct Cell {
  std::string text = {};
  std::string css = {};  ///< classes: "best", "bad"; may be empty
  double bar = -1;       ///< 0..1: a bar of this length behind the text; below 0: none
};

struct Column {
  std::string name;
  bool number = false;    ///< set to the right, in even digits
  std::string hint = {};  ///< shown while the pointer rests on the heading
};

std::string Table(const std::vector<Column>& columns, const std::vector<std::vector<Cell>>& rows);

struct Card {
  std::string name, value, note;
};
std::string Cards(const std::vector<Card>& cards);

std::string Section(std::string_view title, std::string_view html);
std::string Details(std::string_view title, std::string_view html);
/// A figure: an SVG document, or nothing.
std::string Figure(std::string_view svg);
std::string Paragraph(std::string_view text, std::string_view css = {});
std::string List(const std::vector<std::string>& items);

/// A whole page; `header` is what stands above the first section.
std::string Page(std::string_view title, std::string_view header_html, std::string_view body_html);

}  // namespace html
}  // namespace graticule
