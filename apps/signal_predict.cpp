#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "graticule/io/file.hpp"
#include "graticule/io/geography.hpp"
#include "graticule/io/grey_image.hpp"
#include "graticule/io/signal_drawing.hpp"
#include "graticule/io/signal_pairs.hpp"
#include "graticule/io/svg.hpp"
#include "graticule/io/text.hpp"
#include "numbers.hpp"
#include "outputs.hpp"
#include "problem.hpp"
#include "signal_model.hpp"

namespace graticule::apps {
namespace {

/// The upright rectangle around a map.
struct Extent {
  double x0, y0, x1, y1;
};

Extent ExtentOf(const OccupancyGrid& map) {
  const double c = std::cos(map.map_from_grid.yaw), s = std::sin(map.map_from_grid.yaw);
  Extent extent{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const double u : {0.0, static_cast<double>(map.width) * map.resolution})
    for (const double v : {0.0, static_cast<double>(map.height) * map.resolution}) {
      const double x = map.map_from_grid.x + c * u - s * v, y = map.map_from_grid.y + s * u + c * v;
      extent = {std::min(extent.x0, x), std::min(extent.y0, y), std::max(extent.x1, x),
                std::max(extent.y1, y)};
    }
  return extent;
}

HeatField FieldOver(const Extent& extent, double step_m) {
  HeatField field;
  field.left_m = extent.x0;
  field.bottom_m = extent.y0;
  field.step_m = step_m;
  field.width = static_cast<std::size_t>(std::ceil((extent.x1 - extent.x0) / step_m - 1e-9));
  field.height = static_cast<std::size_t>(std::ceil((extent.y1 - extent.y0) / step_m - 1e-9));
  field.values.assign(field.width * field.height, NAN);
  return field;
}

Eigen::Vector3d CentreOf(const HeatField& field, std::size_t x, std::size_t y, double height_m) {
  return {field.left_m + (static_cast<double>(x) + 0.5) * field.step_m,
          field.bottom_m + (static_cast<double>(y) + 0.5) * field.step_m, height_m};
}

/// A picture of one pixel a step, and where it is.
void WriteRaster(const std::string& name, const HeatField& field, double scale, double offset) {
  GreyImage image;
  image.width = field.width;
  image.height = field.height;
  for (std::size_t y = field.height; y-- > 0;)
    for (std::size_t x = 0; x < field.width; ++x)
      image.shades.push_back(static_cast<std::uint8_t>(
          std::clamp(std::round(scale * field.values[y * field.width + x] + offset), 0.0, 255.0)));
  WriteFile(name + ".png", FormatPng(image));
  OccupancyGrid grid;
  grid.resolution = field.step_m;
  grid.map_from_grid = {field.left_m, field.bottom_m, 0};
  grid.width = field.width;
  grid.height = field.height;
  WriteFile(name + ".pgw", FormatWorldFile(grid));
}

std::uint32_t RadioOf(const char* option, const SignalModel& model, const std::string& name) {
  if (name.empty()) return static_cast<std::uint32_t>(model.radios.size());  // of no known bias
  const std::uint32_t radio = model.RadioOf(name);
  if (radio < model.radios.size()) return radio;
  std::string list;
  for (const std::string& known : model.radios) list += (list.empty() ? "" : ", ") + known;
  throw Error(
      fmt::format("{}: the model knows no radio {}; it knows {}", option, Quoted(name), list),
      ErrorKind::kUsage);
}

Eigen::Vector3d PlaceOf(const std::string& text) {
  const auto commas = std::count(text.begin(), text.end(), ',');
  const std::vector<double> at =
      ReadNumbers("--from", text, commas == 2 ? 3 : 2, "X,Y or X,Y,Z in m");
  return {at[0], at[1], at.size() > 2 ? at[2] : 0};
}

Exit PredictEverywhere(const SignalPredictCommand& command, const SignalModel& model,
                       const OccupancyGrid& map, const Console& console) {
  const Extent extent = ExtentOf(map);
  const double longer = std::max(extent.x1 - extent.x0, extent.y1 - extent.y0);
  const double step = command.step_m > 0 ? command.step_m : longer / 120;
  if (longer / step > 8192)
    throw Error("--step: the picture would be wider than 8192 pixels", ErrorKind::kUsage);
  HeatField strength = FieldOver(extent, step), sigma = FieldOver(extent, step);
  const Eigen::Vector3d from = PlaceOf(command.from);
  SignalLink link;
  link.time_s = model.now_s;
  link.transmitter = RadioOf("--radio", model, command.radio);
  link.receiver = RadioOf("--to", model, command.to);
  if (link.receiver == link.transmitter) ++link.receiver;
  link.transmitter_m = from;
  std::vector<SignalLink> links;
  for (std::size_t y = 0; y < strength.height; ++y)
    for (std::size_t x = 0; x < strength.width; ++x) {
      link.receiver_m = CentreOf(strength, x, y, from.z());
      links.push_back(link);
    }
  std::vector<SignalPrediction> predictions(links.size());
  model.predictor->Predict(links, {predictions.data(), predictions.size()});
  for (std::size_t i = 0; i < links.size(); ++i) {
    strength.values[i] = predictions[i].dbm;
    sigma.values[i] = predictions[i].sigma_db;
  }
  strength.title =
      fmt::format("{}: strength from ({}, {})", model.method, Shown(from.x()), Shown(from.y()));
  strength.unit = "dBm";
  sigma.title = "its standard deviation";
  sigma.unit = "dB";
  sigma.low_is_good = true;
  const std::string svg =
      DrawHeat({strength, sigma}, &map,
               {{from.x(), from.y(), command.radio.empty() ? "from" : command.radio}});
  Outputs outputs(console);
  const std::string picture = command.map_of + ".png";
  outputs.Try(picture, [&] { WriteFile(picture, PngFromSvg(svg, 1400)); });
  const auto write = [&](const std::string& name, const HeatField& field, double scale,
                         double offset) {
    outputs.Try(name, [&] { WriteRaster(name, field, scale, offset); });
  };
  write(command.map_of + ".dbm", strength, 1, 200);
  write(command.map_of + ".sigma", sigma, 10, 0);
  return outputs.Failure();
}

// Of pairs whose strength is known.
void SayHowFar(const std::string& pairs, const SignalLog& log,
               const std::vector<SignalPrediction>& predictions, const Console& console) {
  double squares = 0, sum = 0;
  std::size_t inside = 0;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const double off = predictions[i].dbm - log.measurements[i].dbm;
    sum += off;
    squares += off * off;
    inside += std::abs(off) <= predictions[i].sigma_db;
  }
  const auto n = static_cast<double>(predictions.size());
  console.Note(fmt::format(
      "{}: {} strengths are predicted to {:.2f} dB (rms; mean {:+.2f} dB), {:.0f} % within one "
      "standard deviation",
      pairs, predictions.size(), std::sqrt(squares / n), sum / n,
      100 * static_cast<double>(inside) / n));
}

void PredictPairs(const SignalPredictCommand& command, const SignalModel& model,
                  const Console& console) {
  const SignalLog log = ReadSignalPairs(command.pairs);
  std::vector<SignalLink> links;
  for (const SignalMeasurement& measurement : log.measurements) {
    SignalLink link = measurement.link;
    if (!log.has_time) link.time_s = model.now_s;
    // Names become the model's numbers; nameless ends are of no known bias.
    const auto number = [&](std::uint32_t radio) {
      return std::min<std::uint32_t>(model.RadioOf(log.radios[radio]),
                                     static_cast<std::uint32_t>(model.radios.size()));
    };
    link.receiver = number(link.receiver);
    link.transmitter = number(link.transmitter);
    if (link.receiver == link.transmitter) ++link.receiver;
    links.push_back(link);
  }
  std::vector<SignalPrediction> predictions(links.size());
  About(command.pairs, [&] {
    model.predictor->Predict(links, {predictions.data(), predictions.size()});
    return 0;
  });
  std::string text = "time,receiver,transmitter,dbm,sigma_db\n";
  for (std::size_t i = 0; i < links.size(); ++i) {
    const SignalLink& asked = log.measurements[i].link;
    AppendNumber(&text, links[i].time_s);
    text += "," + log.radios[asked.receiver] + "," + log.radios[asked.transmitter] +
            fmt::format(",{:.3f},{:.3f}\n", predictions[i].dbm, predictions[i].sigma_db);
  }
  if (command.output.empty())
    fmt::print("{}", text);
  else
    WriteFile(command.output, text);
  if (log.measurements.front().is_heard) SayHowFar(command.pairs, log, predictions, console);
}

}  // namespace

int Run(const SignalPredictCommand& command, const Console& console) {
  if (command.pairs.empty() == command.map_of.empty())
    throw Error("signal predict: either --pairs FILE, or --from X,Y --map-of OUT",
                ErrorKind::kUsage);
  if (!command.map_of.empty() && (command.from.empty() || command.map.empty()))
    throw Error("--map-of goes with --from and --map", ErrorKind::kUsage);
  if (!command.from.empty()) PlaceOf(command.from);
  ExpectWritable(command.output);
  if (!command.map_of.empty()) ExpectWritable(command.map_of + ".png");
  const SignalModel model = LoadSignalModel(command.model, command.map);
  if (command.pairs.empty())
    return PredictEverywhere(command, model, *LoadMap(command.map), console);
  PredictPairs(command, model, console);
  return kDone;
}

int Run(const SignalDrawCommand& command, const Console&) {
  ExpectEnding(command.output, "--output", {".png", ".svg"});
  ExpectWritable(command.output);
  const SignalModel model = LoadSignalModel(command.model, command.map);
  if (model.fitted == nullptr || model.fitted->Options().classes.empty())
    throw Error(command.model + ": a model of " + model.method + " has no attenuation to draw",
                ErrorKind::kUsage);
  if (command.map.empty())
    throw Error("--map: the attenuation is drawn over a map", ErrorKind::kUsage);
  const std::shared_ptr<const OccupancyGrid> map = LoadMap(command.map);
  const TomographyOptions& options = model.fitted->Options();
  const Extent extent = ExtentOf(*map);
  const double longer = std::max(extent.x1 - extent.x0, extent.y1 - extent.y0);
  std::vector<HeatField> fields;
  for (std::size_t c = 0; c < options.classes.size(); ++c) {
    HeatField field = FieldOver(extent, std::max(longer / 160, map->resolution));
    for (std::size_t y = 0; y < field.height; ++y)
      for (std::size_t x = 0; x < field.width; ++x) {
        const Eigen::Vector3d at = CentreOf(field, x, y, 0);
        field.values[y * field.width + x] =
            model.fitted->AttenuationAt(static_cast<std::uint32_t>(c), at.x(), at.y());
      }
    field.title = fmt::format("{}: attenuation of {}", model.method, options.classes[c].name);
    field.unit = "dB/m";
    field.low_is_good = true;
    fields.push_back(std::move(field));
  }
  const std::string svg = DrawHeat(fields, map.get(), {});
  WriteFile(command.output, Ending(command.output) == ".svg" ? svg : PngFromSvg(svg, 1400));
  return kDone;
}

}  // namespace graticule::apps
