#include "fuzz.hpp"
#include "graticule/io/file.hpp"
#include "graticule/problems/attenuation/tune.hpp"
#include "memory_folder.hpp"

// What a search that was stopped has kept, behind the heading that the search itself writes.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const MemoryFolder folder;
  static const std::string path = folder / "a.state";
  CompassOptions options;
  options.max_evaluations = 9;
  options.state_path = path;
  const auto search = [&] {
    return CompassSearch([](const std::vector<double>& at) { return at[0] * at[0] - at[1]; },
                         {1, 2}, options);
  };
  static const std::string heading = [&] {
    search();
    const std::string state = ReadFile(path);
    return state.substr(0, state.find('\n', state.find('\n') + 1) + 1);
  }();
  WriteFile(path, heading + std::string(text));
  search();
}
