#include "graticule/solver/check.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/solver/diagnose.hpp"
#include "problem.hpp"

namespace graticule::apps {
namespace {

std::string Keys(const Graph& graph, FactorId id) {
  std::string text;
  for (const Key& key : graph.FactorRecord(id).keys)
    text += (text.empty() ? "" : " ") + key.ToString();
  return text;
}

}  // namespace

int Run(const CheckCommand& command, const Console& console) {
  Recording recording = Load(command.file, command.reading, LoadTypes(command.reading), console);
  Graph& graph = recording.graph;
  Initialise(&graph, InitialGuess::kAutomatic, recording.has_initial_guess);
  nlohmann::ordered_json json;
  json["file"] = command.file;
  json["repaired_information"] = nlohmann::ordered_json::parse(RepairedJson(recording.repaired));
  int exit = kDone;
  if (recording.repaired && !command.json)
    fmt::print("repaired   {}\n", ToString(*recording.repaired));

  const std::vector<JacobianCheck> checks = About(command.file, [&] {
    return CheckJacobians(graph, graph.InitialValues(), command.tolerance);
  });
  json["jacobians"] = nlohmann::ordered_json::array();
  for (const JacobianCheck& check : checks) {
    json["jacobians"].push_back({{"type", check.type},
                                 {"checked", check.checked},
                                 {"wrong", check.wrong},
                                 {"failed", check.failed},
                                 {"worst", check.worst},
                                 {"worst_factor", check.worst_factor},
                                 {"worst_keys", Keys(graph, check.worst_factor)},
                                 {"worst_row", check.worst_row},
                                 {"worst_block", check.worst_block},
                                 {"worst_field", check.worst_field},
                                 {"analytic", check.analytic},
                                 {"numeric", check.numeric},
                                 {"failure", check.failure}});
    if (check.wrong > 0 || check.failed > 0) exit = kOtherFailure;
    if (command.json) continue;
    fmt::print("jacobian   {:<28} {} checked, {} wrong, {} failed, worst disagreement {:.2g}\n",
               check.type, check.checked, check.wrong, check.failed, check.worst);
    if (check.wrong > 0)
      fmt::print(
          "           factor {} ({}): d residual[{}] / d {}.{} is {:.9g}, differences say {:.9g}\n",
          check.worst_factor, Keys(graph, check.worst_factor), check.worst_row, check.worst_block,
          check.worst_field, check.analytic, check.numeric);
    if (check.failed > 0) fmt::print("           {}\n", check.failure);
  }

  // Structure and rank count more than a Jacobian: their exit code wins.
  const Structure structure = AnalyseStructure(graph);
  std::string trouble, anchors;
  try {
    const std::vector<VariableId> held = ChooseAnchors(graph, structure, false);
    for (const VariableId id : held) anchors += " " + graph.KeyOf(id).ToString();
    if (exit == kDone) {
      const Diagnosis diagnosis = Diagnose(graph, graph.InitialValues(), held);
      if (diagnosis.free_directions > 0) trouble = diagnosis.summary;
    }
  } catch (const graticule::Error& error) {
    trouble = error.what();
  }
  json["pieces"] = structure.pieces.size();
  json["anchors"] = anchors;
  json["trouble"] = trouble;
  if (!command.json) {
    fmt::print("structure  {} pieces, {} isolated, {} starved{}\n", structure.pieces.size(),
               structure.isolated.size(), structure.starved.size(),
               anchors.empty() ? "" : "; solve would hold" + anchors);
    fmt::print("rank       {}\n", !trouble.empty() ? trouble
                                  : exit == kDone  ? "full"
                                                   : "not looked at: the Jacobians are wrong");
  } else {
    fmt::print("{}\n", JsonText(json, 1));
  }
  if (!trouble.empty()) {
    console.Error(command.file + ": " + trouble);
    return kIllPosed;
  }
  if (exit != kDone) console.Error(command.file + ": a Jacobian disagrees with differences");
  return exit;
}

}  // namespace graticule::apps
