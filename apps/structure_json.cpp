#include "structure_json.hpp"

#include <nlohmann/json.hpp>

namespace graticule::apps {
namespace {

using Json = nlohmann::ordered_json;

Json Pieces(const Graph& graph, const Structure& structure) {
  Json json = Json::array();
  for (const Structure::Piece& piece : structure.pieces)
    json.push_back({{"first", graph.KeyOf(piece.first).ToString()},
                    {"variables", piece.variables},
                    {"factors", piece.factors},
                    {"held_by", piece.has_fixed      ? "a fixed variable"
                                : piece.has_absolute ? "factors that may be absolute"
                                                     : "nothing"},
                    {"anchor", piece.IsLoose() ? graph.KeyOf(piece.anchor).ToString() : ""}});
  return json;
}

Json Keys(const Graph& graph, const std::vector<VariableId>& ids) {
  Json list = Json::array();
  for (const VariableId id : ids) list.push_back(graph.KeyOf(id).ToString());
  return list;
}

}  // namespace

Json StructureJson(const Graph& graph, const Structure& structure) {
  return {{"pieces", Pieces(graph, structure)},
          {"isolated", Keys(graph, structure.isolated)},
          {"starved", Keys(graph, structure.starved)}};
}

}  // namespace graticule::apps
