#include <algorithm>

#include "graticule/io/camera_formats.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Which of OpenCV's terms k1 k2 p1 p2 k3 k4 k5 k6 a model has: factors/lens.hpp.
struct BrownModel {
  const char* name;
  std::vector<std::size_t> slots;
};

const std::vector<BrownModel>& BrownModels() {
  static const std::vector<BrownModel> models = {
      {"pinhole", {}},          {"radial2", {0, 1}},         {"radial3", {0, 1, 4}},
      {"brown4", {0, 1, 2, 3}}, {"brown5", {0, 1, 2, 3, 4}}, {"brown8", {0, 1, 2, 3, 4, 5, 6, 7}},
  };
  return models;
}

void CheckTerms(const CameraIntrinsics& camera, std::size_t terms) {
  if (camera.parameters.size() != 4 + terms)
    throw Error("camera " + Quoted(camera.name) + ": expected " + std::to_string(4 + terms) +
                    " parameters of " + camera.model + ", found " +
                    std::to_string(camera.parameters.size()),
                ErrorKind::kUsage);
}

}  // namespace

std::optional<std::array<double, 8>> BrownTerms(const CameraIntrinsics& camera) {
  for (const BrownModel& model : BrownModels()) {
    if (camera.model != model.name) continue;
    CheckTerms(camera, model.slots.size());
    std::array<double, 8> terms = {};
    for (std::size_t i = 0; i < model.slots.size(); ++i)
      terms[model.slots[i]] = camera.parameters[4 + i];
    return terms;
  }
  return std::nullopt;
}

std::optional<std::array<double, 4>> AngularTerms(const CameraIntrinsics& camera) {
  constexpr std::string_view kFamily = "angular";
  const std::string_view model = camera.model;
  if (model.size() != kFamily.size() + 1 || model.substr(0, kFamily.size()) != kFamily)
    return std::nullopt;
  const auto count = static_cast<std::size_t>(model.back() - '0');
  if (count < 1 || count > 6) return std::nullopt;
  CheckTerms(camera, count);
  std::array<double, 4> terms = {};
  for (std::size_t i = 0; i < count; ++i) {
    if (i < 4)
      terms[i] = camera.parameters[4 + i];
    else if (camera.parameters[4 + i] != 0)
      return std::nullopt;
  }
  return terms;
}

std::optional<double> UnifiedAlpha(const CameraIntrinsics& camera) {
  if (camera.model == "unified") {
    CheckTerms(camera, 1);
    return camera.parameters[4];
  }
  if (camera.model == "extended_unified") {
    CheckTerms(camera, 2);
    if (camera.parameters[5] == 1) return camera.parameters[4];
  }
  if (camera.model == "double_sphere") {
    CheckTerms(camera, 2);
    if (camera.parameters[4] == 0) return camera.parameters[5];
  }
  return std::nullopt;
}

std::optional<std::array<double, 2>> ExtendedUnifiedTerms(const CameraIntrinsics& camera) {
  if (camera.model == "extended_unified") {
    CheckTerms(camera, 2);
    return std::array<double, 2>{camera.parameters[4], camera.parameters[5]};
  }
  if (const auto alpha = UnifiedAlpha(camera)) return std::array<double, 2>{*alpha, 1};
  return std::nullopt;
}

std::optional<std::array<double, 2>> DoubleSphereTerms(const CameraIntrinsics& camera) {
  if (camera.model == "double_sphere") {
    CheckTerms(camera, 2);
    return std::array<double, 2>{camera.parameters[4], camera.parameters[5]};
  }
  if (const auto alpha = UnifiedAlpha(camera)) return std::array<double, 2>{0, *alpha};
  return std::nullopt;
}

std::size_t BrownCount(const std::array<double, 8>& terms) {
  if (terms[5] != 0 || terms[6] != 0 || terms[7] != 0) return 8;
  return terms[4] != 0 ? 5 : 4;
}

void SetBrown(const std::vector<double>& terms, const DocumentNode& place,
              CameraIntrinsics* camera) {
  const std::size_t count = terms.size();
  if (count != 0 && count != 4 && count != 5 && count != 8 && count != 12 && count != 14)
    place.Fail("expected 0, 4, 5, 8, 12 or 14 coefficients of distortion, found " +
               std::to_string(count));
  for (std::size_t i = 8; i < count; ++i)
    if (terms[i] != 0)
      place.Fail(
          "expected at most 8 coefficients that are not zero: the thin prism and the tilted "
          "sensor are none of our models");
  camera->model = count == 0 ? "pinhole" : count == 4 ? "brown4" : count == 5 ? "brown5" : "brown8";
  camera->parameters.insert(
      camera->parameters.end(), terms.begin(),
      terms.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(count, 8)));
}

CameraIntrinsics FromOmni(double xi, double fx, double fy, double cx, double cy) {
  CameraIntrinsics camera;
  camera.model = "unified";
  camera.parameters = {fx / (1 + xi), fy / (1 + xi), cx, cy, xi / (1 + xi)};
  return camera;
}

Omni ToOmni(const CameraIntrinsics& camera, double alpha) {
  const double scale = 1 / (1 - alpha);
  return {alpha * scale, camera.parameters[0] * scale, camera.parameters[1] * scale};
}

std::array<double, 4> FocalAndCentre(const std::vector<double>& m, const DocumentNode& place) {
  if (m[1] != 0 || m[3] != 0)
    place.Fail("expected a camera matrix without skew: it is in none of our models");
  if (m[6] != 0 || m[7] != 0 || m[8] != 1) place.Fail("expected 0 0 1 in the last row");
  if (!(m[0] > 0 && m[4] > 0)) place.Fail("expected focal lengths above zero");
  return {m[0], m[4], m[2], m[5]};
}

std::vector<double> ReadMatrix(const DocumentNode& node) {
  const long rows = node.Member("rows").Integer(0, 1 << 16);
  const long columns = node.Member("cols").Integer(0, 1 << 16);
  const DocumentNode& data = node.Member("data");
  std::vector<double> values;
  if (data.IsList()) {
    values = data.Numbers();
  } else if (data.kind == DocumentNode::Kind::kScalar) {  // XML
    const std::string& text = data.text;
    DocumentNode word = data;  // has the place that errors name
    for (std::size_t at = 0;;) {
      at = text.find_first_not_of(" \t\r\n", at);
      if (at == std::string::npos) break;
      const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
      word.text = text.substr(at, end - at);
      values.push_back(word.Number());
      at = end;
    }
  } else if (rows * columns != 0) {
    data.FailExpected("a list of numbers");
  }
  if (values.size() != static_cast<std::size_t>(rows * columns))
    data.Fail("expected " + std::to_string(rows) + " x " + std::to_string(columns) +
              " numbers, found " + std::to_string(values.size()));
  return values;
}

std::vector<double> ReadMatrix(const DocumentNode& node, std::size_t rows, std::size_t columns) {
  if (node.Member("rows").Integer(0, 1 << 16) != static_cast<long>(rows) ||
      node.Member("cols").Integer(0, 1 << 16) != static_cast<long>(columns))
    node.Fail("expected a matrix of " + std::to_string(rows) + " x " + std::to_string(columns));
  return ReadMatrix(node);
}

std::string NumberList(const double* values, std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) {
    if (i) text += ", ";
    AppendNumber(&text, values[i]);
  }
  return text + "]";
}

}  // namespace graticule
