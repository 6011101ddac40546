#include <algorithm>

#include "graticule/solver/diagnose.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/union_find.hpp"

namespace graticule {
namespace {

constexpr std::uint32_t kNoPiece = 0xffffffffu;

}  // namespace

Structure AnalyseStructure(const Graph& graph) {
  const std::size_t count = graph.VariableCount();
  UnionFind sets(count);
  std::vector<std::uint32_t> residuals(count, 0);
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    for (const VariableId variable : factor.variables) {
      sets.Join(variable, factor.variables[0]);
      residuals[variable] += static_cast<std::uint32_t>(graph.ResidualSize(id));
    }
  }

  Structure structure;
  std::vector<std::uint32_t> piece_of(count, kNoPiece);  // by root
  for (const VariableId id : graph.KeyOrder()) {
    if (residuals[id] == 0) {
      if (!graph.IsFixed(id)) structure.isolated.push_back(id);
      continue;
    }
    const VariableId root = sets.Root(id);
    if (piece_of[root] == kNoPiece) {
      piece_of[root] = static_cast<std::uint32_t>(structure.pieces.size());
      structure.pieces.emplace_back();
      structure.pieces.back().first = structure.pieces.back().anchor = id;
    }
    Structure::Piece& piece = structure.pieces[piece_of[root]];
    ++piece.variables;
    piece.has_fixed |= graph.IsFixed(id);
    if (graph.TypeOf(id).TangentSize() > graph.TypeOf(piece.anchor).TangentSize())
      piece.anchor = id;
    if (!graph.IsFixed(id) &&
        residuals[id] < static_cast<std::uint32_t>(graph.TypeOf(id).TangentSize()))
      structure.starved.push_back(id);
  }
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    Structure::Piece& piece = structure.pieces[piece_of[sets.Root(factor.variables[0])]];
    ++piece.factors;
    piece.has_absolute |= !factor.type->IsRelative();
  }
  return structure;
}

std::vector<VariableId> ChooseAnchors(const Graph& graph, const Structure& structure,
                                      bool allow_pieces) {
  std::vector<VariableId> anchors;
  if (!structure.isolated.empty()) {
    if (!allow_pieces)
      throw Error("no factor touches " + graph.KeyOf(structure.isolated[0]).ToString() +
                      (structure.isolated.size() > 1
                           ? " (and " + std::to_string(structure.isolated.size() - 1) + " more)"
                           : "") +
                      "; allow_pieces=true leaves such variables as they are",
                  ErrorKind::kIllPosed);
    anchors = structure.isolated;
  }
  std::vector<const Structure::Piece*> loose;
  for (const Structure::Piece& piece : structure.pieces)
    if (piece.IsLoose()) loose.push_back(&piece);
  if (!loose.empty() && structure.pieces.size() > 1 && !allow_pieces) {
    std::string text = "the graph is in " + std::to_string(structure.pieces.size()) +
                       " pieces that no factor joins, and nothing says where they are:";
    for (std::size_t i = 0; i < std::min<std::size_t>(loose.size(), 4); ++i)
      text += (i ? ", " : " ") + graph.KeyOf(loose[i]->first).ToString() + " with " +
              std::to_string(loose[i]->variables - 1) + " others";
    if (loose.size() > 4) text += ", ...";
    throw Error(text + "; allow_pieces=true solves each by itself", ErrorKind::kIllPosed);
  }
  for (const Structure::Piece* piece : loose) anchors.push_back(piece->anchor);
  std::sort(anchors.begin(), anchors.end(),
            [&](VariableId a, VariableId b) { return graph.KeyOf(a) < graph.KeyOf(b); });
  return anchors;
}

}  // namespace graticule
