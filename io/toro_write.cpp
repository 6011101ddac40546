#include <map>

#include "graticule/io/id_table.hpp"
#include "graticule/io/information.hpp"
#include "graticule/io/toro.hpp"
#include "graticule/io/toro_angles.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

bool IsSpace(Span<const double> pose) { return pose.size() == 7; }

void AppendNumbers(const double* numbers, std::size_t count, std::string* text) {
  for (std::size_t i = 0; i < count; ++i) {
    *text += ' ';
    AppendNumber(text, numbers[i]);
  }
}

void AppendPose(Span<const double> pose, std::string* text) {
  AppendNumbers(pose.data(), 3, text);
  if (!IsSpace(pose)) return;
  double angles[3];
  AnglesFromQuaternion(pose.data() + 3, angles);
  AppendNumbers(angles, 3, text);
}

void RefuseOthers(const Graph& graph) {
  std::map<std::string, std::size_t> refused;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const std::string& type = graph.FactorAt(id).type->name;
    if (type != "between_se2/1" && type != "between_se3/1") ++refused[type];
  }
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const std::string& type = graph.TypeOf(id).name;
    if (type != "se2/1" && type != "se3/1") ++refused[type];
  }
  if (refused.empty()) return;
  std::string list;
  for (const auto& [type, count] : refused)
    list += (list.empty() ? "" : ", ") + type + " (" + std::to_string(count) + ")";
  throw Error("TORO has only poses and the edges between them, not " + list + "; write .fg");
}

void AppendNotes(const Graph& graph, std::vector<std::string>* notes) {
  std::size_t losses = 0, fixed = 0;
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    losses += graph.FactorAt(id).loss.kind != LossKind::kNone;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) fixed += graph.IsFixed(id);
  if (losses)
    notes->push_back("TORO has no losses: those of " + std::to_string(losses) +
                     " factors are not in the file");
  if (fixed)
    notes->push_back("TORO cannot hold variables fixed: " + std::to_string(fixed) +
                     " are free in the file");
}

}  // namespace

std::string FormatToro(const Recording& recording, std::vector<std::string>* notes) {
  const Graph& graph = recording.graph;
  RefuseOthers(graph);
  AppendNotes(graph, notes);
  std::string text;
  if (!recording.has_initial_guess) text += "# graticule-initial-guess none\n";
  const std::vector<std::string_view> families(graph.UsedVariableTypes().size(), "pose");
  const std::vector<std::uint64_t> ids = AssignIds(graph, families, &text);
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    text += IsSpace(graph.ValueOf(id)) ? "VERTEX3 " : "VERTEX2 ";
    AppendInteger(&text, ids[id]);
    AppendPose(graph.ValueOf(id), &text);
    text += '\n';
  }
  std::string equivalences;
  std::vector<double> information;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const bool space = IsSpace(factor.measurement);
    std::string pair;
    for (const VariableId variable : factor.variables) {
      pair += ' ';
      AppendInteger(&pair, ids[variable]);
    }
    text += (space ? "EDGE3" : "EDGE2") + pair;
    AppendPose(factor.measurement, &text);
    InformationOf(factor.noise, space ? 6 : 3, &information);
    double line[21];
    for (std::size_t i = 0; i < information.size(); ++i)
      line[space ? static_cast<int>(i) : kToroOrder[i]] = information[i];
    AppendNumbers(line, information.size(), &text);
    text += '\n';
    if (factor.source == "equiv") equivalences += "EQUIV" + pair + "\n";
  }
  return text + equivalences;
}

}  // namespace graticule
