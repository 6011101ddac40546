#include "graticule/io/svg.hpp"

#include <charconv>
#include <cmath>

namespace graticule {
namespace {

constexpr std::int64_t kPowerOfTen[] = {1, 10, 100, 1000};

// A whole number of 10^-decimals, as the shortest decimal: 1250 of 10^-3 is 1.25, -500 is -.5.
void AppendQuantum(std::int64_t quantum, int decimals, std::string* out) {
  if (quantum < 0) out->push_back('-');
  const std::uint64_t size =
      quantum < 0 ? ~static_cast<std::uint64_t>(quantum) + 1 : static_cast<std::uint64_t>(quantum);
  const std::uint64_t unit = static_cast<std::uint64_t>(kPowerOfTen[decimals]);
  const std::uint64_t whole = size / unit;
  std::uint64_t rest = size % unit;
  if (whole != 0 || rest == 0) {
    char digits[24];
    const auto end = std::to_chars(digits, digits + sizeof digits, whole).ptr;
    out->append(digits, end);
  }
  if (rest == 0) return;
  out->push_back('.');
  for (std::uint64_t place = unit / 10; rest != 0; place /= 10) {
    out->push_back(static_cast<char>('0' + rest / place));
    rest %= place;
  }
}

std::int64_t Quantise(double value, double scale) {
  constexpr double kLimit = 1e15;
  if (!std::isfinite(value)) return 0;
  const double scaled = value * scale;
  return std::llround(scaled < -kLimit ? -kLimit : scaled > kLimit ? kLimit : scaled);
}

// Length of the UTF-8 sequence that begins here, 0 if it is not one.
std::size_t SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool overlong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xf0 && byte(1) < 0x90);
  const bool surrogate = first == 0xed && byte(1) > 0x9f;
  const bool beyond = first == 0xf4 && byte(1) > 0x8f;
  const bool not_a_character = first == 0xef && byte(1) == 0xbf && byte(2) >= 0xbe;
  return overlong || surrogate || beyond || not_a_character ? 0 : length;
}

}  // namespace

std::string SvgNumber(double number) {
  std::string out;
  const std::int64_t quantum = Quantise(number, 1000);
  AppendQuantum(quantum, 3, &out);
  return out;
}

std::string EscapeXml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = SequenceLength(text);
    const char c = text[0];
    if (length == 0 ||
        (length == 1 && ((c >= 0 && c < ' ' && c != '\t' && c != '\n') || c == 0x7f)))
      out += "\xef\xbf\xbd";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out.append(text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

PathData::PathData(int decimals)
    : decimals_(decimals), scale_(static_cast<double>(kPowerOfTen[decimals])) {}

std::int64_t PathData::Round(double value) const { return Quantise(value, scale_); }

void PathData::Pair(std::int64_t dx, std::int64_t dy, bool after_letter) {
  if (!after_letter && dx >= 0) data_.push_back(' ');
  AppendQuantum(dx, decimals_, &data_);
  if (dy >= 0) data_.push_back(' ');
  AppendQuantum(dy, decimals_, &data_);
  x_ += dx;
  y_ += dy;
}

void PathData::MoveTo(double x, double y) {
  data_.push_back(
      'm');  // the first one of a path is taken as absolute; bare pairs after it are 'l'
  Pair(Round(x) - x_, Round(y) - y_, true);
  start_x_ = x_;
  start_y_ = y_;
}

void PathData::LineTo(double x, double y) {
  const std::int64_t dx = Round(x) - x_, dy = Round(y) - y_;
  if (dx != 0 || dy != 0) Pair(dx, dy, false);
}

void PathData::Segment(double x0, double y0, double x1, double y1) {
  if (Round(x0) == Round(x1) && Round(y0) == Round(y1)) return;
  MoveTo(x0, y0);
  LineTo(x1, y1);
}

void PathData::Dot(double x, double y) {
  MoveTo(x, y);
  data_ += "h0";
}

void PathData::Close() {
  data_.push_back('z');
  x_ = start_x_;
  y_ = start_y_;
}

Svg::Svg(double width, double height, std::string_view label, std::string_view unit) {
  Open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
               {"viewBox", "0 0 " + SvgNumber(width) + " " + SvgNumber(height)},
               {"width", SvgNumber(width) + std::string(unit)},
               {"height", SvgNumber(height) + std::string(unit)},
               {"font-family", "DejaVu Sans,Verdana,Arial,sans-serif"},
               {"role", "img"},
               {"aria-label", std::string(label)}});
}

void Svg::Tag(std::string_view element, const Attributes& attributes) {
  out_ += '<';
  out_ += element;
  for (const auto& [name, value] : attributes) {
    if (value.empty()) continue;
    out_ += ' ';
    out_ += name;
    out_ += "=\"";
    out_ += EscapeXml(value);
    out_ += '"';
  }
}

void Svg::Open(std::string_view element, const Attributes& attributes) {
  Tag(element, attributes);
  out_ += ">\n";
  open_.emplace_back(element);
}

void Svg::Close() {
  out_ += "</" + open_.back() + ">\n";
  open_.pop_back();
}

void Svg::Element(std::string_view element, const Attributes& attributes,
                  std::string_view tooltip) {
  Tag(element, attributes);
  if (tooltip.empty()) {
    out_ += "/>\n";
    return;
  }
  out_ += "><title>" + EscapeXml(tooltip) + "</title></" + std::string(element) + ">\n";
}

void Svg::Path(const PathData& path, Attributes attributes, std::string_view tooltip) {
  if (path.Empty()) return;
  attributes.emplace_back("d", path.Data());
  Element("path", attributes, tooltip);
}

void Svg::Line(double x0, double y0, double x1, double y1, Attributes attributes) {
  attributes.insert(
      attributes.begin(),
      {{"x1", SvgNumber(x0)}, {"y1", SvgNumber(y0)}, {"x2", SvgNumber(x1)}, {"y2", SvgNumber(y1)}});
  Element("line", attributes);
}

void Svg::Rect(double x, double y, double width, double height, Attributes attributes,
               std::string_view tooltip) {
  attributes.insert(attributes.begin(), {{"x", SvgNumber(x)},
                                         {"y", SvgNumber(y)},
                                         {"width", SvgNumber(width)},
                                         {"height", SvgNumber(height)}});
  Element("rect", attributes, tooltip);
}

void Svg::Circle(double x, double y, double radius, Attributes attributes,
                 std::string_view tooltip) {
  attributes.insert(attributes.begin(),
                    {{"cx", SvgNumber(x)}, {"cy", SvgNumber(y)}, {"r", SvgNumber(radius)}});
  Element("circle", attributes, tooltip);
}

void Svg::Text(double x, double y, std::string_view text, Attributes attributes) {
  attributes.insert(attributes.begin(), {{"x", SvgNumber(x)}, {"y", SvgNumber(y)}});
  Tag("text", attributes);
  out_ += ">" + EscapeXml(text) + "</text>\n";
}

void Svg::Nest(double x, double y, std::string_view document) {
  constexpr std::string_view kRoot = "<svg";
  const std::size_t root = document.find(kRoot);
  if (root == std::string_view::npos) return;
  out_ += "<svg x=\"" + SvgNumber(x) + "\" y=\"" + SvgNumber(y) + "\"";
  out_ += document.substr(root + kRoot.size());
}

std::string Svg::Finish() {
  while (!open_.empty()) Close();
  return std::move(out_);
}

}  // namespace graticule
