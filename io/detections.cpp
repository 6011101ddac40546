#include "graticule/io/detections.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "graticule/io/detections_check.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/json_document.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

constexpr int kMostNumbers = 1 << 16;  // ids of one board
constexpr int kMostBoards = 1 << 14;
constexpr long kMostViews = 1 << 24;
constexpr long kMostPixels = 1 << 20;  // a side

int ReadId(const JsonPlace& place) {
  if (!place.IsList()) return static_cast<int>(place.Integer(0, (1 << 30) - 1));
  place.OfSize(2);
  const long board = place.At(0).Integer(0, kMostBoards - 1);
  return static_cast<int>(board * kMostNumbers + place.At(1).Integer(0, kMostNumbers - 1));
}

ImageSize ReadCamera(const JsonPlace& place) {
  const JsonPlace size = place["size"];
  size.OfSize(2);
  ImageSize camera;
  if (place.Has("name")) camera.camera = place["name"].Text();
  camera.width = static_cast<int>(size.At(0).Integer(1, kMostPixels));
  camera.height = static_cast<int>(size.At(1).Integer(1, kMostPixels));
  return camera;
}

std::vector<DetectedCorner> ReadCorners(const JsonPlace& view, PlacesOnTarget* places) {
  const JsonPlace ids = view["ids"], in_target = view["obj"], pixels = view["img"];
  const std::size_t count = ids.Size();
  in_target.OfSize(count);
  pixels.OfSize(count);
  std::optional<JsonPlace> weights;
  if (view.Has("w")) weights = view["w"];
  if (weights) weights->OfSize(count);

  std::vector<DetectedCorner> corners;
  corners.reserve(count);
  IdsOfView seen;
  for (std::size_t i = 0; i < count; ++i) {
    DetectedCorner corner;
    corner.id = ReadId(ids.At(i));
    const JsonPlace place = in_target.At(i), pixel = pixels.At(i);
    place.OfSize(3);
    pixel.OfSize(2);
    for (std::size_t k = 0; k < 3; ++k) corner.in_target[k] = place.At(k).Number();
    for (std::size_t k = 0; k < 2; ++k) corner.pixel[k] = pixel.At(k).Number();
    if (const auto wrong = seen.Add(corner.id)) ids.At(i).Fail(*wrong);
    if (const auto wrong = places->Add(corner)) place.Fail(*wrong);
    if (!weights || weights->At(i).Number() > 0) corners.push_back(corner);
  }
  return corners;
}

/// What is the same in the names of views that were taken at one time.
std::string StemOf(const std::string& image) { return fs::path(image).stem().string(); }

/// The last number in a name, without zeros before it; none: "".
std::string LastNumberOf(const std::string& image) {
  const std::string stem = StemOf(image);
  constexpr const char* kDigits = "0123456789";
  const std::size_t last = stem.find_last_of(kDigits);
  if (last == std::string::npos) return "";
  const std::size_t before = stem.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  const std::size_t digit = std::min(stem.find_first_not_of('0', first), last);
  return stem.substr(digit, last + 1 - digit);
}

using NameOfExposure = std::string (*)(const std::string& image);

/// Whether some name of one camera is one of another's.
bool SharesNames(const std::vector<Detections>& parts, NameOfExposure name_of) {
  std::set<std::string> known;
  for (const Detections& part : parts) {
    std::set<std::string> own;
    for (const TargetView& view : part.views) own.insert(name_of(view.image));
    own.erase("");
    for (const std::string& name : own)
      if (known.count(name)) return true;
    known.insert(own.begin(), own.end());
  }
  return false;
}

/// The names that several views of one camera have say nothing.
std::set<std::string> Ambiguous(const Detections& part, NameOfExposure name_of) {
  std::map<std::string, std::size_t> counts;
  for (const TargetView& view : part.views) ++counts[name_of(view.image)];
  std::set<std::string> ambiguous = {""};
  for (const auto& [name, count] : counts)
    if (count > 1) ambiguous.insert(name);
  return ambiguous;
}

/// The only file with this ending in the folder of `path` or the one above; "" if there is none.
std::string Beside(const std::string& path, std::string_view ending) {
  const fs::path folder = fs::absolute(path).parent_path();
  for (const fs::path& where : {folder, folder.parent_path()}) {
    std::vector<std::string> found;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(where, ignored))
      if (HasEnding(WithoutGz(entry.path().string()), ending))
        found.push_back(entry.path().string());
    if (found.size() > 1)
      throw Error(path + ": there are " + std::to_string(found.size()) + " *" +
                  std::string(ending) + " in " + where.string() + "; name one");
    if (found.size() == 1) return found[0];
  }
  return "";
}

NamedText Named(const std::string& path) { return {path, ReadFile(path)}; }

Detections ReadBabelcalib(const std::vector<std::string>& views, std::string board,
                          std::string places) {
  if (board.empty()) board = Beside(views[0], ".dsc");
  if (board.empty())
    throw Error(views[0] +
                ": expected the board's description (.dsc) beside it, in the folder "
                "above, or among the files");
  if (places.empty()) places = Beside(board, ".tp");
  std::vector<NamedText> texts;
  for (const std::string& view : views) texts.push_back(Named(view));
  Detections detections =
      ParseBabelcalib(texts, Named(board), places.empty() ? NamedText{} : Named(places));
  detections.cameras[0].camera = fs::absolute(views[0]).parent_path().filename().string();
  return detections;
}

}  // namespace

Detections ParseDetections(std::string_view text, const std::string& name) {
  const JsonDocument document(text, name);
  const JsonPlace root = document.Root().Object();
  Detections detections;
  const bool has_cameras = root.Has("cameras");
  if (has_cameras) {
    const JsonPlace cameras = root["cameras"];
    for (std::size_t i = 0; i < cameras.Size(); ++i)
      detections.cameras.push_back(ReadCamera(cameras.At(i)));
    if (detections.cameras.empty()) cameras.Fail("expected a camera");
  } else {
    detections.cameras.push_back(ReadCamera(root));
  }

  const JsonPlace views = root["views"];
  if (views.Size() == 0) views.Fail("there is no view");
  PlacesOnTarget places;
  std::set<std::pair<std::size_t, std::size_t>> taken;  // camera, exposure
  for (std::size_t i = 0; i < views.Size(); ++i) {
    const JsonPlace place = views.At(i);
    TargetView view;
    view.image = place["name"].Text();
    if (has_cameras)
      view.camera = static_cast<std::size_t>(
          place["camera"].Integer(0, static_cast<long>(detections.cameras.size()) - 1));
    view.exposure = has_cameras || place.Has("exposure")
                        ? static_cast<std::size_t>(place["exposure"].Integer(0, kMostViews))
                        : i;
    if (!taken.emplace(view.camera, view.exposure).second)
      place.Fail("exposure " + std::to_string(view.exposure) + " of this camera is there already");
    if (place.Has("size")) {
      const ImageSize& camera = detections.cameras[view.camera];
      const ImageSize own = ReadCamera(place);
      if (own.width != camera.width || own.height != camera.height)
        place["size"].Fail("images of one camera have one size: this is " + SizeText(own) +
                           ", the camera " + SizeText(camera));
    }
    view.corners = ReadCorners(place, &places);
    detections.exposures = std::max(detections.exposures, view.exposure + 1);
    detections.views.push_back(std::move(view));
  }
  if (root.Has("exposures"))
    detections.exposures = static_cast<std::size_t>(
        root["exposures"].Integer(static_cast<long>(detections.exposures), kMostViews + 1));
  return detections;
}

Detections CombineCameras(std::vector<Detections> parts, const std::vector<std::string>& names) {
  if (parts.size() == 1) return std::move(parts[0]);
  Detections all;
  PlacesOnTarget places;
  const NameOfExposure name_of = SharesNames(parts, StemOf) ? StemOf : LastNumberOf;
  std::map<std::string, std::size_t> exposure_of;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Detections& part = parts[i];
    for (const ImageSize& camera : part.cameras) {
      for (const ImageSize& known : all.cameras)
        if (known.camera == camera.camera)
          throw Error(names[i] + ": there is a camera " + Quoted(camera.camera) +
                      " already; several files are several cameras of one rig");
    }
    const std::size_t first_camera = all.cameras.size();
    all.cameras.insert(all.cameras.end(), part.cameras.begin(), part.cameras.end());
    const bool is_rig = part.cameras.size() > 1;  // knows its own exposures
    const std::set<std::string> ambiguous = Ambiguous(part, name_of);
    std::map<std::size_t, std::size_t> own_exposures;
    for (TargetView& view : part.views) {
      for (const DetectedCorner& corner : view.corners)
        if (const auto wrong = places.Add(corner)) throw Error(names[i] + ": " + *wrong);
      const std::string name = name_of(view.image);
      std::size_t exposure = all.exposures;
      if (is_rig || ambiguous.count(name)) {
        const auto [own, added] = own_exposures.emplace(view.exposure, exposure);
        if (added) ++all.exposures;
        exposure = own->second;
      } else {
        const auto [known, added] = exposure_of.emplace(name, exposure);
        if (added) ++all.exposures;
        exposure = known->second;
      }
      view.exposure = exposure;
      view.camera += first_camera;
      all.views.push_back(std::move(view));
    }
  }
  return all;
}

Detections ReadDetections(const std::vector<std::string>& paths,
                          const CornerListOptions& corner_list) {
  if (paths.empty()) throw Error("expected files of detections", ErrorKind::kUsage);
  std::vector<Detections> parts;
  std::vector<std::string> names, babelcalib;
  std::string board, places;
  for (const std::string& path : paths) {
    const std::string_view unpacked = WithoutGz(path);
    if (HasEnding(unpacked, ".orpc")) {
      babelcalib.push_back(path);
      continue;
    }
    if (HasEnding(unpacked, ".dsc") || HasEnding(unpacked, ".tp")) {
      std::string& known = HasEnding(unpacked, ".dsc") ? board : places;
      if (!known.empty()) throw Error(path + ": there is " + known + " already");
      known = path;
      continue;
    }
    const std::string text = ReadFile(path);
    parts.push_back(HasEnding(unpacked, ".vnl")
                        ? ParseCornerList(text, path, StemOf(path), corner_list)
                        : ParseDetections(text, path));
    if (parts.back().cameras.size() == 1 && parts.back().cameras[0].camera.empty())
      parts.back().cameras[0].camera = StemOf(path);
    names.push_back(path);
  }
  if (!babelcalib.empty()) {
    parts.push_back(ReadBabelcalib(babelcalib, board, places));
    names.push_back(babelcalib[0]);
  } else if (!board.empty() || !places.empty()) {
    throw Error((board.empty() ? places : board) + ": expected the views (.orpc) of this board");
  }
  return CombineCameras(std::move(parts), names);
}

std::string FormatDetections(const Detections& detections) {
  const auto camera = [](const ImageSize& size) {
    return "\"name\": " + JsonQuoted(size.camera) + ", \"size\": [" + std::to_string(size.width) +
           ", " + std::to_string(size.height) + "]";
  };
  const bool is_rig = detections.cameras.size() != 1;
  std::string text = "{";
  if (is_rig) {
    text += "\"cameras\": [";
    for (std::size_t i = 0; i < detections.cameras.size(); ++i)
      text += (i ? ", {" : "{") + camera(detections.cameras[i]) + "}";
    text += "]";
  } else {
    text += camera(detections.cameras[0]);
  }
  text += ", \"exposures\": " + std::to_string(detections.exposures) + ", \"views\": [";
  const auto list = [&text](const auto& corners, const char* key, const auto& append) {
    text += std::string(", \"") + key + "\": [";
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (i) text += ", ";
      append(corners[i]);
    }
    text += "]";
  };
  const auto numbers = [&text](const auto& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      text += k ? ", " : "[";
      AppendJsonNumber(&text, values[k]);
    }
    text += "]";
  };
  for (std::size_t i = 0; i < detections.views.size(); ++i) {
    const TargetView& view = detections.views[i];
    text += (i ? ",\n{" : "\n{") + ("\"name\": " + JsonQuoted(view.image));
    if (is_rig) text += ", \"camera\": " + std::to_string(view.camera);
    text += ", \"exposure\": " + std::to_string(view.exposure);
    using Corner = DetectedCorner;
    list(view.corners, "ids", [&](const Corner& corner) { text += std::to_string(corner.id); });
    list(view.corners, "obj", [&](const Corner& corner) { numbers(corner.in_target); });
    list(view.corners, "img", [&](const Corner& corner) { numbers(corner.pixel); });
    text += "}";
  }
  return text + "]}\n";
}

void WriteDetections(const std::string& path, const Detections& detections) {
  WriteFile(path, FormatDetections(detections));
}

}  // namespace graticule
