#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace graticule {

/// A number as SVG wants it: at most three decimals, no trailing zeros, never an exponent, blind to
/// the locale.  Not finite: "0".
std::string SvgNumber(double number);

/// Text that is safe in XML and HTML, between tags and inside quotes.  Control characters and bytes
/// that are not UTF-8 become U+FFFD.
std::string EscapeXml(std::string_view text);

/// The `d` of a path, kept short: relative moves between points rounded to `decimals` places, so
/// that rounding never adds up along a line.
class PathData {
 public:
  /// `decimals` in 0..3.
  explicit PathData(int decimals = 2);

  /// Begins a line.  LineTo comes after a MoveTo or a LineTo.
  void MoveTo(double x, double y);
  /// Leaves out a step that rounds to nothing.
  void LineTo(double x, double y);
  /// A line of its own.  Leaves it out if its ends round to the same point.
  void Segment(double x0, double y0, double x1, double y1);
  /// A dot, where the path is stroked with round caps.
  void Dot(double x, double y);
  /// Back to where the line began.  MoveTo comes next.
  void Close();

  bool Empty() const { return data_.empty(); }
  const std::string& Data() const { return data_; }

 private:
  void Pair(std::int64_t dx, std::int64_t dy, bool after_letter);
  std::int64_t Round(double value) const;

  int decimals_;
  double scale_;
  // Where the pen is, and where the line it draws began, in units of the last decimal.
  std::int64_t x_ = 0, y_ = 0, start_x_ = 0, start_y_ = 0;
  std::string data_;
};

/// Builds an SVG document, one element after the other.  Attribute values and text are escaped
/// here.
class Svg {
 public:
  using Attributes = std::vector<std::pair<std::string_view, std::string>>;

  /// A document of this size in pixels, which scales with the width it is given; with a unit
  /// ("mm"), of exactly that size on paper.
  Svg(double width, double height, std::string_view label = {}, std::string_view unit = {});

  void Open(std::string_view element, const Attributes& attributes = {});
  void Close();
  /// An element without children; with a `tooltip`, it carries a <title>.
  void Element(std::string_view element, const Attributes& attributes,
               std::string_view tooltip = {});
  void Path(const PathData& path, Attributes attributes, std::string_view tooltip = {});
  void Line(double x0, double y0, double x1, double y1, Attributes attributes);
  void Rect(double x, double y, double width, double height, Attributes attributes,
            std::string_view tooltip = {});
  void Circle(double x, double y, double radius, Attributes attributes,
              std::string_view tooltip = {});
  void Text(double x, double y, std::string_view text, Attributes attributes);

  /// A whole document as a part of this one, at its own size.
  void Nest(double x, double y, std::string_view document);

  /// Closes what is open, and returns the document.
  std::string Finish();

 private:
  void Tag(std::string_view element, const Attributes& attributes);

  std::string out_;
  std::vector<std::string> open_;
};

/// The same picture as a PNG file's bytes, `width_px` wide, on white.  Throws Error: not an SVG
/// document, or a picture that is too large (32767 pixels a side).
std::string PngFromSvg(const std::string& svg, int width_px);

/// The same picture as a PDF file's bytes: one page of this size, shapes as shapes.  The same
/// picture gives the same bytes.  Throws Error as PngFromSvg.
std::string PdfFromSvg(const std::string& svg, double width_mm, double height_mm);

}  // namespace graticule
