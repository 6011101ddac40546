#include "problem.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "graticule/factors/builtins.hpp"
#include "graticule/factors/lens_plugin.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/plugin.hpp"
#include "graticule/solver/provenance.hpp"

namespace graticule::apps {
namespace {

template <class Count>
std::string CountByType(std::size_t size, const Count& type_of) {
  std::map<std::string, std::size_t> counts;
  for (std::uint32_t id = 0; id < size; ++id) ++counts[type_of(id)];
  std::string text;
  for (const auto& [type, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, type);
  return text.empty() ? "none" : text;
}

}  // namespace

Registry LoadTypes(const Reading& reading) {
  Registry types = Builtins();
  std::vector<PluginInfo> loaded = LoadPluginsFromPath(&types);
  for (const std::string& file : reading.plugins) loaded.push_back(LoadPlugin(file, &types));
  for (const PluginInfo& plugin : loaded) LoadLenses(plugin.file, types);
  return types;
}

ReadOptions OptionsOf(const Reading& reading) {
  ReadOptions options;
  options.skip_unknown = reading.skip_unknown;
  options.repair_information = reading.repair_information;
  if (!reading.g2o_rotation.empty()) options.rotation = G2oRotationFromWord(reading.g2o_rotation);
  return options;
}

std::vector<std::string> NotesOf(const Recording& recording, const std::string& file) {
  std::vector<std::string> notes;
  for (const auto& [tag, count] : recording.skipped)
    notes.push_back(fmt::format("{}: skipped {} lines of {}", file, count, tag));
  for (const std::string& note : recording.notes) notes.push_back(file + ": " + note);
  if (recording.repaired) notes.push_back(file + ": " + ToString(*recording.repaired));
  return notes;
}

Recording Load(const std::string& file, const Reading& reading, const Registry& types,
               const Console& console) {
  Recording recording = ReadProblem(file, types, OptionsOf(reading));
  for (const std::string& note : NotesOf(recording, file)) console.Note(note);
  return recording;
}

Configuration Choose(const Choosing& choosing) {
  Configuration configuration;
  if (!choosing.config.empty()) configuration = LoadConfiguration(choosing.config);
  for (const std::string& setting : choosing.settings) configuration.Set(setting);
  return configuration;
}

void ExpectWritable(const std::string& path) {
  if (path.empty()) return;
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  std::error_code problem;
  if (!fs::is_directory(folder, problem))
    throw Error(path + ": there is no folder " + folder.string(), ErrorKind::kOther);
  if (fs::is_directory(path, problem)) throw Error(path + ": is a folder", ErrorKind::kOther);
  const bool there = fs::exists(path, problem);
  if (access(there && !fs::is_regular_file(path, problem) ? path.c_str() : folder.c_str(), W_OK) !=
      0)
    throw Error(path + ": the folder is not writable", ErrorKind::kOther);
}

std::vector<std::string> ProblemEndings() {
  return {".fg", ".g2o", ".graph", ".toro", ".bal", ".txt"};
}

std::string Ending(const std::string& path) {
  std::filesystem::path p = path;
  if (p.extension() == ".gz") p = p.stem();
  return p.extension().string();
}

void ExpectEnding(const std::string& path, const char* option,
                  const std::vector<std::string>& endings) {
  if (path.empty() || std::find(endings.begin(), endings.end(), Ending(path)) != endings.end())
    return;
  std::string list;
  for (const std::string& ending : endings) list += (list.empty() ? "" : " or ") + ending;
  throw Error(
      fmt::format("{}: expected a file name that ends in {}, found '{}'", option, list, path),
      ErrorKind::kUsage);
}

std::vector<std::pair<std::string, std::string>> TrajectoryFiles(const std::string& path,
                                                                 const Graph& graph) {
  if (path.empty()) return {};
  const std::vector<std::string> families = PoseFamilies(graph);
  if (families.empty())
    throw Error(path + ": there is no trajectory to write: the problem has no poses (se2/1, se3/1)",
                ErrorKind::kUsage);
  return FilesOfFamilies(path, families);
}

std::vector<std::pair<std::string, std::string>> FilesOfFamilies(
    const std::string& path, const std::vector<std::string>& families) {
  if (families.size() == 1) return {{path, families[0]}};
  std::vector<std::pair<std::string, std::string>> files;
  const std::filesystem::path whole = path;
  for (const std::string& family : families) {
    std::filesystem::path file = whole;
    file.replace_filename(whole.stem().string() + "." + family + whole.extension().string());
    files.emplace_back(file.string(), family);
  }
  return files;
}

std::string MadeBy(const std::string& words) {
  return fmt::format("graticule {} {}", Version(), words);
}

std::string CountVariables(const Graph& graph) {
  return CountByType(graph.VariableCount(), [&](VariableId id) { return graph.TypeOf(id).name; });
}

std::string CountFactors(const Graph& graph) {
  return CountByType(graph.FactorCount(),
                     [&](FactorId id) { return graph.FactorAt(id).type->name; });
}

}  // namespace graticule::apps
