#include "fuzz.hpp"
#include "graticule/io/bag_images.hpp"
#include "graticule/io/bag_laser.hpp"
#include "graticule/io/file.hpp"
#include "memory_folder.hpp"

// What scans and images a bag has: readers that go through the file more than once.
GRATICULE_FUZZ(bytes) {
  using namespace graticule;
  static const MemoryFolder folder;
  static const std::string path = folder / "a.bag";
  WriteFile(path, bytes);
  const auto quietly = [](const auto& read) {
    try {
      read();
    } catch (const Error&) {
    }
  };
  quietly([] {
    BagImages images(path, "");
    while (images.Next()) {
    }
  });
  LaserLog log;
  ReadBagLaser(path, {}, &log);
  for (const LaserScan& scan : log.scans)
    if (scan.geometry >= log.geometries.size() || scan.first_range + scan.beams > log.ranges.size())
      std::abort();
}
