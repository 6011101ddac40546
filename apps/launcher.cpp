#include "launcher.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

// Slurm's are those of a step: what a batch script itself sees does not count.  Open MPI's come
// first, for its mpirun may itself run in a step.
constexpr const char* kVariables[][2] = {
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
    {"PMI_RANK", "PMI_SIZE"},
    {"SLURM_PROCID", "SLURM_STEP_NUM_TASKS"},
};

bool ReadNumber(const char* variable, int* number) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return false;
  const char* end = text + std::strlen(text);
  const auto [stop, problem] = std::from_chars(text, end, *number);
  return problem == std::errc() && stop == end;
}

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

}  // namespace

Launched LaunchedAs() {
  const char* launcher = std::getenv("GRATICULE_LAUNCHER");
  if (launcher != nullptr && std::string(launcher) == "none") return {};
  for (const auto& [rank, size] : kVariables) {
    Launched launched;
    if (ReadNumber(rank, &launched.rank) && ReadNumber(size, &launched.size) &&
        launched.rank >= 0 && launched.rank < launched.size)
      return launched;
  }
  return {};
}

void ExpectAlone(const std::string& command) {
  const int size = LaunchedAs().size;
  if (size > 1)
    throw Error(fmt::format("{}: a launcher started {} processes of it; only compare and signal "
                            "tune spread their work over several",
                            command, size),
                ErrorKind::kUsage);
}

int Become(const char* program, const char* lack) {
  std::vector<std::string> words = OwnWords();
  const std::filesystem::path path =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(path.c_str(), arguments.data());
  throw Error(path.string() + ": " + lack + ": " + std::strerror(errno), ErrorKind::kOther);
}

}  // namespace graticule::apps
