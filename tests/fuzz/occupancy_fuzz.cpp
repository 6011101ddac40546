#include "fuzz.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/occupancy.hpp"
#include "memory_folder.hpp"

// The YAML file, and behind a zero its picture, whatever the file calls it: `p` is meant.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  static const MemoryFolder folder;
  const std::size_t zero = std::min(text.find('\0'), text.size());
  // Not out of this folder: there are devices.
  if (text.substr(0, zero).find('/') != std::string_view::npos) return;
  WriteFile(folder / "a.yaml", text.substr(0, zero));
  WriteFile(folder / "p", text.substr(std::min(zero + 1, text.size())));
  const OccupancyGrid grid = ReadOccupancy(folder / "a.yaml");
  // What was read is written trinary, and read again the same.
  WriteOccupancy(grid, folder / "again");
  const OccupancyGrid again = ReadOccupancy(folder / "again.yaml");
  if (again.cells != grid.cells || again.resolution != grid.resolution) std::abort();
}
