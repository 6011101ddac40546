#include "graticule/io/bal.hpp"

#include <algorithm>

#include "graticule/io/id_table.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kCameraSize = 9, kPointSize = 3;
constexpr const char* kCameraFields[kCameraSize] = {
    "rx of the camera", "ry of the camera", "rz of the camera",
    "tx of the camera", "ty of the camera", "tz of the camera",
    "f of the camera",  "k1 of the camera", "k2 of the camera"};
constexpr const char* kPointFields[kPointSize] = {"x of the point", "y of the point",
                                                  "z of the point"};

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, const Registry& types)
      : reader_(text, name), recording_(types) {}

  Recording Read() {
    Graph& graph = recording_.graph;
    if (!reader_.NextWord()) reader_.FailAt(0, "the file is empty");
    const std::size_t start = reader_.Offset();
    const std::uint64_t cameras = Integer("the number of cameras");
    const std::uint64_t points = Integer("the number of points");
    const std::uint64_t observations = Integer("the number of observations");
    // A number takes two bytes at least: more than the file can hold need not be allocated.
    const std::uint64_t most = reader_.Size() / 2 + 1;
    if (cameras > most / kCameraSize || points > most / kPointSize || observations > most / 4)
      reader_.FailAt(start, "the file is too short for " + std::to_string(cameras) + " cameras, " +
                                std::to_string(points) + " points and " +
                                std::to_string(observations) + " observations");
    graph.Reserve(cameras + points, observations);
    // Observations come first in the file, and name what follows.
    reader_.NextWord();
    const std::size_t first = reader_.Offset();
    for (std::uint64_t i = 0; i < observations; ++i) ReadObservation(cameras, points, nullptr);
    ReadVariables("camera", "bal_camera/1", cameras, {kCameraFields, kCameraSize});
    ReadVariables("point", "point3/1", points, {kPointFields, kPointSize});
    if (reader_.NextWord()) {
      reader_.Word();
      reader_.FailExpected("the end of the file", "after the last point");
    }
    reader_.Seek(first);
    for (std::uint64_t i = 0; i < observations; ++i) ReadObservation(cameras, points, &graph);
    return std::move(recording_);
  }

 private:
  // The format is a stream of numbers: line ends mean nothing.
  std::uint64_t Integer(const char* what) {
    reader_.NextWord();
    return reader_.Integer(what);
  }
  double Double(const char* what) {
    reader_.NextWord();
    return reader_.Double(what);
  }
  std::uint64_t Index(std::uint64_t count, const char* what) {
    const std::uint64_t index = Integer(what);
    if (index >= count)
      reader_.Fail("expected " + std::string(what) + " below " + std::to_string(count) +
                   ", found " + std::to_string(index));
    return index;
  }

  void ReadVariables(const char* family, const char* type, std::uint64_t count,
                     Span<const char* const> fields) {
    double value[kCameraSize];
    for (std::uint64_t i = 0; i < count; ++i) {
      reader_.NextWord();
      const std::size_t place = reader_.Offset();
      for (std::size_t k = 0; k < fields.size(); ++k) value[k] = Double(fields[k]);
      try {
        recording_.graph.Add(Key(family, i), recording_.graph.VariableTypeId(type),
                             {value, fields.size()}, false);
      } catch (const Error& error) {
        RethrowAt(reader_, place, error);
      }
    }
  }

  // Twice: checked on the way to the variables (graph null), then added.
  void ReadObservation(std::uint64_t cameras, std::uint64_t points, Graph* graph) {
    reader_.NextWord();
    const std::size_t place = reader_.Offset();
    const std::uint64_t camera = Index(cameras, "the number of a camera");
    const std::uint64_t point = Index(points, "the number of a point");
    const double pixel[2] = {Double("u of the observation"), Double("v of the observation")};
    if (!graph) return;
    const VariableId variables[2] = {static_cast<VariableId>(camera),
                                     static_cast<VariableId>(cameras + point)};
    try {
      graph->Add(graph->FactorTypeId("bal_reprojection/1"), {variables, 2}, {pixel, 2}, {}, Loss(),
                 "observation");
    } catch (const Error& error) {
      RethrowAt(reader_, place, error);
    }
  }

  TextReader reader_;
  Recording recording_;
};

bool IsUnit(NoiseView noise) {
  if (noise.kind == NoiseKind::kInformation)
    return noise.values[0] == 1 && noise.values[1] == 0 && noise.values[2] == 1;
  return std::all_of(noise.values.begin(), noise.values.end(), [](double x) { return x == 1; });
}

void Check(const Graph& graph, std::vector<std::string>* notes) {
  std::size_t losses = 0, fixed = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    if (factor.type->name != "bal_reprojection/1")
      throw Error("BAL has observations of points by cameras only, not " + factor.type->name +
                  "; write .fg");
    if (!IsUnit(factor.noise))
      throw Error(
          "BAL has no noise: every observation counts alike, and those of this graph do "
          "not; write .fg");
    losses += factor.loss.kind != LossKind::kNone;
  }
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const std::string& type = graph.TypeOf(id).name;
    if (type != "bal_camera/1" && type != "point3/1")
      throw Error("BAL has cameras and points only, not " + type + " (" +
                  graph.KeyOf(id).ToString() + "); write .fg");
    fixed += graph.IsFixed(id);
  }
  if (losses)
    notes->push_back("BAL has no losses: those of " + std::to_string(losses) +
                     " observations are not in the file");
  if (fixed)
    notes->push_back("BAL cannot hold variables fixed: " + std::to_string(fixed) +
                     " are free in the file");
}

}  // namespace

Recording ParseBal(std::string_view text, const std::string& name, const Registry& types) {
  return Reader(text, name, types).Read();
}

std::string FormatBal(const Recording& recording, std::vector<std::string>* notes) {
  const Graph& graph = recording.graph;
  Check(graph, notes);
  std::vector<std::uint64_t> numbers(graph.VariableCount());
  std::uint64_t counts[2] = {};
  std::string values[2];
  bool renamed = false;
  for (const VariableId id : graph.KeyOrder()) {
    const std::size_t kind = graph.TypeOf(id).name == "point3/1";
    numbers[id] = counts[kind]++;
    renamed |= !(graph.KeyOf(id) == Key(kind ? "point" : "camera", numbers[id]));
    for (const double value : graph.ValueOf(id)) {
      AppendNumber(&values[kind], value);
      values[kind] += '\n';
    }
  }
  if (renamed) notes->push_back("BAL has no keys: cameras and points are numbered in key order");
  std::string text = std::to_string(counts[0]) + ' ' + std::to_string(counts[1]) + ' ' +
                     std::to_string(graph.FactorCount()) + '\n';
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    AppendInteger(&text, numbers[factor.variables[0]]);
    text += ' ';
    AppendInteger(&text, numbers[factor.variables[1]]);
    for (const double pixel : factor.measurement) {
      text += ' ';
      AppendNumber(&text, pixel);
    }
    text += '\n';
  }
  return text + values[0] + values[1];
}

}  // namespace graticule
