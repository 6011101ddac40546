#include "guide_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/json_text.hpp"
#include "graticule/problems/calibration/picture_data.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

// A tenth of a pixel is all that is seen.
double Rounded(double value) { return std::round(10 * value) / 10; }

// Not a number is not JSON.
Json Known(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

// [tag, x, y, x, y, x, y, x, y] each.
Json QuadsJson(const TargetLayout& layout, const std::vector<DetectedCorner>& corners) {
  std::vector<int> names;
  const std::vector<ImageLine> quads = QuadsOf(layout, corners, &names);
  Json list = Json::array();
  for (std::size_t i = 0; i < quads.size(); ++i) {
    Json quad = {names[i]};
    for (const ImagePoint& point : quads[i]) {
      quad.push_back(Rounded(point.x));
      quad.push_back(Rounded(point.y));
    }
    list.push_back(std::move(quad));
  }
  return list;
}

}  // namespace

std::string LiveJson(const LiveView& view, const TargetLayout& layout) {
  Json json = {{"frame", view.number},
               {"fps", Rounded(view.frames_per_second)},
               {"guidance", view.guidance},
               {"busy", view.is_busy},
               {"done", view.is_done},
               {"rectified", view.is_rectified},
               {"quads", QuadsJson(layout, view.corners)},
               {"shared", view.match.shared},
               {"cells", Known(view.match.distance_cells)},
               {"limit", view.capture.limit_cells},
               {"matched", view.capture.is_matched},
               {"steady", view.capture.is_steady},
               {"progress", view.capture.progress}};
  json["moves"] = Json::array();
  for (const TargetMove move : view.match.moves) json["moves"].push_back(WordsOf(move));
  return JsonText(json);
}

std::string GuidanceJson(const Guidance& guidance, const TargetLayout& layout,
                         const ImageSize& image, double accuracy_px) {
  Json json = {{"number", guidance.number},
               {"width", image.width},
               {"height", image.height},
               {"accuracy", accuracy_px},
               {"frames", guidance.steps.size()},
               {"solved", guidance.is_solved},
               {"bootstrapping", guidance.is_bootstrapping},
               {"met", guidance.is_met},
               {"model", guidance.camera.model},
               {"rms", guidance.rms_px},
               {"sigma", guidance.sigma_px},
               {"message", guidance.message}};
  json["suggested"] =
      guidance.suggestion ? QuadsJson(layout, guidance.suggestion->corners) : Json(Json::array());
  json["expected"] = guidance.suggestion ? Known(guidance.suggestion->max_ere_px) : Json(nullptr);
  json["steps"] = Json::array();
  for (const GuideStep& step : guidance.steps)
    json["steps"].push_back(
        {{"px", Known(step.max_ere_px)}, {"bootstrapping", step.is_bootstrapping}});
  json["parameters"] = Json::array();
  for (const GuideParameter& p : guidance.parameters)
    json["parameters"].push_back({{"name", p.name},
                                  {"unit", p.unit},
                                  {"value", p.value},
                                  {"deviation", p.deviation},
                                  {"loose", p.is_loose}});
  Json map = {{"columns", guidance.map.columns}, {"rows", guidance.map.rows}};
  map["px"] = Json::array();
  map["reached"] = Json::array();
  for (const ErePoint& point : guidance.map.points) {
    map["px"].push_back(point.has_ray ? Known(point.ere_px) : Json(nullptr));
    map["reached"].push_back(point.is_reached);
  }
  json["map"] = std::move(map);
  return JsonText(json);
}

}  // namespace graticule::apps
