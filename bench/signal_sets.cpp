#include "signal_sets.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kKolakWidth = 221, kKolakHeight = 181;  // as the map's header says

template <class T>
T ReadAt(const std::string& bytes, std::size_t offset) {
  if (bytes.size() < sizeof(T) || offset > bytes.size() - sizeof(T))
    throw Error("an archive that is cut short");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// The data of an array in a .npz, which is a zip of .npy files; the sizes are in the zip's central
/// directory.  Only what numpy.savez_compressed writes.
std::string ArrayBytes(const std::string& zip, const std::string& name) {
  for (std::size_t at = zip.find("PK\1\2"); at != std::string::npos;
       at = zip.find("PK\1\2", at + 4)) {
    const auto packed_size = ReadAt<std::uint32_t>(zip, at + 20);
    const auto size = ReadAt<std::uint32_t>(zip, at + 24);
    const auto name_size = ReadAt<std::uint16_t>(zip, at + 28);
    const std::size_t local = ReadAt<std::uint32_t>(zip, at + 42);
    if (zip.compare(at + 46, name_size, name + ".npy") != 0) continue;
    const std::size_t data = local + 30 + ReadAt<std::uint16_t>(zip, local + 26) +
                             ReadAt<std::uint16_t>(zip, local + 28);
    if (data + packed_size > zip.size()) throw Error("an archive that is cut short");
    std::string array(size, '\0');
    z_stream stream = {};
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(zip.data() + data));
    stream.avail_in = packed_size;
    stream.next_out = reinterpret_cast<Bytef*>(array.data());
    stream.avail_out = size;
    inflateInit2(&stream, -MAX_WBITS);
    const int outcome = inflate(&stream, Z_FINISH);
    inflateEnd(&stream);
    if (outcome != Z_STREAM_END) throw Error(name + ": damaged");
    const std::size_t header = 10 + ReadAt<std::uint16_t>(array, 8);
    if (header > array.size()) throw Error(name + ": cut short");
    return array.substr(header);
  }
  throw Error("no array " + name);
}

/// cls (a byte a cell, the lowest row first: 0 free, 1 structure, 2 unknown), x0 and y0 [m, whole],
/// res [m].
std::shared_ptr<const OccupancyGrid> ReadClasses(const std::string& path, std::size_t height,
                                                 std::size_t width) {
  constexpr Occupancy kClasses[] = {Occupancy::kFree, Occupancy::kStructure, Occupancy::kUnknown};
  const std::string zip = ReadFile(path);
  const std::string classes = ArrayBytes(zip, "cls");
  if (classes.size() != height * width) throw Error(path + ": not the size that was expected");
  auto grid = std::make_shared<OccupancyGrid>();
  grid->resolution = ReadAt<double>(ArrayBytes(zip, "res"), 0);
  grid->map_from_grid = {static_cast<double>(ReadAt<std::int64_t>(ArrayBytes(zip, "x0"), 0)),
                         static_cast<double>(ReadAt<std::int64_t>(ArrayBytes(zip, "y0"), 0)), 0};
  grid->width = width;
  grid->height = height;
  for (const char c : classes) grid->cells.push_back(kClasses[std::min<unsigned char>(c, 2)]);
  return grid;
}

}  // namespace

SignalSet LoadKolak(const std::string& signal_folder) {
  const std::string folder = signal_folder + "/kolak_ble_flat";
  SignalLogOptions options;
  options.anchors = ParseAnchors(ReadFile(folder + "/anchors.csv"), folder + "/anchors.csv");
  SignalSet set;
  set.log = ReadSignalLog(folder + "/calibration/calibration_df.csv", options);
  set.map = ReadClasses(folder + "/occupancy_layout_frame_5cm.npz", kKolakHeight, kKolakWidth);
  return set;
}

SignalSet LoadGrenoble(const std::string& signal_folder) {
  return {ReadSignalLog(signal_folder + "/iotlab_mercator/grenoble_links.csv"), nullptr};
}

}  // namespace graticule
