// DrawCrossSection and DrawDistortion of calibration_pictures.hpp.

#include <algorithm>
#include <cmath>

#include "graticule/io/calibration_pictures.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {

std::string DrawCrossSection(const CrossSection& section) {
  CurveChart chart;
  chart.title = section.title;
  chart.x_label = "distance from the centre [px]";
  chart.y_label = "error [px]";
  chart.curves = section.curves;
  if (section.seen_to_px > 0)
    chart.guides.push_back({true, section.seen_to_px, "last corner that was seen"});
  if (section.limit_px > 0)
    chart.guides.push_back(
        {false, section.limit_px, ReadableNumber(section.limit_px, 3) + " px, as asked for"});
  return DrawCurves(chart);
}

std::string DrawDistortion(const DistortionCurve& curve) {
  CurveChart chart;
  chart.title = "Radius of the image over the angle from the optical axis";
  chart.x_label = "angle [deg]";
  chart.y_label = "radius [px]";
  chart.y_scale = AxisScale::kLinear;
  Curve found{curve.model, {}};
  CurveBand band;
  double widest = 0, farthest = 0;
  for (const DistortionCurve::Point& point : curve.points) {
    found.points.push_back({point.angle_deg, point.radius_px});
    const double spread = curve.exaggeration * point.deviation_px;
    band.points.push_back({point.angle_deg, point.radius_px - spread, point.radius_px + spread});
    widest = std::max(widest, point.angle_deg);
    farthest = std::max(farthest, point.radius_px);
  }
  chart.curves.push_back(found);
  chart.bands.push_back(band);
  // Lenses of theory, as far as they stay on the chart.
  const auto add = [&](const char* name, double (*radius)(double)) {
    Curve lens{name, {}};
    constexpr int kSteps = 400;
    for (int i = 0; i <= kSteps; ++i) {
      const double degrees = widest * i / kSteps, r = curve.focal_px * radius(degrees * M_PI / 180);
      if (!(r >= 0 && r <= 1.15 * farthest) || degrees >= 179.9) break;
      lens.points.push_back({degrees, r});
    }
    chart.curves.push_back(lens);
  };
  if (curve.focal_px > 0) {
    add("straight (tan)", [](double a) { return a < M_PI / 2 ? std::tan(a) : -1; });
    add("stereographic", [](double a) { return 2 * std::tan(a / 2); });
    add("equidistant", [](double a) { return a; });
    add("equisolid", [](double a) { return 2 * std::sin(a / 2); });
  }
  if (curve.seen_to_deg > 0)
    chart.guides.push_back({true, curve.seen_to_deg, "widest corner that was seen"});
  if (curve.exaggeration > 0)
    chart.note = "band: " + ReadableNumber(curve.exaggeration) +
                 (curve.exaggeration == 1 ? " standard deviation" : " standard deviations") +
                 " to either side";
  return DrawCurves(chart);
}

}  // namespace graticule
