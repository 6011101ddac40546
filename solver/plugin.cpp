#include "graticule/solver/plugin.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "graticule/solver/error.hpp"

#ifndef GRATICULE_PLUGIN_DIR
#define GRATICULE_PLUGIN_DIR "/usr/lib/graticule/plugins"
#endif
#ifndef GRATICULE_PACKAGED_PLUGIN_DIR
#define GRATICULE_PACKAGED_PLUGIN_DIR GRATICULE_PLUGIN_DIR
#endif
#ifndef GRATICULE_PLUGIN_DIR_FROM_PROGRAM
#define GRATICULE_PLUGIN_DIR_FROM_PROGRAM "../lib/graticule/plugins"
#endif

namespace graticule {
namespace {

[[noreturn]] void Refuse(const std::string& file, const std::string& why) {
  throw Error("plug-in " + file + " refused: " + why, ErrorKind::kMissingType);
}

std::string TextOr(const char* text, const char* otherwise) {
  return text && *text ? text : otherwise;
}

const graticule_plugin_v1& Describe(const std::string& file, void* library) {
  const auto entry =
      reinterpret_cast<graticule_plugin_entry>(dlsym(library, GRATICULE_PLUGIN_ENTRY));
  if (!entry) Refuse(file, std::string("it has no symbol ") + GRATICULE_PLUGIN_ENTRY);
  const graticule_plugin_v1* plugin = nullptr;
  try {
    plugin = entry();
  } catch (const std::exception& exception) {
    Refuse(file, std::string("its entry threw: ") + exception.what());
  } catch (...) {
    Refuse(file, "its entry threw");
  }
  if (!plugin) Refuse(file, "its entry returned nothing");
  if (plugin->abi_version != GRATICULE_ABI_VERSION)
    Refuse(file, "it speaks version " + std::to_string(plugin->abi_version) +
                     " of the boundary, this program " + std::to_string(GRATICULE_ABI_VERSION));
  if (plugin->size < sizeof(graticule_plugin_v1))
    Refuse(file, "its table is too short for version 1");
  if (plugin->factor_type_count < 0 || plugin->variable_type_count < 0 ||
      plugin->factor_type_count > 10000 || plugin->variable_type_count > 10000 ||
      (plugin->factor_type_count > 0 && !plugin->factor_types) ||
      (plugin->variable_type_count > 0 && !plugin->variable_types))
    Refuse(file, "its counts of types are not right");
  return *plugin;
}

// Beside the running program, where there is such a folder: an installation may have been moved.
// Else, for programs that embed the library, where `cmake --install` or a package made one.  Only
// one of them, or a plug-in in two would be refused for taking its own names.
std::string InstalledPluginDir() {
  std::error_code problem;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", problem);
  if (!problem) {
    const auto folder =
        (program.parent_path() / GRATICULE_PLUGIN_DIR_FROM_PROGRAM).lexically_normal();
    if (std::filesystem::is_directory(folder, problem)) return folder.string();
  }
  if (!std::filesystem::is_directory(GRATICULE_PLUGIN_DIR, problem) &&
      std::filesystem::is_directory(GRATICULE_PACKAGED_PLUGIN_DIR, problem))
    return GRATICULE_PACKAGED_PLUGIN_DIR;
  return GRATICULE_PLUGIN_DIR;
}

}  // namespace

PluginInfo LoadPlugin(const std::string& file, Registry* types) {
  std::error_code problem;
  if (!std::filesystem::is_regular_file(file, problem)) Refuse(file, "there is no such file");
  // A path without a slash would be searched for in the system's folders.
  const std::string path = std::filesystem::absolute(file).string();
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) Refuse(file, TextOr(dlerror(), "it could not be opened"));
  const graticule_plugin_v1& plugin = Describe(file, library);

  PluginInfo info;
  info.file = file;
  info.name = TextOr(plugin.name, "unnamed");
  info.version = TextOr(plugin.version, "?");
  info.licence = TextOr(plugin.licence, "?");
  Registry grown = *types;
  try {
    for (int32_t i = 0; i < plugin.variable_type_count; ++i) {
      if (!plugin.variable_types[i]) Refuse(file, "one of its variable types is null");
      VariableType type = MakeVariableType(*plugin.variable_types[i], file);
      info.variable_types.push_back(type.name);
      grown.Add(std::move(type));
    }
    for (int32_t i = 0; i < plugin.factor_type_count; ++i) {
      if (!plugin.factor_types[i]) Refuse(file, "one of its factor types is null");
      FactorType type = MakeFactorType(*plugin.factor_types[i], file);
      info.factor_types.push_back(type.name);
      grown.Add(std::move(type));
    }
  } catch (const Error& error) {
    throw Error(error.what(), ErrorKind::kMissingType);
  }
  *types = std::move(grown);
  return info;
}

std::vector<std::string> PluginPath() {
  std::vector<std::string> folders;
  if (const char* path = std::getenv("GRATICULE_PLUGIN_PATH")) {
    const std::string text = path;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(':', begin), text.size());
      if (end > begin) folders.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  folders.push_back(InstalledPluginDir());
  return folders;
}

std::vector<PluginInfo> LoadPluginsFromPath(Registry* types) {
  std::vector<PluginInfo> loaded;
  for (const std::string& folder : PluginPath()) {
    std::error_code problem;
    std::vector<std::string> files;
    for (std::filesystem::directory_iterator it(folder, problem), end; !problem && it != end;
         it.increment(problem))
      if (it->path().extension() == ".so") files.push_back(it->path().string());
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) loaded.push_back(LoadPlugin(file, types));
  }
  return loaded;
}

}  // namespace graticule
