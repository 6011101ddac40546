// What the names of images say: which files are meant, and which camera took them.

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "graticule/io/photo.hpp"
#include "graticule/problems/calibration/detect_all.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

namespace fs = std::filesystem;

bool Matches(const char* pattern, const char* name) {
  for (; *pattern; ++pattern, ++name) {
    if (*pattern == '*') {
      for (;; ++name) {
        if (Matches(pattern + 1, name)) return true;
        if (!*name) return false;
      }
    }
    if (!*name || (*pattern != '?' && *pattern != *name)) return false;
  }
  return !*name;
}

/// Pictures of a folder whose names match, sorted.
std::vector<std::string> PicturesOf(const fs::path& folder, const std::string& pattern) {
  std::vector<std::string> found;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(folder, problem)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && IsPhotoName(name) && Matches(pattern.c_str(), name.c_str()))
      found.push_back(entry.path().string());
  }
  if (problem) throw Error(folder.string() + ": " + problem.message());
  std::sort(found.begin(), found.end());
  return found;
}

/// The pictures in the folders of one, as deep as cam0/data/ (EuRoC).
std::vector<std::string> PicturesBelow(const fs::path& folder, int levels = 2) {
  std::vector<fs::path> inner;
  std::error_code problem;
  for (const auto& entry : fs::directory_iterator(folder, problem))
    if (entry.is_directory()) inner.push_back(entry.path());
  std::sort(inner.begin(), inner.end());
  std::vector<std::string> found;
  for (const fs::path& one : inner) {
    std::vector<std::string> own = PicturesOf(one, "*");
    if (own.empty() && levels > 1) own = PicturesBelow(one, levels - 1);
    found.insert(found.end(), own.begin(), own.end());
  }
  return found;
}

/// A name but for its last number, and that.
struct Numbered {
  std::string camera, number;
};

Numbered Split(const std::string& image) {
  const fs::path path(image);
  const std::string stem = path.stem().string();
  constexpr const char* kDigits = "0123456789";
  const std::string folder = path.parent_path().string() + "/";
  const std::size_t last = stem.find_last_of(kDigits);
  if (last == std::string::npos) return {folder + stem, ""};
  const std::size_t before = stem.find_last_not_of(kDigits, last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return {folder + stem.substr(0, first) + stem.substr(last + 1),
          stem.substr(first, last + 1 - first)};
}

/// The camera's part of what comes before the numbers: the last name on the path in which all
/// differ, "left" of a/left_ and a/right_, "cam0" of cam0/data/ and cam1/data/.  Empty if none is.
std::vector<std::string> CameraNames(std::vector<fs::path> keys) {
  std::vector<std::string> names(keys.size());
  for (;;) {
    std::set<std::string> different;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      names[i] = keys[i].filename().string();
      const std::size_t end = names[i].find_last_not_of("_-. ");
      names[i].resize(end == std::string::npos ? 0 : end + 1);
      if (names[i].empty() && !keys[i].has_parent_path()) return {};
      different.insert(names[i]);
      if (keys[i] == keys[i].parent_path()) return {};
      keys[i] = keys[i].parent_path();
    }
    if (different.size() == names.size() && !different.count("")) return names;
  }
}

}  // namespace

ImagesByCamera GroupByCamera(const std::vector<std::string>& images) {
  constexpr std::size_t kLeastImages = 3;
  constexpr double kLeastShared = 0.6;  // of the smaller camera's numbers
  constexpr double kMostStrays = 0.2;   // of all images
  struct Group {
    std::vector<std::string> images;
    std::set<std::string> numbers;
  };
  std::map<std::string, Group> groups;
  for (const std::string& image : images) {
    const auto [camera, number] = Split(image);
    groups[camera].images.push_back(image);
    groups[camera].numbers.insert(number);
  }
  const ImagesByCamera one = {{{"cam0", images}}, {}};
  ImagesByCamera several;
  std::vector<fs::path> keys;
  const std::set<std::string>* first = nullptr;
  for (const auto& [key, group] : groups) {
    if (group.images.size() < kLeastImages) {
      several.strays.insert(several.strays.end(), group.images.begin(), group.images.end());
      continue;
    }
    if (!first) first = &group.numbers;
    std::size_t shared = 0;
    for (const std::string& number : group.numbers) shared += first->count(number);
    const auto smaller = static_cast<double>(std::min(first->size(), group.numbers.size()));
    if (static_cast<double>(shared) < kLeastShared * smaller) return one;
    several.cameras.push_back({"", group.images});
    keys.emplace_back(key);
  }
  if (several.cameras.size() < 2 ||
      static_cast<double>(several.strays.size()) > kMostStrays * static_cast<double>(images.size()))
    return one;
  const std::vector<std::string> names = CameraNames(keys);
  if (names.empty()) return one;
  for (std::size_t i = 0; i < names.size(); ++i) several.cameras[i].camera = names[i];
  return several;
}

namespace {

/// The pictures of a folder with a folder for each camera.
std::vector<std::string> PicturesOfRig(const fs::path& folder) {
  std::vector<std::string> found = PicturesBelow(folder);
  if (found.empty()) throw Error(folder.string() + ": there is no picture in this folder");
  if (GroupByCamera(found).cameras.size() < 2)
    throw Error(folder.string() + ": there is no picture in this folder itself, and those below (" +
                fs::path(found.front()).parent_path().string() +
                ", ...) are by their names not of several cameras: name the folder that is meant");
  return found;
}

}  // namespace

std::vector<std::string> ExpandImages(const std::vector<std::string>& words) {
  std::vector<std::string> images;
  for (const std::string& word : words) {
    const fs::path path(word);
    const std::string last = path.filename().string();
    std::error_code ignored;
    std::vector<std::string> own;
    if (fs::is_directory(path, ignored)) {
      own = PicturesOf(path, "*");
      if (own.empty()) own = PicturesOfRig(path);
    } else if (!fs::exists(path, ignored) && last.find_first_of("*?") != std::string::npos) {
      const fs::path folder = path.parent_path();
      own = PicturesOf(folder.empty() ? "." : folder, last);
      if (own.empty()) throw Error(word + ": no picture has such a name");
    } else if (!fs::exists(path, ignored)) {
      throw Error(word + ": No such file or directory");
    } else {
      own.push_back(word);
    }
    images.insert(images.end(), own.begin(), own.end());
  }
  return images;
}

bool IsVideoName(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const char* known : {".mp4", ".avi", ".mkv", ".mov", ".webm", ".m4v", ".mpg", ".bag"})
    if (ending == known) return true;
  return false;
}

}  // namespace graticule
