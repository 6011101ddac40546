#include "bind.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/signal_log.hpp"
#include "graticule/io/signal_pairs.hpp"
#include "signals.hpp"

namespace graticule::python {

using namespace py::literals;

namespace {

Eigen::Vector3d PlaceIn(const Dense<double>& places, py::ssize_t row) {
  return {places.at(row, 0), places.at(row, 1), places.shape(1) > 2 ? places.at(row, 2) : 0.0};
}

std::uint32_t RadioAt(const std::optional<Dense<std::int64_t>>& radios, py::ssize_t row,
                      std::uint32_t otherwise) {
  if (!radios) return otherwise;
  const std::int64_t radio = radios->at(row);
  if (radio < 0 || radio > 0xffffffff)
    throw Error("radios: expected numbers of 0 or more, found " + std::to_string(radio),
                ErrorKind::kUsage);
  return static_cast<std::uint32_t>(radio);
}

}  // namespace

std::vector<SignalLink> LinksOf(const Dense<double>& receivers_m,
                                const Dense<double>& transmitters_m,
                                const std::optional<Dense<std::int64_t>>& receivers,
                                const std::optional<Dense<std::int64_t>>& transmitters,
                                const std::optional<Dense<double>>& times_s) {
  const auto is_place = [](const Dense<double>& places) {
    return places.ndim() == 2 && (places.shape(1) == 2 || places.shape(1) == 3);
  };
  if (!is_place(receivers_m)) ExpectShape(receivers_m, {-1, 3}, "receivers_m");
  const py::ssize_t count = receivers_m.shape(0);
  if (!is_place(transmitters_m) || transmitters_m.shape(0) != count)
    ExpectShape(transmitters_m, {count, 3}, "transmitters_m");
  if (receivers) ExpectShape(*receivers, {count}, "receivers");
  if (transmitters) ExpectShape(*transmitters, {count}, "transmitters");
  if (times_s) ExpectShape(*times_s, {count}, "times_s");
  std::vector<SignalLink> links(static_cast<std::size_t>(count));
  for (py::ssize_t i = 0; i < count; ++i) {
    SignalLink& link = links[static_cast<std::size_t>(i)];
    link.time_s = times_s ? times_s->at(i) : 0;
    link.receiver = RadioAt(receivers, i, 0);
    link.transmitter = RadioAt(transmitters, i, 1);
    link.receiver_m = PlaceIn(receivers_m, i);
    link.transmitter_m = PlaceIn(transmitters_m, i);
  }
  return links;
}

std::vector<SignalLink> LinksOf(const SignalLog& log) {
  std::vector<SignalLink> links;
  for (const SignalMeasurement& measurement : log.measurements) links.push_back(measurement.link);
  return links;
}

namespace {

template <class T, class Get>
std::vector<T> Column(const SignalLog& log, const Get& get) {
  std::vector<T> column;
  column.reserve(log.measurements.size());
  for (const SignalMeasurement& measurement : log.measurements) column.push_back(get(measurement));
  return column;
}

py::array_t<double> Places(const SignalLog& log, const Eigen::Vector3d SignalLink::*end) {
  std::vector<double> rows;
  for (const SignalMeasurement& measurement : log.measurements)
    for (const int axis : {0, 1, 2}) rows.push_back((measurement.link.*end)[axis]);
  return Owned(std::move(rows), {static_cast<py::ssize_t>(log.measurements.size()), 3});
}

SignalLog LogOf(const Dense<double>& dbm, const Dense<double>& receivers_m,
                const Dense<double>& transmitters_m,
                const std::optional<Dense<std::int64_t>>& receivers,
                const std::optional<Dense<std::int64_t>>& transmitters,
                const std::optional<Dense<double>>& times_s,
                const std::optional<Dense<bool>>& heard, std::vector<std::string> radios) {
  const std::vector<SignalLink> links =
      LinksOf(receivers_m, transmitters_m, receivers, transmitters, times_s);
  ExpectShape(dbm, {receivers_m.shape(0)}, "dbm");
  if (heard) ExpectShape(*heard, {receivers_m.shape(0)}, "heard");
  SignalLog log;
  log.radios = std::move(radios);
  log.has_time = times_s.has_value();
  log.has_height = receivers_m.shape(1) > 2 || transmitters_m.shape(1) > 2;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    log.measurements.push_back({links[i], dbm.at(row), !heard || heard->at(row)});
    for (const std::uint32_t radio : {links[i].receiver, links[i].transmitter}) {
      if (radio > (1u << 20))
        throw Error("radios: expected numbers up to 1048576, found " + std::to_string(radio),
                    ErrorKind::kUsage);
      while (log.radios.size() <= radio)
        log.radios.push_back("radio" + std::to_string(log.radios.size()));
    }
    if (i && log.has_time && links[i].time_s < links[i - 1].time_s)
      throw Error("times_s: they go backwards at row " + std::to_string(i), ErrorKind::kUsage);
  }
  return log;
}

void BindLog(py::module_& m) {
  py::class_<SignalLog, std::shared_ptr<SignalLog>>(
      m, "SignalLog",
      "A log of received strengths, in the order of time.  Columns are copies: make another log "
      "to change them.")
      .def(py::init(&LogOf), "dbm"_a, "receivers_m"_a, "transmitters_m"_a,
           "receivers"_a = py::none(), "transmitters"_a = py::none(), "times_s"_a = py::none(),
           "heard"_a = py::none(), "radios"_a = std::vector<std::string>(),
           "dbm: (n,); receivers_m, transmitters_m: (n, 2) or (n, 3) in the map's frame; "
           "receivers, transmitters: (n,) into `radios`, None: 0 and 1; times_s: (n,) rising; "
           "heard: (n,), False: below `dbm`, no more is known.")
      .def_readonly("radios", &SignalLog::radios, "Names.")
      .def_readonly("has_time", &SignalLog::has_time, "Else every time is 0.")
      .def_readonly("has_height", &SignalLog::has_height, "Else every z is 0.")
      .def("__len__", [](const SignalLog& log) { return log.measurements.size(); })
      .def_property_readonly(
          "dbm",
          [](const SignalLog& log) {
            return Column<double>(log, [](const auto& m) { return m.dbm; });
          },
          "(n,) received strength [dBm].")
      .def_property_readonly(
          "heard",
          [](const SignalLog& log) {
            const auto flags = Column<std::uint8_t>(log, [](const auto& m) { return m.is_heard; });
            return py::array_t<bool>(static_cast<py::ssize_t>(flags.size()),
                                     reinterpret_cast<const bool*>(flags.data()));
          },
          "(n,) False: below `dbm`, no more is known.")
      .def_property_readonly(
          "times_s",
          [](const SignalLog& log) {
            return Column<double>(log, [](const auto& m) { return m.link.time_s; });
          },
          "(n,) [s].")
      .def_property_readonly(
          "receivers",
          [](const SignalLog& log) {
            return Column<std::uint32_t>(log, [](const auto& m) { return m.link.receiver; });
          },
          "(n,) into `radios`.")
      .def_property_readonly(
          "transmitters",
          [](const SignalLog& log) {
            return Column<std::uint32_t>(log, [](const auto& m) { return m.link.transmitter; });
          },
          "(n,) into `radios`.")
      .def_property_readonly(
          "receivers_m", [](const SignalLog& log) { return Places(log, &SignalLink::receiver_m); },
          "(n, 3) map_from_receiver [m].")
      .def_property_readonly(
          "transmitters_m",
          [](const SignalLog& log) { return Places(log, &SignalLink::transmitter_m); },
          "(n, 3) map_from_transmitter [m].")
      .def(
          "rows",
          [](const SignalLog& log, std::size_t begin, std::size_t end) {
            SignalLog part = log;
            end = std::min(end, log.measurements.size());
            begin = std::min(begin, end);
            const auto first = log.measurements.begin();
            part.measurements.assign(first + static_cast<std::ptrdiff_t>(begin),
                                     first + static_cast<std::ptrdiff_t>(end));
            return part;
          },
          "begin"_a, "end"_a, "The log of rows begin to end - 1.")
      .def("__repr__", [](const SignalLog& log) {
        return "SignalLog(" + std::to_string(log.measurements.size()) + " measurements of " +
               std::to_string(log.radios.size()) + " radios)";
      });
}

}  // namespace

void BindSignals(py::module_& module) {
  BindLog(module);
  module.def(
      "read_signal_log",
      [](const std::string& path, const std::map<std::string, Eigen::Vector3d>& anchors,
         const std::string& mobile, bool sort) {
        SignalLogOptions options;
        options.anchors = anchors;
        options.mobile = mobile;
        options.sort = sort;
        return ReadSignalLog(path, options);
      },
      "path"_a, "anchors"_a = std::map<std::string, Eigen::Vector3d>(), "mobile"_a = "mobile",
      "sort"_a = false,
      "Comma-separated values, long or wide (docs/formats.md).  anchors: map_from_radio [m] of "
      "radios whose places are not in the log.  sort: lines are put in the order of time.");
  module.def("write_signal_log", &WriteSignalLog, "log"_a, "path"_a,
             "The long form, which reads back to the bit.");
  module.def(
      "read_anchors", [](const std::string& path) { return ParseAnchors(ReadFile(path), path); },
      "path"_a, "(3,) places of fixed radios [m], by name: lines `id,x,y[,z]`.");
  module.def("read_signal_pairs", &ReadSignalPairs, "path"_a,
             "Links that strengths are to be predicted over: a log without strengths.");
}

}  // namespace graticule::python
