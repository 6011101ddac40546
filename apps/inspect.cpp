#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/solver/diagnose.hpp"
#include "problem.hpp"
#include "structure_json.hpp"

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

Json Families(const Graph& graph) {
  struct Range {
    std::size_t count = 0;
    std::uint64_t first = 0, last = 0;
    std::string type;
  };
  std::map<std::string, Range> families;
  for (const VariableId id : graph.KeyOrder()) {
    const Key& key = graph.KeyOf(id);
    Range& range = families[std::string(key.Family())];
    if (range.count++ == 0) range.first = key.Number();
    range.last = key.Number();
    const std::string& type = graph.TypeOf(id).name;
    if (range.type.find(type) == std::string::npos)
      range.type += (range.type.empty() ? "" : " ") + type;
  }
  Json json = Json::array();
  for (const auto& [family, range] : families)
    json.push_back({{"family", family},
                    {"type", range.type},
                    {"count", range.count},
                    {"first", range.first},
                    {"last", range.last}});
  return json;
}

Json Factors(const Graph& graph) {
  struct Row {
    std::size_t factors = 0, residuals = 0, losses = 0;
    std::string schema;
  };
  std::map<std::pair<std::string, std::string>, Row> rows;
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    Row& row = rows[{factor.type->name, std::string(factor.source)}];
    ++row.factors;
    row.residuals += static_cast<std::size_t>(graph.ResidualSize(id));
    row.losses += factor.loss.kind != LossKind::kNone;
    row.schema = ToString(factor.type->schema);
  }
  Json json = Json::array();
  for (const auto& [name, row] : rows)
    json.push_back({{"type", name.first},
                    {"source", name.second},
                    {"count", row.factors},
                    {"residuals", row.residuals},
                    {"with_loss", row.losses},
                    {"schema", row.schema}});
  return json;
}

// The rank where it can be found: types must be known, the structure sound.
Json Rank(const Graph& graph, const Structure& structure) {
  Json json;
  try {
    const Diagnosis diagnosis =
        Diagnose(graph, graph.InitialValues(), ChooseAnchors(graph, structure, true));
    json["free_directions"] = diagnosis.free_directions;
    json["at_least"] = diagnosis.at_least;
    json["summary"] =
        diagnosis.free_directions ? diagnosis.summary : "full, once the anchors are held";
    for (const auto& loose : diagnosis.loose)
      if (json["loose"].size() < 100)
        json["loose"].push_back({{"key", loose.key.ToString()}, {"fields", loose.fields}});
  } catch (const graticule::Error& error) {
    json["summary"] = std::string("not known: ") + error.what();
  }
  return json;
}

void Print(const Json& json) {
  fmt::print("{}\n", json["file"].get<std::string>());
  for (const char* name : {"title", "made_by", "solved_by", "frames"})
    if (!json[name].get<std::string>().empty())
      fmt::print("  {:<10} {}\n", name, json[name].get<std::string>());
  fmt::print("  variables  {} ({} fixed), {} numbers\n", json["variables"].get<std::size_t>(),
             json["fixed"].get<std::size_t>(), json["numbers"].get<std::size_t>());
  for (const auto& row : json["families"])
    fmt::print("             {} {}  {}:{} .. {}:{}\n", row["count"].get<std::size_t>(),
               row["type"].get<std::string>(), row["family"].get<std::string>(),
               row["first"].get<std::uint64_t>(), row["family"].get<std::string>(),
               row["last"].get<std::uint64_t>());
  fmt::print("  factors    {}, {} residuals\n", json["factors"].get<std::size_t>(),
             json["residuals"].get<std::size_t>());
  for (const auto& row : json["factor_types"])
    fmt::print(
        "             {} {}{}{}  [{}]\n", row["count"].get<std::size_t>(),
        row["type"].get<std::string>(),
        row["source"].get<std::string>().empty() ? "" : ", " + row["source"].get<std::string>(),
        row["with_loss"].get<std::size_t>() ? ", with a loss" : "",
        row["schema"].get<std::string>());
  fmt::print("  values     {}\n", json["has_initial_guess"].get<bool>()
                                      ? "from the file"
                                      : "placeholders: none in the file");
  fmt::print("  pieces     {}\n", json["pieces"].size());
  std::size_t shown = 0;
  for (const auto& piece : json["pieces"]) {
    if (shown++ == 10) {
      fmt::print("             ...\n");
      break;
    }
    const std::string anchor = piece["anchor"].get<std::string>();
    fmt::print("             {} and {} others, held by {}{}\n", piece["first"].get<std::string>(),
               piece["variables"].get<std::size_t>() - 1, piece["held_by"].get<std::string>(),
               anchor.empty() ? "" : "; solve would hold " + anchor);
  }
  if (!json["isolated"].empty())
    fmt::print("  isolated   {} variables without a factor, {} first\n", json["isolated"].size(),
               json["isolated"][0].get<std::string>());
  if (!json["starved"].empty())
    fmt::print("  starved    {} variables with fewer residuals than degrees of freedom, {} first\n",
               json["starved"].size(), json["starved"][0].get<std::string>());
  fmt::print("  rank       {}\n", json["rank"]["summary"].get<std::string>());
}

}  // namespace

int Run(const InspectCommand& command, const Console& console) {
  const Recording recording =
      Load(command.file, command.reading, LoadTypes(command.reading), console);
  const Graph& graph = recording.graph;
  const Structure structure = AnalyseStructure(graph);
  Json json;
  json["file"] = command.file;
  json["title"] = recording.title;
  json["made_by"] = recording.made_by;
  json["solved_by"] = recording.solved_by;
  json["frames"] = recording.frames;
  json["has_initial_guess"] = recording.has_initial_guess;
  json["repaired_information"] = Json::parse(RepairedJson(recording.repaired));
  std::size_t fixed = 0, residuals = 0;
  for (VariableId id = 0; id < graph.VariableCount(); ++id) fixed += graph.IsFixed(id);
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    residuals += static_cast<std::size_t>(graph.ResidualSize(id));
  json["variables"] = graph.VariableCount();
  json["fixed"] = fixed;
  json["numbers"] = graph.InitialValues().Data().size();
  json["families"] = Families(graph);
  json["factors"] = graph.FactorCount();
  json["residuals"] = residuals;
  json["factor_types"] = Factors(graph);
  json.update(StructureJson(graph, structure));
  json["rank"] = Rank(graph, structure);
  if (command.json) {
    fmt::print("{}\n", JsonText(json, 1));
  } else {
    Print(json);
    if (recording.repaired) fmt::print("  repaired   {}\n", ToString(*recording.repaired));
  }
  return kDone;
}

}  // namespace graticule::apps
