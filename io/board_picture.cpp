// DrawBoard of calibration_pictures.hpp.

#include <algorithm>
#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/contour_plot.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 760, kMargin = 12, kBar = 84;
constexpr int kSide = 1000;  // of the plane that the board is drawn in, the longer side

// The board as an image: [m] to pixels of a plane of kSide.
struct Frame {
  double left = HUGE_VAL, top = HUGE_VAL, right = -HUGE_VAL, bottom = -HUGE_VAL;
  double spacing = 0, scale = 1;

  explicit Frame(const std::vector<BoardPicture::Corner>& corners) {
    for (const BoardPicture::Corner& corner : corners) {
      left = std::min(left, corner.x);
      right = std::max(right, corner.x);
      top = std::min(top, corner.y);
      bottom = std::max(bottom, corner.y);
    }
    const double width = std::max(right - left, 1e-9), height = std::max(bottom - top, 1e-9);
    spacing = std::sqrt(width * height / static_cast<double>(corners.size()));
    left -= 0.6 * spacing;
    right += 0.6 * spacing;
    top -= 0.6 * spacing;
    bottom += 0.6 * spacing;
    scale = kSide / std::max(right - left, bottom - top);
  }
  ImagePoint At(double x, double y) const { return {(x - left) * scale, (y - top) * scale}; }
  int Width() const { return std::max(2, static_cast<int>((right - left) * scale)); }
  int Height() const { return std::max(2, static_cast<int>((bottom - top) * scale)); }
};

// Heights [mm] between the corners: weighted by their nearness; none farther than a spacing from
// all.
ImageField HeightField(const BoardPicture& picture, const Frame& frame) {
  ImageField field = EmptyField(frame.Width(), frame.Height(), 81);
  const double reach = 0.5 * frame.spacing * frame.scale;
  for (std::size_t r = 0; r < field.rows; ++r)
    for (std::size_t c = 0; c < field.columns; ++c) {
      const ImagePoint at = field.At(c, r);
      double sum = 0, weights = 0, nearest = HUGE_VAL;
      for (const BoardPicture::Corner& corner : picture.corners) {
        const ImagePoint place = frame.At(corner.x, corner.y);
        const double distance = std::hypot(place.x - at.x, place.y - at.y) / reach;
        nearest = std::min(nearest, distance);
        const double weight = std::exp(-0.5 * distance * distance) + 1e-12;
        sum += weight * 1e3 * corner.dz;
        weights += weight;
      }
      field.values.push_back(nearest < 3 ? sum / weights : kNotKnown);
    }
  return field;
}

}  // namespace

std::string DrawBoard(const BoardPicture& picture) {
  if (picture.corners.empty()) {
    Svg svg(kWidth, 60, picture.title);
    DrawPictureTitle(picture.title, "no corner's place was estimated", kWidth, &svg);
    return svg.Finish();
  }
  const Frame frame(picture.corners);
  double squares = 0, least = HUGE_VAL, largest = -HUGE_VAL;
  std::vector<double> lengths;
  for (const BoardPicture::Corner& corner : picture.corners) {
    squares += corner.dz * corner.dz;
    lengths.push_back(std::hypot(corner.dx, corner.dy));
    least = std::min(least, corner.dz);
    largest = std::max(largest, corner.dz);
  }
  std::sort(lengths.begin(), lengths.end());
  const double typical = lengths[(lengths.size() - 1) * 9 / 10], along = lengths.back();
  const std::string subtitle =
      "heights from " + ReadableNumber(1e3 * least, 3) + " to " + ReadableNumber(1e3 * largest, 3) +
      " mm, root mean square " +
      ReadableNumber(1e3 * std::sqrt(squares / static_cast<double>(picture.corners.size())), 3) +
      " mm";
  const double title = DrawPictureTitle(picture.title, subtitle, kWidth, nullptr) + 10;
  const ImagePanel panel(frame.Width(), frame.Height(), kMargin, title, kWidth - 2 * kMargin - kBar,
                         520);
  Svg svg(kWidth, panel.Bottom() + 40, picture.title);
  DrawPictureTitle(picture.title, subtitle, kWidth, &svg);
  const ImageField field = HeightField(picture, frame);
  const ContourLevels levels = ChooseLevels(field);
  panel.Open(std::nullopt, &svg);
  DrawContours(field, levels, panel, &svg);
  // Nine of ten arrows are shorter than corners are apart; none is longer than twice that.
  const double stretch =
      typical > 0 ? plot::RoundDown(std::max(0.8 * frame.spacing / typical, 1e-6)) : 0;
  PathData dots(1), arrows(1);
  for (const BoardPicture::Corner& corner : picture.corners) {
    const ImagePoint at = frame.At(corner.x, corner.y);
    const double length = stretch * std::hypot(corner.dx, corner.dy);
    const double drawn = stretch * std::min(1.0, 2 * frame.spacing / std::max(length, 1e-300));
    const ImagePoint to = frame.At(corner.x + drawn * corner.dx, corner.y + drawn * corner.dy);
    dots.Dot(panel.X(at.x), panel.Y(at.y));
    arrows.Segment(panel.X(at.x), panel.Y(at.y), panel.X(to.x), panel.Y(to.y));
  }
  plot::Attributes dot = plot::SeriesStroke(0, 4.5);
  dot.emplace_back("stroke-linecap", "round");
  svg.Path(dots, dot);
  svg.Path(arrows, plot::SeriesStroke(0, 1.4));
  panel.Close(&svg);
  DrawColourBar(levels, "mm", panel.Right() + 18, panel.Top() + 12, panel.Height() - 24, &svg);
  const std::string note = stretch > 0
                               ? "arrows: where corners are found along the board, drawn " +
                                     ReadableNumber(stretch) + " times as long; the longest is " +
                                     ReadableNumber(1e3 * along, 3) + " mm"
                               : "corners are where the description has them along the board";
  svg.Text(kMargin, panel.Bottom() + 22, note, plot::SoftInk(11.5));
  return svg.Finish();
}

}  // namespace graticule
