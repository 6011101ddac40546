#include "configuration.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "graticule/io/config.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule::apps {
namespace {

namespace fs = std::filesystem;

// Where ready configurations lie: named by the user, or beside the program.
std::vector<fs::path> Folders() {
  std::vector<fs::path> folders;
  if (const char* named = std::getenv("GRATICULE_CONFIG_PATH")) folders.emplace_back(named);
  std::error_code problem;
  const fs::path program = fs::read_symlink("/proc/self/exe", problem);
  if (!problem) folders.push_back(program.parent_path() / GRATICULE_CONFIG_FROM_PROGRAM);
  return folders;
}

template <class Options>
bool Has(const std::vector<OptionRow<Options>>& table, std::string_view name) {
  return std::any_of(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
}

}  // namespace

void Configuration::Set(std::string_view option, std::string_view value) {
  if (Has(InitialiseOptionTable(), option))
    return SetOption(InitialiseOptionTable(), option, value, &initialise);
  if (Has(RejectionOptionTable(), option))
    return SetOption(RejectionOptionTable(), option, value, &rejection);
  if (Has(SolveOptionTable(), option)) return SetOption(SolveOptionTable(), option, value, &solve);
  std::vector<std::string_view> names;
  for (const auto& row : InitialiseOptionTable()) names.push_back(row.name);
  for (const auto& row : RejectionOptionTable()) names.push_back(row.name);
  for (const auto& row : SolveOptionTable()) names.push_back(row.name);
  throw Error("there is no option '" + std::string(option.substr(0, 60)) + "'" +
                  DidYouMean(option, names) + "; `graticule options` lists them",
              ErrorKind::kUsage);
}

void Configuration::Set(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw Error("--set: expected name=value, found '" + std::string(assignment.substr(0, 60)) + "'",
                ErrorKind::kUsage);
  Set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

std::vector<std::string> ReadyConfigurations() {
  std::set<std::string> names;
  for (const fs::path& folder : Folders()) {
    std::error_code problem;
    for (fs::directory_iterator it(folder, problem), end; !problem && it != end;
         it.increment(problem))
      if (it->path().extension() == ".yaml") names.insert(it->path().stem().string());
  }
  return {names.begin(), names.end()};
}

Configuration LoadConfiguration(const std::string& name_or_file) {
  Configuration configuration;
  configuration.name = name_or_file;
  std::string path = name_or_file;
  if (name_or_file.find_first_of("/.") == std::string::npos) {
    path.clear();
    for (const fs::path& folder : Folders()) {
      const fs::path candidate = folder / (name_or_file + ".yaml");
      std::error_code problem;
      if (path.empty() && fs::is_regular_file(candidate, problem)) path = candidate.string();
    }
    if (path.empty()) {
      const std::vector<std::string> ready = ReadyConfigurations();
      std::string list;
      for (const std::string& name : ready) list += (list.empty() ? "" : ", ") + name;
      throw Error("there is no configuration '" + name_or_file + "'" +
                      DidYouMean(name_or_file, {ready.begin(), ready.end()}) +
                      "; ready ones: " + list,
                  ErrorKind::kUsage);
    }
  } else {
    configuration.name = fs::path(name_or_file).stem().string();
  }
  for (const ConfigEntry& entry : ParseConfig(ReadFile(path), path)) {
    try {
      configuration.Set(entry.name, entry.value);
    } catch (const Error& error) {
      throw Error(path, entry.line, entry.column, error.what(), ErrorKind::kUsage);
    }
  }
  return configuration;
}

std::vector<OptionLine> DescribeOptions(const Configuration& configuration) {
  std::vector<OptionLine> lines;
  for (const auto& row : InitialiseOptionTable())
    lines.push_back({row.name, row.accepts, row.get(configuration.initialise), row.help});
  for (const auto& row : RejectionOptionTable())
    lines.push_back({row.name, row.accepts, row.get(configuration.rejection), row.help});
  for (const auto& row : SolveOptionTable())
    lines.push_back({row.name, row.accepts, row.get(configuration.solve), row.help});
  return lines;
}

}  // namespace graticule::apps
