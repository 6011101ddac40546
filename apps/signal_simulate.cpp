#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/io/trajectory.hpp"
#include "graticule/problems/attenuation/simulate.hpp"
#include "output_folder.hpp"

namespace graticule::apps {

int Run(const SignalSimulateCommand& command, const Console& console) {
  SignalMissionOptions options;
  options.place = PlaceByName(command.place);
  if (command.seconds > 0) options.place.duration_s = command.seconds;
  options.robots = command.robots;
  options.rate_hz = command.rate_hz;
  options.radio.floor_dbm = command.floor_dbm;
  options.seed = command.seed;
  const OutputFolder folder(command.output);
  const SimulatedSignal simulated = SimulateSignal(options);
  WriteSignalLog(simulated.log, folder.Of("log.csv"));
  WriteOccupancy(*simulated.map, folder.Of("map"));
  WriteOccupancy(simulated.plan.Occupied(), folder.Of("truth"));
  if (command.maps) {
    const OutputFolder maps(folder.Of("maps"));
    for (const TimedMap& map : simulated.maps)
      WriteOccupancy(*map.map, maps.Of(fmt::format("{:05.0f}", map.time_s)));
  }
  for (std::size_t i = 0; i < simulated.trajectories.size(); ++i)
    folder.Write(simulated.log.radios[i] + ".tum", FormatTum(simulated.trajectories[i]));

  // What is where, row by row from below, a letter a cell; and what the letters mean.
  std::string cells;
  cells.reserve(simulated.plan.cells.size() + simulated.plan.height);
  for (std::size_t y = 0; y < simulated.plan.height; ++y) {
    for (std::size_t x = 0; x < simulated.plan.width; ++x)
      cells += static_cast<char>('a' + static_cast<int>(simulated.plan.At(x, y)));
    cells += '\n';
  }
  folder.Write("truth.cells", cells);
  nlohmann::ordered_json json = {{"schema", "graticule-signal-truth/1"},
                                 {"place", command.place},
                                 {"seed", command.seed},
                                 {"l0_dbm", options.radio.l0_dbm},
                                 {"exponent", simulated.plan.exponent},
                                 {"wall_ceiling_db", options.radio.ceiling_db},
                                 {"shadowing_db", options.radio.shadowing_db},
                                 {"resolution_m", simulated.plan.resolution}};
  for (std::size_t i = 0; i < FillingLosses().size(); ++i)
    json["fillings"][std::string(1, static_cast<char>('a' + static_cast<int>(i)))] = {
        {"name", FillingLosses()[i].name}, {"db_per_m", FillingLosses()[i].db_per_m}};
  for (std::size_t i = 0; i < simulated.log.radios.size(); ++i)
    json["radios"][simulated.log.radios[i]] = {{"bias_db", simulated.bias_db[i]},
                                               {"sending_db", simulated.sending_bias_db[i]},
                                               {"listening_db", simulated.listening_bias_db[i]}};
  folder.Write("truth.json", JsonText(json, 1) + "\n");
  console.Note(fmt::format("{}: {} measurements in {:g} s, {} robots", command.output,
                           simulated.log.measurements.size(), options.place.duration_s,
                           options.robots));
  return kDone;
}

}  // namespace graticule::apps
