// DrawCoverage and DrawSuggestion of calibration_pictures.hpp.

#include <algorithm>
#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/image_panel.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 760, kMargin = 12;
constexpr std::size_t kMostDots = 8000;

bool Within(const ImagePoint& point, int width, int height) {
  return point.x > 0.02 * width && point.y > 0.02 * height && point.x < 0.98 * width &&
         point.y < 0.98 * height;
}

// Where a ring's label is seen: on its right side, else wherever it is inside the image.
const ImagePoint* LabelPlace(const CoveragePicture::Ring& ring, const CoveragePicture& picture) {
  const ImagePoint* best = nullptr;
  double least = HUGE_VAL;
  for (const ImageLine& line : ring.lines)
    for (const ImagePoint& point : line) {
      if (!Within(point, picture.width, picture.height)) continue;
      const double turn =
          std::fabs(std::atan2(point.y - picture.centre.y, point.x - picture.centre.x) + M_PI / 8);
      if (turn < least) {
        least = turn;
        best = &point;
      }
    }
  return best;
}

}  // namespace

std::string DrawCoverage(const CoveragePicture& picture) {
  const double title = DrawPictureTitle(picture.title, "", kWidth, nullptr);
  const ImagePanel panel(picture.width, picture.height, kMargin, title, kWidth - 2 * kMargin, 560);
  Svg svg(kWidth, panel.Bottom() + 38, picture.title);
  DrawPictureTitle(picture.title, "", kWidth, &svg);
  panel.Open(picture.image, &svg);
  PathData outlines(1), dots(1);
  // Many views must not add up to one colour: fainter, and from a hundred on without a filling,
  // since colours have but eight bits.
  const double share = std::min(1.0, 24 / static_cast<double>(picture.outlines.size() + 1));
  const bool filled = picture.outlines.size() < 100;
  for (const ImageLine& outline : picture.outlines) {
    panel.AddLine(outline, true, &outlines);
    if (!filled) continue;
    PathData path(1);
    panel.AddLine(outline, true, &path);
    plot::Attributes fill = plot::SeriesFill(0);
    fill.emplace_back("fill-opacity", SvgNumber(0.05 * share));
    svg.Path(path, fill);
  }
  plot::Attributes thin = plot::SeriesStroke(0, 0.8);
  thin.emplace_back("stroke-opacity", SvgNumber(0.1 + 0.4 * share));
  svg.Path(outlines, thin);
  const std::size_t every = picture.corners.size() / kMostDots + 1;
  for (std::size_t i = 0; i < picture.corners.size(); i += every)
    if (std::isfinite(picture.corners[i].x + picture.corners[i].y))
      dots.Dot(panel.X(picture.corners[i].x), panel.Y(picture.corners[i].y));
  plot::Attributes dot = plot::SeriesStroke(0, 2.4);
  dot.emplace_back("stroke-linecap", "round");
  dot.emplace_back("stroke-opacity", "0.75");
  svg.Path(dots, dot);
  for (const CoveragePicture::Ring& ring : picture.rings) {
    PathData path(1);
    for (const ImageLine& line : ring.lines) panel.AddLine(line, false, &path);
    plot::Attributes stroke = plot::SeriesStroke(1, 1.1);
    stroke.emplace_back("stroke-dasharray", "5 3");
    svg.Path(path, stroke);
  }
  const ImagePoint* last = nullptr;
  for (const CoveragePicture::Ring& ring : picture.rings) {
    const ImagePoint* place = LabelPlace(ring, picture);
    if (!place) continue;
    // Rings crowd together where the lens ends.
    if (last && std::hypot(place->x - last->x, place->y - last->y) * panel.Scale() < 34) continue;
    panel.Label(*place, ReadableNumber(ring.angle_deg, 3) + "°", &svg);
    last = place;
  }
  if (!picture.rings.empty()) {
    const double x = panel.X(picture.centre.x), y = panel.Y(picture.centre.y);
    PathData cross(1);
    cross.Segment(x - 8, y, x + 8, y);
    cross.Segment(x, y - 8, x, y + 8);
    svg.Path(cross, plot::SeriesStroke(1, 2));
  }
  panel.Close(&svg);
  std::string note = ReadableCount(picture.corners.size()) + " corners in " +
                     ReadableCount(picture.outlines.size()) + " views";
  if (every > 1) note += "; one corner of " + ReadableCount(every) + " is shown";
  if (!picture.rings.empty()) note += "; dashed: angle from the optical axis, cross: its image";
  svg.Text(kMargin, panel.Bottom() + 22, note, plot::SoftInk(11.5));
  return svg.Finish();
}

std::string DrawSuggestion(const SuggestionPicture& picture) {
  std::string subtitle;
  if (std::isfinite(picture.max_px_after))
    subtitle =
        "the largest error that is expected then: " + ReadableNumber(picture.max_px_after, 3) +
        " px";
  const double title = DrawPictureTitle(picture.title, subtitle, kWidth, nullptr);
  const ImagePanel panel(picture.width, picture.height, kMargin, title, kWidth - 2 * kMargin, 560);
  const double words = 22 * static_cast<double>(picture.advice.size());
  Svg svg(kWidth, panel.Bottom() + 16 + words, picture.title);
  DrawPictureTitle(picture.title, subtitle, kWidth, &svg);
  panel.Open(picture.image, &svg);
  const auto colour = [&](std::size_t i) {
    return static_cast<std::size_t>(i < picture.names.size() ? std::max(picture.names[i], 0)
                                                             : static_cast<int>(i));
  };
  const auto without_dashes = [](plot::Attributes attributes) {
    attributes.erase(
        std::remove_if(attributes.begin(), attributes.end(),
                       [](const auto& one) { return one.first == "stroke-dasharray"; }),
        attributes.end());
    attributes.emplace_back("stroke-linejoin", "round");
    return attributes;
  };
  for (std::size_t i = 0; i < picture.live.size(); ++i) {
    PathData path(1);
    panel.AddLine(picture.live[i], true, &path);
    svg.Path(path, plot::SeriesFill(colour(i) % 8));
  }
  for (std::size_t i = 0; i < picture.quads.size(); ++i) {
    PathData path(1);
    panel.AddLine(picture.quads[i], true, &path);
    svg.Path(path, without_dashes(plot::SeriesStroke(colour(i) % 8, 2.2)));
  }
  panel.Close(&svg);
  double y = panel.Bottom() + 24;
  for (const std::string& advice : picture.advice) {
    svg.Text(kMargin, y, plot::Shorten(advice, kWidth - 2 * kMargin, 14), plot::Ink(14, {}, true));
    y += 22;
  }
  return svg.Finish();
}

}  // namespace graticule
