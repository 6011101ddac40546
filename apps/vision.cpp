#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "commands.hpp"
#include "graticule/solver/error.hpp"

// OpenCV's readers of pictures and films bring two hundred shared libraries, which take five times
// as long to load as the rest of the program: only the commands that look at pictures pay for them,
// in a program of their own beside this one.

namespace graticule::apps {
namespace {

std::vector<std::string> OwnWords() {
  std::vector<std::string> words;
  std::FILE* file = std::fopen("/proc/self/cmdline", "re");
  if (file == nullptr) throw Error("/proc/self/cmdline: cannot be read", ErrorKind::kOther);
  std::string word;
  for (int c; (c = std::fgetc(file)) != EOF;) {
    if (c != 0) {
      word += static_cast<char>(c);
      continue;
    }
    words.push_back(word);
    word.clear();
  }
  std::fclose(file);
  return words;
}

// Becomes the program that has the command, with the same words; returns only by a throw.
int Become(const char* program) {
  std::vector<std::string> words = OwnWords();
  const std::filesystem::path path =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(path.c_str(), arguments.data());
  throw Error(path.string() + ": the part of graticule that looks at pictures cannot be run: " +
                  std::strerror(errno),
              ErrorKind::kOther);
}

constexpr char kVision[] = "graticule-vision";

}  // namespace

int Run(const CalibrateCommand&, const Console&) { return Become(kVision); }
int Run(const CalibrateEvaluateCommand&, const Console&) { return Become(kVision); }
int Run(const CalibrateGuideCommand&, const Console&) { return Become(kVision); }
int Run(const CalibrateTargetCommand&, const Console&) { return Become(kVision); }
int Run(const SegmentCommand&, const Console&) { return Become(kVision); }
int Run(const SegmentEvaluateCommand&, const Console&) { return Become(kVision); }
int Run(const SimulateSceneCommand&, const Console&) { return Become(kVision); }
int Run(const CoregisterCommand&, const Console&) { return Become(kVision); }

}  // namespace graticule::apps
