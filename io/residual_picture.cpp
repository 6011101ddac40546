// DrawResiduals, DrawResidualHistogram and DrawViewBars of calibration_pictures.hpp.

#include <algorithm>
#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/image_panel.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 760, kMargin = 12;
constexpr std::size_t kMostArrows = 5000;
constexpr std::size_t kViewColours = 7;  // of the series, without blue: that is for outliers

double Length(const CornerResidual& corner) { return std::hypot(corner.off.x, corner.off.y); }

bool Known(const CornerResidual& corner) {
  return std::isfinite(Length(corner)) && std::isfinite(corner.seen.x + corner.seen.y);
}

// The share of the lengths of corners that count that are shorter than what is returned.
double Quantile(std::vector<double> lengths, double share) {
  if (lengths.empty()) return 0;
  const auto at = lengths.begin() + static_cast<std::ptrdiff_t>(
                                        share * static_cast<double>(lengths.size() - 1) + 0.5);
  std::nth_element(lengths.begin(), at, lengths.end());
  return *at;
}

// Arrows of one colour, and the dots that they start from.
struct Brush {
  PathData lines{1}, dots{1};
};

}  // namespace

std::string DrawResiduals(const ResidualPicture& picture) {
  std::vector<double> lengths;
  std::size_t outliers = 0, drawn_every = 1;
  for (const CornerResidual& corner : picture.corners) {
    outliers += corner.outlier;
    if (Known(corner) && !corner.outlier) lengths.push_back(Length(corner));
  }
  drawn_every = lengths.size() / kMostArrows + 1;
  const double typical = Quantile(lengths, 0.95);

  const double title = DrawPictureTitle(picture.title, "", kWidth, nullptr);
  const ImagePanel panel(picture.width, picture.height, kMargin, title, kWidth - 2 * kMargin, 560);
  // A long arrow is a thirtieth of the panel.
  const double exaggeration =
      typical > 0 ? plot::RoundDown(std::max(panel.Width() / 30 / typical / panel.Scale(), 1e-6))
                  : 1;
  const double stretch = exaggeration * panel.Scale(), longest = panel.Width() / 12;

  Svg svg(kWidth, panel.Bottom() + 62, picture.title);
  DrawPictureTitle(picture.title, "", kWidth, &svg);
  panel.Open(std::nullopt, &svg);
  const bool by_view = picture.colours == ResidualColours::kByView;
  std::vector<Brush> brushes(by_view ? kViewColours : plot::kRampSteps - 1);
  PathData crosses(1), tails(1);
  std::size_t number = 0;
  for (const CornerResidual& corner : picture.corners) {
    if (!std::isfinite(corner.seen.x + corner.seen.y)) continue;
    const double x = panel.X(corner.seen.x), y = panel.Y(corner.seen.y);
    double dx = corner.off.x * stretch, dy = corner.off.y * stretch;
    const double length = std::hypot(dx, dy);
    if (corner.outlier) {
      crosses.Segment(x - 4, y - 4, x + 4, y + 4);
      crosses.Segment(x - 4, y + 4, x + 4, y - 4);
      if (!std::isfinite(length) || length == 0) continue;
      const double cut = std::min(1.0, longest / length);
      tails.Segment(x, y, x + dx * cut, y + dy * cut);
      continue;
    }
    if (!Known(corner) || number++ % drawn_every != 0) continue;
    const std::size_t step =
        by_view ? corner.view % brushes.size()
                : std::min(brushes.size() - 1,
                           static_cast<std::size_t>(Length(corner) / std::max(typical, 1e-300) *
                                                    static_cast<double>(brushes.size())));
    brushes[step].lines.Segment(x, y, x + dx, y + dy);
    brushes[step].dots.Dot(x, y);
  }
  for (std::size_t i = 0; i < brushes.size(); ++i) {
    plot::Attributes dots = by_view ? plot::SeriesStroke(i + 1, 2.6) : plot::RampStroke(i + 1, 2.6);
    dots.emplace_back("stroke-linecap", "round");
    plot::Attributes lines = dots;
    for (auto& [name, value] : lines)
      if (name == "stroke-width") value = "1.1";
    svg.Path(brushes[i].dots, dots);
    svg.Path(brushes[i].lines, lines);
  }
  svg.Path(tails, plot::SeriesStroke(0, 1));
  svg.Path(crosses, plot::SeriesStroke(0, 1.6), "set aside");
  panel.Close(&svg);

  // The arrow that says how long the others are.
  const double y = panel.Bottom() + 22;
  const double shown = typical > 0 ? plot::RoundDown(typical) : 1;
  const double end = kMargin + 4 + shown * stretch;
  svg.Line(kMargin + 4, y - 4, end, y - 4, plot::MarkStroke(2));
  svg.Text(end + 8, y,
           ReadableNumber(shown) + " px (drawn " + ReadableNumber(exaggeration) + " times as long)",
           plot::Ink(11.5));
  std::string note = ReadableCount(lengths.size()) +
                     " corners, from where each was seen (dot) to where it is predicted";
  if (drawn_every > 1) note += "; one of " + ReadableCount(drawn_every) + " is shown";
  if (outliers > 0)
    note += "; " + ReadableCount(outliers) +
            (outliers == 1 ? " was set aside (blue cross)" : " were set aside (blue crosses)");
  svg.Text(kMargin, y + 22, note, plot::SoftInk(11.5));
  return svg.Finish();
}

std::string DrawResidualHistogram(const std::vector<CornerResidual>& corners, double sigma_px) {
  std::vector<double> axes;
  for (const CornerResidual& corner : corners)
    if (Known(corner) && !corner.outlier) {
      axes.push_back(corner.off.x);
      axes.push_back(corner.off.y);
    }
  const auto count = static_cast<double>(std::max<std::size_t>(axes.size(), 1));
  double squares = 0, fourth = 0;
  for (const double value : axes) squares += value * value;
  const double measured = std::sqrt(squares / count);
  const double sigma = sigma_px > 0 ? sigma_px : measured > 0 ? measured : 1;
  for (const double value : axes) fourth += std::pow(value / std::max(measured, 1e-300), 4);

  constexpr int kBins = 48;
  constexpr double kReach = 4;  // sigmas
  std::vector<double> bins(kBins, 0);
  std::size_t beyond = 0;
  for (const double value : axes) {
    const double place = (value / sigma + kReach) / (2 * kReach) * kBins;
    if (place >= 0 && place < kBins)
      ++bins[static_cast<std::size_t>(place)];
    else
      ++beyond;
  }
  CurveChart chart;
  chart.title = "Residuals of both axes, and a Gaussian";
  chart.x_label = "predicted - seen [px]";
  chart.y_label = "share in a bin [%]";
  chart.y_scale = AxisScale::kLinear;
  Curve measured_curve{"residuals", {}},
      gaussian{"Gaussian of " + ReadableNumber(sigma, 3) + " px", {}};
  const double width = 2 * kReach * sigma / kBins;
  for (int i = 0; i < kBins; ++i) {
    const double left = -kReach * sigma + i * width;
    const double share = 100 * bins[static_cast<std::size_t>(i)] / count;
    measured_curve.points.push_back({left, share});
    measured_curve.points.push_back({left + width, share});
  }
  for (int i = 0; i <= 120; ++i) {
    const double x = kReach * sigma * (i / 60.0 - 1);
    gaussian.points.push_back(
        {x, 100 * width / sigma / std::sqrt(2 * M_PI) * std::exp(-x * x / sigma / sigma / 2)});
  }
  chart.curves = {measured_curve, gaussian};
  if (!axes.empty())
    chart.note =
        ReadableCount(axes.size()) + " numbers; " + ReadableCount(beyond) +
        " beyond 4 standard deviations (a Gaussian: " + ReadableNumber(6.334e-5 * count, 2) +
        "); kurtosis " + ReadableNumber(fourth / count, 3) + " (a Gaussian: 3)";
  return DrawCurves(chart);
}

namespace {

// Long names without what all of them begin with, up to the last sign between words.
std::size_t CommonBeginning(const std::vector<ViewBar>& views) {
  constexpr std::size_t kLong = 14;
  if (views.size() < 2) return 0;
  const std::string& first = views[0].name;
  std::size_t common = first.size(), longest = 0;
  for (const ViewBar& view : views) {
    longest = std::max(longest, view.name.size());
    const auto end = std::mismatch(
        first.begin(),
        first.begin() + static_cast<std::ptrdiff_t>(std::min(common, view.name.size())),
        view.name.begin());
    common = static_cast<std::size_t>(end.first - first.begin());
  }
  if (longest <= kLong) return 0;
  const std::size_t sign = first.substr(0, common).find_last_of("-_./ ");
  return sign == std::string::npos ? 0 : sign + 1;
}

}  // namespace

std::string DrawViewBars(const std::vector<ViewBar>& views) {
  constexpr double kHeight = 180, kTop = 58;
  double largest = 0;
  bool held_out = false;
  std::size_t longest = 0;
  for (const ViewBar& view : views) {
    for (const double value : {view.rms_px, view.held_out_px})
      if (std::isfinite(value)) largest = std::max(largest, value);
    held_out = held_out || std::isfinite(view.held_out_px);
    longest = std::max(longest, view.name.size());
  }
  const std::size_t common = CommonBeginning(views);
  const plot::Axis axis = plot::LinearAxis(0, largest > 0 ? largest : 1, 5);
  const double left = 58, right = kWidth - kMargin;
  const double step = (right - left) / static_cast<double>(std::max<std::size_t>(views.size(), 1));
  const bool named = step >= 13;
  const double below =
      named ? std::min(150.0, 12 + plot::TextWidth(std::string(longest - common, 'x'), 10)) : 24;
  const double bottom = kTop + kHeight;

  Svg svg(kWidth, bottom + below + 14, "Error of each view");
  DrawPictureTitle("Error of each view", "", kWidth, &svg);
  svg.Rect(left, 30, 12, 12, plot::SeriesFill(0));
  svg.Text(left + 18, 40, "root mean square [px]", plot::Ink(11));
  if (held_out) {
    svg.Circle(left + 176, 36, 3.5, plot::SeriesFill(1));
    svg.Text(left + 186, 40, "mean, of a calibration without the view [px]", plot::Ink(11));
  }
  svg.Rect(left, kTop, right - left, kHeight, plot::Paper());
  for (const plot::Tick& tick : axis.ticks) {
    const double y = bottom - axis.Place(tick.value) * kHeight;
    svg.Line(left, y, right, y, plot::Grid());
    svg.Text(left - 7, y + 4, tick.label, plot::SoftInk(11, "end"));
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ViewBar& view = views[i];
    const double x = left + step * static_cast<double>(i), width = std::min(0.8 * step, 40.0);
    const double middle = x + step / 2;
    std::string what = view.name + ": ";
    if (std::isfinite(view.rms_px)) {
      const double height = axis.Place(view.rms_px) * kHeight;
      what += ReadableNumber(view.rms_px, 3) + " px";
      if (view.outliers > 0) what += ", " + ReadableCount(view.outliers) + " set aside";
      svg.Rect(middle - width / 2, bottom - height, width, height, plot::SeriesFill(0), what);
    } else {
      svg.Text(middle, bottom - 6, "–", plot::SoftInk(11, "middle"));
    }
    if (std::isfinite(view.held_out_px))
      svg.Circle(middle, bottom - axis.Place(view.held_out_px) * kHeight,
                 std::clamp(0.25 * step, 1.6, 3.5), plot::SeriesFill(1),
                 view.name + ": " + ReadableNumber(view.held_out_px, 3) + " px held out");
    if (!named) continue;
    plot::Attributes turned = plot::SoftInk(10, "end");
    turned.emplace_back(
        "transform", "rotate(-90 " + SvgNumber(middle + 3.5) + " " + SvgNumber(bottom + 8) + ")");
    svg.Text(middle + 3.5, bottom + 8, plot::Shorten(view.name.substr(common), below, 10), turned);
  }
  svg.Rect(left, kTop, right - left, kHeight, plot::Frame());
  if (!named)
    svg.Text((left + right) / 2, bottom + 18, ReadableCount(views.size()) + " views, in order",
             plot::SoftInk(11, "middle"));
  return svg.Finish();
}

}  // namespace graticule
