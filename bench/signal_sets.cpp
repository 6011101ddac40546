#include "signal_sets.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

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

/// cls (a byte a cell, the lowest row first: 0 free, 1 structure, 2 unknown), the corner [m] and
/// res [m].
std::shared_ptr<const OccupancyGrid> ReadClasses(const std::string& path, std::size_t height,
                                                 std::size_t width, double x_m, double y_m) {
  constexpr Occupancy kClasses[] = {Occupancy::kFree, Occupancy::kStructure, Occupancy::kUnknown};
  const std::string zip = ReadFile(path);
  const std::string classes = ArrayBytes(zip, "cls");
  if (classes.size() != height * width) throw Error(path + ": not the size that was expected");
  auto grid = std::make_shared<OccupancyGrid>();
  grid->resolution = ReadAt<double>(ArrayBytes(zip, "res"), 0);
  grid->map_from_grid = {x_m, y_m, 0};
  grid->width = width;
  grid->height = height;
  for (const char c : classes) grid->cells.push_back(kClasses[std::min<unsigned char>(c, 2)]);
  return grid;
}

SignalSet LoadFlat(const std::string& signal_folder, const std::string& log) {
  const std::string folder = signal_folder + "/kolak_ble_flat/";
  SignalLogOptions options;
  options.anchors = ParseAnchors(ReadFile(folder + "anchors.csv"), folder + "anchors.csv");
  SignalSet set;
  set.log = ReadSignalLog(folder + log, options);
  set.map = ReadClasses(folder + "occupancy_layout_frame_5cm.npz", kKolakHeight, kKolakWidth, -1,
                        -1);  // its x0 and y0
  return set;
}

}  // namespace

SignalSet LoadKolak(const std::string& signal_folder) {
  return LoadFlat(signal_folder, "calibration/calibration_df.csv");
}

SignalSet LoadKolakTest(const std::string& signal_folder) {
  return LoadFlat(signal_folder, "tests/test_robot_df.csv");
}

SignalSet LoadGrenoble(const std::string& signal_folder) {
  return {ReadSignalLog(signal_folder + "/iotlab_mercator/grenoble_links.csv"), nullptr};
}

SignalSet LoadIkv(const std::string& signal_folder, int experiment) {
  const std::string folder = signal_folder + "/ikv_map/", number = std::to_string(experiment);
  const std::string map = folder + "exp" + number + "_registered.npz";
  const std::string zip = ReadFile(map), places = ArrayBytes(zip, "xy"),
                    routers = ArrayBytes(zip, "routers");
  std::istringstream lines(ReadFile(folder + "Exp" + number + "_2router.csv"));
  std::string line, text = "time,x,y,rssi_1a,rssi_1b,rssi_2a,rssi_2b\n";
  std::getline(lines, line);
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    std::istringstream cells(line);
    std::string cell;
    text += fmt::format("{},{},{}", 0.5 * static_cast<double>(i), ReadAt<double>(places, 16 * i),
                        ReadAt<double>(places, 16 * i + 8));
    for (int column = 0; column < 6 && std::getline(cells, cell, ','); ++column)
      if (column >= 2) text += ',' + cell;
    text += '\n';
  }
  SignalLogOptions options;
  for (const std::size_t router : {0, 1})
    for (const char* band : {"a", "b"})
      options.anchors[std::to_string(router + 1) + band] = {
          ReadAt<double>(routers, 16 * router), ReadAt<double>(routers, 16 * router + 8), 0};
  SignalSet set;
  set.log = ParseSignalLog(text, "Exp" + number + "_2router.csv", options);
  set.map = experiment == 3 ? ReadClasses(map, 770, 953, 0, 0) : ReadClasses(map, 453, 393, 0, 0);
  return set;
}

SignalSet LoadHarvard(const std::string& signal_folder, const std::string& room) {
  const std::string name = signal_folder + "/harvard_wsr/rss_20hz.csv.gz";
  std::istringstream lines(ReadFile(name));
  std::string line, text;
  std::getline(lines, line);
  text = line + '\n';
  while (std::getline(lines, line))
    if (line.compare(0, room.size() + 1, room + ',') == 0) text += line + '\n';
  SignalLogOptions options;
  options.sort = true;
  return {ParseSignalLog(text, name, options), nullptr};
}

SignalSet LoadVehicles(const std::string& signal_folder, const std::string& dump) {
  const std::string name = signal_folder + "/rti_mobile_vdmeij/dump_" + dump + ".json";
  const nlohmann::json packets = nlohmann::json::parse(ReadFile(name)).at("packets");
  std::string text = "time,receiver,transmitter,rx_x,rx_y,tx_x,tx_y,dbm\n";
  double time_s = 0;
  for (const nlohmann::json& packet : packets) {  // [sender, its x, y, known; other's; strength]
    time_s += 0.1;
    if (!packet.at(3).get<bool>() || !packet.at(6).get<bool>()) continue;
    const int sender = packet.at(0);
    text += fmt::format("{:.1f},{},{},{},{},{},{},{}\n", time_s, 3 - sender, sender,
                        packet.at(4).get<double>(), packet.at(5).get<double>(),
                        packet.at(1).get<double>(), packet.at(2).get<double>(),
                        packet.at(7).get<double>());
  }
  return {ParseSignalLog(text, name), nullptr};
}

}  // namespace graticule
