// DrawModels of calibration_pictures.hpp.

#include <algorithm>
#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/image_panel.hpp"
#include "graticule/io/plot_style.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr double kWidth = 760, kMargin = 12, kRow = 24;
constexpr double kNames = 190, kEvidence = 150;

std::string NameOf(const TriedModel& model) {
  return model.name + (model.board.empty() ? "" : ", " + model.board);
}

std::string Tooltip(const TriedModel& model) {
  return NameOf(model) + ": " + ReadableNumber(model.held_out_mean_px, 4) + " px held out, " +
         ReadableNumber(model.rms_px, 4) + " px of its own views";
}

}  // namespace

std::string DrawModels(const std::string& title, const std::vector<TriedModel>& models) {
  double low = HUGE_VAL, high = 0, bic = 0;
  for (const TriedModel& model : models) {
    if (!model.failure.empty() || !std::isfinite(model.held_out_mean_px)) continue;
    const double spread = std::isfinite(model.standard_error_px) ? model.standard_error_px : 0;
    low = std::min(low, std::max(model.held_out_mean_px - spread, 0.5 * model.held_out_mean_px));
    high = std::max(high, model.held_out_mean_px + spread);
    if (std::isfinite(model.bic)) bic = std::max(bic, model.bic);
  }
  const bool any = low <= high;
  const plot::Axis axis = !any             ? plot::LinearAxis(0, 1, 5)
                          : high > 4 * low ? plot::LogAxis(low, high, 5)
                                           : plot::LinearAxis(low, high, 5);
  const double top = DrawPictureTitle(title, "", kWidth, nullptr) + 22;
  const double left = kMargin + kNames, right = kWidth - kMargin - kEvidence - 20;
  const double bottom = top + kRow * static_cast<double>(models.size()) + 6;

  Svg svg(kWidth, bottom + 66, title);
  DrawPictureTitle(title, "", kWidth, &svg);
  svg.Rect(left, top, right - left, bottom - top, plot::Paper());
  for (const plot::Tick& tick : axis.ticks) {
    const double x = left + axis.Place(tick.value) * (right - left);
    svg.Line(x, top, x, bottom, plot::Grid());
    svg.Text(x, bottom + 15, tick.label, plot::SoftInk(11, "middle"));
  }
  svg.Rect(left, top, right - left, bottom - top, plot::Frame());
  svg.Text((left + right) / 2, bottom + 34, "held-out error, mean [px]", plot::Ink(11.5, "middle"));
  svg.Text(right + 20, top - 8, "evidence lost (BIC)", plot::SoftInk(11));
  double y = top + kRow / 2 + 3;
  for (const TriedModel& model : models) {
    svg.Text(left - 8, y + 4, plot::Shorten(NameOf(model), kNames - 8),
             plot::Ink(12, "end", model.chosen));
    if (!model.failure.empty() || !std::isfinite(model.held_out_mean_px)) {
      svg.Text(
          left + 8, y + 4,
          plot::Shorten(model.failure.empty() ? "no error" : model.failure, right - left - 16, 11),
          plot::SoftInk(11));
      y += kRow;
      continue;
    }
    const auto place = [&](double value) {
      return left + std::clamp(axis.Place(std::max(value, axis.low)), 0.0, 1.0) * (right - left);
    };
    const std::size_t colour = model.chosen ? 1 : model.converged ? 0 : 6;
    if (std::isfinite(model.standard_error_px) && model.standard_error_px > 0)
      svg.Line(place(model.held_out_mean_px - model.standard_error_px), y,
               place(model.held_out_mean_px + model.standard_error_px), y,
               plot::SeriesStroke(colour, 1.6));
    svg.Circle(place(model.held_out_mean_px), y, model.chosen ? 5.5 : 4, plot::SeriesFill(colour),
               Tooltip(model));
    if (std::isfinite(model.bic)) {
      // Decades: evidence is lost by tens or by tens of thousands.
      const double share = bic > 0 ? std::log1p(model.bic) / std::log1p(bic) : 0;
      svg.Rect(right + 20, y - 6, std::max(1.0, share * (kEvidence - 62)), 12,
               plot::SeriesFill(colour), Tooltip(model));
      svg.Text(right + 26 + std::max(1.0, share * (kEvidence - 62)), y + 4,
               ReadableNumber(std::round(model.bic)), plot::SoftInk(10.5));
    }
    y += kRow;
  }
  svg.Text(kMargin, bottom + 56,
           "orange: chosen; whiskers: standard error of the difference to the best; evidence on a "
           "logarithmic scale, 0 is best",
           plot::SoftInk(11));
  return svg.Finish();
}

}  // namespace graticule
