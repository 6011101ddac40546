// The arrows between the rooms (docs/architecture.md), and what each room may use, read from the
// sources. Not shown: what a header brings in by way of another library's header.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;  // "solver/graph.cpp"
  std::string room;  // "solver"
  std::size_t line;
  std::string path;  // "graticule/solver/graph.hpp"
  bool in_header;
  bool Is(const std::string& prefix) const { return path.compare(0, prefix.size(), prefix) == 0; }
  std::string Where() const { return file + ":" + std::to_string(line) + " includes " + path; }
};

const std::vector<std::string> kRooms = {"solver", "factors", "io", "problems", "apps"};

std::set<std::string> InternalHeaders() {
  std::set<std::string> names;
  std::istringstream list(INTERNAL_HEADERS);
  for (std::string name; list >> name;) names.insert("graticule/solver/" + name + ".hpp");
  return names;
}

bool IsSource(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".cpp" || extension == ".hpp" || extension == ".h";
}

std::vector<Include> ReadIncludes() {
  std::vector<Include> includes;
  const fs::path root = SOURCE_DIR;
  for (const std::string& room : kRooms) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(root / room))
      if (entry.is_regular_file() && IsSource(entry.path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& path : files) {
      std::ifstream text(path);
      std::string line;
      for (std::size_t number = 1; std::getline(text, line); ++number) {
        std::size_t i = line.find_first_not_of(" \t");
        if (i == std::string::npos || line[i] != '#') continue;
        i = line.find_first_not_of(" \t", i + 1);
        if (i == std::string::npos || line.compare(i, 7, "include") != 0) continue;
        const std::size_t begin = line.find_first_of("\"<", i);
        const std::size_t end =
            begin == std::string::npos ? begin : line.find_first_of("\">", begin + 1);
        if (end == std::string::npos) continue;
        includes.push_back({path.lexically_relative(root).generic_string(), room, number,
                            line.substr(begin + 1, end - begin - 1), path.extension() != ".cpp"});
      }
    }
  }
  return includes;
}

const std::vector<Include>& Includes() {
  static const std::vector<Include> includes = ReadIncludes();
  return includes;
}

// Headers that are installed: all of the libraries' rooms but the solver's internal ones.
bool IsPublicHeader(const Include& include) {
  return include.in_header && include.room != "apps" &&
         InternalHeaders().count("graticule/" + include.file) == 0;
}

TEST(Architecture, HasSourcesToLookAt) { EXPECT_GT(Includes().size(), 100u); }

TEST(Architecture, IncludesOnlyAlongTheArrows) {
  const std::map<std::string, std::set<std::string>> may = {
      {"solver", {"solver"}},
      {"factors", {"factors", "solver"}},
      {"io", {"io", "solver"}},
      {"problems", {"problems", "factors", "io", "solver"}},
      {"apps", {"apps", "problems", "factors", "io", "solver"}},
  };
  for (const Include& include : Includes()) {
    if (!include.Is("graticule/") || include.path == "graticule/version.hpp") continue;
    const std::string rest = include.path.substr(10);
    EXPECT_TRUE(may.at(include.room).count(rest.substr(0, rest.find('/')))) << include.Where();
  }
}

TEST(Architecture, SpellsEveryIncludeOfItsOwnInFull) {
  for (const Include& include : Includes()) {
    if (include.room == "apps") continue;  // nobody includes it from outside
    if (fs::exists(fs::path(SOURCE_DIR) / include.room / include.path) ||
        fs::exists((fs::path(SOURCE_DIR) / include.file).parent_path() / include.path))
      ADD_FAILURE() << include.Where() << ": expected graticule/" << include.room << "/...";
  }
}

TEST(Architecture, KeepsCeresBehindTheBridge) {
  for (const Include& include : Includes()) {
    if (!include.Is("ceres/")) continue;
    // Header-only parts, for automatic derivatives.
    const bool is_light = include.path == "ceres/jet.h" || include.path == "ceres/rotation.h";
    if (include.room == "factors" && is_light) continue;
    EXPECT_EQ(include.file, "solver/ceres_bridge.cpp") << include.Where();
  }
}

TEST(Architecture, KeepsTheCommandLineInItsFiles) {
  for (const Include& include : Includes()) {
    if (include.Is("CLI/")) {
      EXPECT_EQ(include.file, "apps/arguments_parts.hpp") << include.Where();
    }
  }
}

TEST(Architecture, KeepsHeavyHeadersOutOfPublicOnes) {
  for (const Include& include : Includes()) {
    if (!IsPublicHeader(include)) continue;
    for (const char* heavy : {"ceres/ceres.h", "nlohmann/", "yaml-cpp/", "CLI/", "opencv2/",
                              "cholmod.h", "glog/", "librsvg/", "zlib.h", "xxhash.h"})
      EXPECT_FALSE(include.Is(heavy)) << include.Where();
  }
}

TEST(Architecture, KeepsInternalHeadersInsideTheSolver) {
  const std::set<std::string> internal = InternalHeaders();
  for (const std::string& header : internal)
    EXPECT_TRUE(fs::exists(fs::path(SOURCE_DIR) / header.substr(10))) << header;
  for (const Include& include : Includes()) {
    if (internal.count(include.path) == 0) continue;
    EXPECT_EQ(include.room, "solver") << include.Where() << ", which is not installed";
    EXPECT_FALSE(IsPublicHeader(include)) << include.Where() << ", which is not installed";
  }
}

TEST(Architecture, KeepsFilesAndFormatsOutOfSolverAndFactors) {
  for (const Include& include : Includes())
    if (include.room == "solver" || include.room == "factors") {
      for (const char* alien :
           {"fstream", "iostream", "nlohmann/", "yaml-cpp/", "opencv2/", "fmt/"})
        EXPECT_FALSE(include.Is(alien)) << include.Where();
    }
}

TEST(Architecture, HasOneGuardAHeader) {
  for (const std::string& room : kRooms)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOURCE_DIR) / room)) {
      if (entry.path().extension() != ".hpp") continue;
      std::ifstream text(entry.path());
      std::string first;
      std::getline(text, first);
      EXPECT_EQ(first, "#pragma once") << entry.path();
    }
}

}  // namespace
