#include "fuzz.hpp"
#include "graticule/io/signal_log.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  SignalLogOptions options;
  options.anchors = {{"1", {0, 0, 0}}, {"2", {5, 0, 2}}};
  options.trajectories["r"] = {StampPlanar(0, {0, 0, 0}), StampPlanar(9, {1, 2, 0})};
  const SignalLog log = ParseSignalLog(text, "fuzz.csv", options);
  const std::string again = FormatSignalLog(log);
  if (FormatSignalLog(ParseSignalLog(again, "again.csv")) != again) std::abort();
}
