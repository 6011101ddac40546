#include "graticule/io/signal_pairs.hpp"

#include <algorithm>
#include <unordered_map>

#include "graticule/io/csv_table.hpp"
#include "graticule/io/file.hpp"

namespace graticule {

SignalLog ParseSignalPairs(std::string_view text, const std::string& name) {
  CsvTable table(text, name);
  constexpr std::size_t kNone = CsvTable::kNone;
  const std::size_t time = table.Find({"time", "time_s", "t", "stamp", "timestamp"});
  const std::size_t receiver = table.Find({"receiver", "rx"});
  const std::size_t transmitter = table.Find({"transmitter", "tx"});
  const std::size_t at[] = {table.Find({"rx_x", "receiver_x"}), table.Find({"rx_y", "receiver_y"}),
                            table.Find({"tx_x", "transmitter_x"}),
                            table.Find({"tx_y", "transmitter_y"})};
  const std::size_t rx_z = table.Find({"rx_z", "receiver_z"});
  const std::size_t tx_z = table.Find({"tx_z", "transmitter_z"});
  const std::size_t dbm = table.Find({"dbm", "rssi", "rss_dbm"});
  if (std::find(std::begin(at), std::end(at), kNone) != std::end(at))
    table.FailLine("pairs need the columns rx_x, rx_y, tx_x and tx_y");
  SignalLog log;
  log.has_time = time != kNone;
  log.has_height = rx_z != kNone || tx_z != kNone;
  std::unordered_map<std::string, std::uint32_t> radios;
  const auto radio = [&](std::size_t column, const char* nameless) {
    const std::string word(column == kNone ? nameless : table.Cell(column));
    if (word.empty()) table.Fail(column, "expected the name of a radio, found nothing");
    const auto [found, is_new] =
        radios.emplace(word, static_cast<std::uint32_t>(log.radios.size()));
    if (is_new) log.radios.push_back(word);
    return found->second;
  };
  while (table.Next()) {
    SignalMeasurement pair;
    pair.is_heard = dbm != kNone;
    if (pair.is_heard) pair.dbm = table.Number(dbm);
    pair.link.time_s = time == kNone ? 0 : table.Number(time);
    pair.link.receiver = radio(receiver, "rx");
    pair.link.transmitter = radio(transmitter, "tx");
    pair.link.receiver_m = {table.Number(at[0]), table.Number(at[1]),
                            rx_z == kNone ? 0 : table.Number(rx_z)};
    pair.link.transmitter_m = {table.Number(at[2]), table.Number(at[3]),
                               tx_z == kNone ? 0 : table.Number(tx_z)};
    log.measurements.push_back(pair);
  }
  if (log.measurements.empty()) table.FailLine("there is no pair in this file");
  return log;
}

SignalLog ReadSignalPairs(const std::string& path) {
  return ParseSignalPairs(ReadFile(path), path);
}

}  // namespace graticule
