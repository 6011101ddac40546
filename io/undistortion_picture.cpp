// DrawUndistortion of calibration_pictures.hpp.

#include <algorithm>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/image_panel.hpp"
#include "graticule/io/plot_style.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 1160, kMargin = 12, kGap = 18;

ImagePanel PanelOf(const UndistortionPicture::Side& side, double left) {
  return {side.width, side.height, left, 54, (kWidth - 2 * kMargin - kGap) / 2, 470};
}

double DrawSide(const UndistortionPicture::Side& side, double left, Svg* svg) {
  const ImagePanel panel = PanelOf(side, left);
  svg->Text(left, 46, side.title, plot::SoftInk(12));
  panel.Open(side.image, svg);
  const auto draw = [&](const std::vector<ImageLine>& lines, plot::Attributes stroke) {
    PathData path(1);
    for (const ImageLine& line : lines) panel.AddLine(line, false, &path);
    stroke.emplace_back("stroke-linejoin", "round");
    svg->Path(path, stroke);
  };
  plot::Attributes grid = plot::SeriesStroke(0, side.image ? 1 : 1.2);
  if (side.image) grid.emplace_back("stroke-opacity", "0.55");
  draw(side.grid, grid);
  draw(side.marks, plot::SeriesStroke(1, 1.4));
  panel.Close(svg);
  return panel.Bottom();
}

}  // namespace

std::string DrawUndistortion(const UndistortionPicture& picture) {
  const double right = kMargin + (kWidth - 2 * kMargin - kGap) / 2 + kGap;
  const double bottom =
      std::max(PanelOf(picture.before, kMargin).Bottom(), PanelOf(picture.after, right).Bottom());
  Svg svg(kWidth, bottom + 38, "Before and after undistortion");
  DrawPictureTitle("Before and after undistortion", "", kWidth, &svg);
  DrawSide(picture.before, kMargin, &svg);
  DrawSide(picture.after, right, &svg);
  svg.Text(kMargin, bottom + 22, picture.note, plot::SoftInk(11.5));
  return svg.Finish();
}

}  // namespace graticule
