#include "bind.hpp"
#include "graticule/problems/attenuation/growing_map.hpp"
#include "graticule/problems/attenuation/methods.hpp"
#include "graticule/problems/attenuation/simulate.hpp"

namespace graticule::python {

void BindSignalSimulation(py::module_& module) {
  using namespace py::literals;
  Record<PlaceOptions>(module, "PlaceOptions", "What kind of place, and how large.")
      .Field("name", &PlaceOptions::name, "Its name.")
      .Field("width_m", &PlaceOptions::width_m, "[m]")
      .Field("height_m", &PlaceOptions::height_m, "[m]")
      .Field("duration_s", &PlaceOptions::duration_s, "Of its exploration [s].")
      .Field("seed", &PlaceOptions::seed, "Same options, same plan.");
  module.def("place_by_name", &PlaceByName, "name"_a,
             "nw1, nw2, bbb3, eecs4, dc1 (as in thesis 3.3.1), room, house, office, street.");
  Record<RadioOptions>(module, "RadioOptions", "How signals of 2.4 GHz spread.")
      .Field("l0_dbm", &RadioOptions::l0_dbm, "Strength at 1 m [dBm].")
      .Field("ceiling_db", &RadioOptions::ceiling_db, "Of walls together [dB].")
      .Field("shadowing_db", &RadioOptions::shadowing_db, "Standard deviation [dB].")
      .Field("k_in_sight_db", &RadioOptions::k_in_sight_db, "Rician factor [dB].")
      .Field("k_hidden_db", &RadioOptions::k_hidden_db, "Behind walls [dB].")
      .Field("bias_db", &RadioOptions::bias_db, "Standard deviation of a radio [dB].")
      .Field("step_db", &RadioOptions::step_db, "Of the strengths reported [dB].")
      .Field("floor_dbm", &RadioOptions::floor_dbm, "Weaker packets are not heard [dBm].");
  Record<SignalMissionOptions>(module, "SignalMissionOptions",
                               "Robots that explore a place and measure each other's signal.")
      .Field("place", &SignalMissionOptions::place, "Where.")
      .Field("radio", &SignalMissionOptions::radio, "How signals spread.")
      .Field("robots", &SignalMissionOptions::robots, "How many.")
      .Field("rate_hz", &SignalMissionOptions::rate_hz, "Packets of each radio [1/s].")
      .Field("speed_m_s", &SignalMissionOptions::speed_m_s, "[m/s]")
      .Field("height_m", &SignalMissionOptions::height_m, "Of the antennas [m].")
      .Field("scan_every_s", &SignalMissionOptions::scan_every_s, "[s]")
      .Field("scan_range_m", &SignalMissionOptions::scan_range_m, "[m]")
      .Field("map_every_s", &SignalMissionOptions::map_every_s, "A snapshot of the map [s].")
      .Field("seed", &SignalMissionOptions::seed, "Same options, same digits.");
  py::class_<SimulatedSignal, std::shared_ptr<SimulatedSignal>>(module, "SimulatedSignal",
                                                                "A signal mission with truth.")
      .def_readonly("log", &SimulatedSignal::log, "What was heard.")
      .def_property_readonly(
          "map", [](const SimulatedSignal& self) { return OccupancyGrid(*self.map); },
          "As the robots knew it at the end.")
      .def_property_readonly(
          "truth", [](const SimulatedSignal& self) { return self.plan.Occupied(); },
          "The place itself: structure or free.")
      .def_readonly("bias_db", &SimulatedSignal::bias_db, "(radios,) the truth [dB].")
      .def(
          "make_predictor",
          [](const SimulatedSignal& self, const std::string& method) {
            return std::shared_ptr<SignalPredictor>(
                std::make_shared<GrowingMap>(MakePredictor(method), self.maps));
          },
          "method"_a = kBestMethod,
          "A predictor that knows at each update the map as it was then, as robots do that "
          "explore.");
  module.def(
      "simulate_signal",
      [](const SignalMissionOptions* options, const py::kwargs& keywords) {
        const SignalMissionOptions chosen = OptionsFrom(options, keywords);
        const py::gil_scoped_release released;
        return SimulateSignal(chosen);
      },
      "options"_a = nullptr, "Options also as keywords.");
}

}  // namespace graticule::python
