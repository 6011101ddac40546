#include "graticule/io/image_panel.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/base64.hpp"
#include "graticule/io/plot_style.hpp"

namespace graticule {

ImagePanel::ImagePanel(int width, int height, double left, double top, double most_width,
                       double most_height)
    : width_(std::max(width, 1)), height_(std::max(height, 1)), left_(left), top_(top) {
  scale_ = std::min(most_width / width_, most_height / height_);
}

void ImagePanel::Open(const std::optional<GreyImage>& image, Svg* svg) const {
  svg->Open("svg", {{"x", SvgNumber(left_)},
                    {"y", SvgNumber(top_)},
                    {"width", SvgNumber(Width())},
                    {"height", SvgNumber(Height())},
                    {"viewBox", "0 0 " + SvgNumber(Width()) + " " + SvgNumber(Height())}});
  svg->Rect(0, 0, Width(), Height(), plot::Paper());
  if (!image || image->shades.empty()) return;
  // More than the panel's pixels, for screens that have them.
  const GreyImage shown = ShrinkImage(*image, static_cast<std::size_t>(std::ceil(1.5 * Width())),
                                      static_cast<std::size_t>(std::ceil(1.5 * Height())));
  svg->Element("image", {{"width", SvgNumber(Width())},
                         {"height", SvgNumber(Height())},
                         {"preserveAspectRatio", "none"},
                         {"href", "data:image/png;base64," + Base64(FormatPng(shown))}});
}

void ImagePanel::Close(Svg* svg) const {
  svg->Close();
  svg->Rect(left_, top_, Width(), Height(), plot::Frame());
}

void ImagePanel::AddLine(const std::vector<ImagePoint>& line, bool closed, PathData* path) const {
  bool begun = false, whole = true;
  for (const ImagePoint& point : line) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      begun = whole = false;
      continue;
    }
    begun ? path->LineTo(X(point.x), Y(point.y)) : path->MoveTo(X(point.x), Y(point.y));
    begun = true;
  }
  if (closed && begun && whole) path->Close();
}

void ImagePanel::Label(const ImagePoint& at, std::string_view text, Svg* svg) const {
  constexpr double kSize = 11.5, kHeight = 19;
  const double width = plot::TextWidth(text, kSize) + 8;
  double x = X(at.x) + 12, y = Y(at.y) - kHeight / 2;
  if (x + width > Width() - 3) x = X(at.x) - 12 - width;
  x = std::clamp(x, 3.0, std::max(3.0, Width() - width - 3));
  y = std::clamp(y, 3.0, std::max(3.0, Height() - kHeight - 3));
  plot::Attributes plate = plot::Paper();
  plate.emplace_back("rx", "3");
  plate.emplace_back("fill-opacity", "0.88");
  svg->Rect(x, y, width, kHeight, plate);
  svg->Text(x + 4, y + 13.5, text, plot::Ink(kSize));
}

double DrawPictureTitle(std::string_view title, std::string_view subtitle, double width, Svg* svg) {
  constexpr double kMargin = 12;
  double y = 0;
  if (!title.empty()) {
    y = 22;
    if (svg) svg->Text(kMargin, y, plot::Shorten(title, width - 24, 14), plot::Ink(14, {}, true));
  }
  if (!subtitle.empty()) {
    y += 18;
    if (svg) svg->Text(kMargin, y, plot::Shorten(subtitle, width - 24, 11.5), plot::SoftInk(11.5));
  }
  return y + 10;
}

GreyImage ShrinkImage(const GreyImage& image, std::size_t most_width, std::size_t most_height) {
  const double factor = std::max(
      {1.0,
       static_cast<double>(image.width) / static_cast<double>(std::max<std::size_t>(most_width, 1)),
       static_cast<double>(image.height) /
           static_cast<double>(std::max<std::size_t>(most_height, 1))});
  if (factor <= 1) return image;
  GreyImage small;
  small.width =
      std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(image.width) / factor));
  small.height = std::max<std::size_t>(
      1, static_cast<std::size_t>(static_cast<double>(image.height) / factor));
  small.shades.reserve(small.width * small.height);
  for (std::size_t y = 0; y < small.height; ++y) {
    const std::size_t y0 = y * image.height / small.height;
    const std::size_t y1 = std::max(y0 + 1, (y + 1) * image.height / small.height);
    for (std::size_t x = 0; x < small.width; ++x) {
      const std::size_t x0 = x * image.width / small.width;
      const std::size_t x1 = std::max(x0 + 1, (x + 1) * image.width / small.width);
      std::size_t sum = 0;
      for (std::size_t v = y0; v < y1; ++v)
        for (std::size_t u = x0; u < x1; ++u) sum += image.shades[v * image.width + u];
      small.shades.push_back(static_cast<std::uint8_t>(sum / ((y1 - y0) * (x1 - x0))));
    }
  }
  return small;
}

}  // namespace graticule
