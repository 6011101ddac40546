#include <set>
#include <utility>

#include "graticule/io/id_table.hpp"
#include "graticule/io/information_guard.hpp"
#include "graticule/io/skipped_tags.hpp"
#include "graticule/io/toro.hpp"
#include "graticule/io/toro_angles.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/rotation.hpp"

namespace graticule {
namespace {

constexpr const char* kPlaneFields[] = {"x", "y", "the yaw"};
constexpr const char* kSpaceFields[] = {"x", "y", "z", "the roll", "the pitch", "the yaw"};

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, const Registry& types,
         const ReadOptions& options)
      : reader_(text, name),
        recording_(types),
        ids_(text.size()),
        skipped_(options.skip_unknown),
        guard_(options.repair_information) {}

  // Edges are read last: vertices and EQUIV, which names their source, may follow them.
  Recording Read() {
    while (reader_.NextLine()) ReadLine();
    skipped_.Finish(reader_, "TORO", &recording_);
    make_vertices_ = ids_.Empty() && !edges_.empty();
    if (make_vertices_) {
      recording_.has_initial_guess = false;
      recording_.notes.push_back(
          "the file has no vertices: they were made from its edges, without an initial guess");
    }
    recording_.graph.Reserve(recording_.graph.VariableCount(), edges_.size());
    for (const std::size_t place : edges_) ReadEdge(place);
    for (const std::size_t place : equivalences_) CheckEquivalence(place);
    if (recording_.graph.VariableCount() == 0)
      reader_.FailAt(0, reader_.Size() == 0 ? "the file is empty"
                                            : "there is no vertex and no edge in this TORO file");
    guard_.Finish(reader_, &recording_);
    NamePoseSources(&recording_.graph);
    return std::move(recording_);
  }

 private:
  void ReadLine() {
    const std::string_view word = reader_.Word();
    if (word == "EDGE2" || word == "EDGE3" || word == "EDGE") {
      edges_.push_back(reader_.WordOffset());
    } else if (word == "VERTEX2" || word == "VERTEX") {
      ReadVertex(false);
    } else if (word == "VERTEX3") {
      ReadVertex(true);
    } else if (word == "EQUIV") {
      equivalences_.push_back(reader_.WordOffset());
      const std::uint64_t a = reader_.Integer("the id of a vertex");
      const std::uint64_t b = reader_.Integer("the id of a second vertex");
      reader_.ExpectEnd();
      equivalent_.emplace(std::min(a, b), std::max(a, b));
    } else if (word[0] == '#') {
      ReadComment(word);
    } else {
      skipped_.Add(word, reader_.WordOffset());
    }
  }

  void ReadComment(std::string_view word) {
    if (word == "#") word = reader_.Word();
    if (word == "graticule-key") keys_.Read(&reader_, ids_);
    if (word == "graticule-initial-guess") recording_.has_initial_guess = false;
  }

  void ReadVertex(bool space) {
    const std::uint64_t id = reader_.Integer("the id of the vertex");
    const VariableId there = ids_.Find(id);
    if (there != Layout::kNone)
      reader_.Fail("vertex " + std::to_string(id) + " is there already, from line " +
                   std::to_string(reader_.LineNumber(ids_.Offset(there))));
    double value[7];
    ReadPose(space, value);
    reader_.ExpectEnd();
    AddVertex(space, id, value);
  }

  void ReadPose(bool space, double* value) {
    if (!space) {
      for (int i = 0; i < 3; ++i) value[i] = reader_.Double(kPlaneFields[i]);
      return;
    }
    double angles[3];
    for (int i = 0; i < 3; ++i) value[i] = reader_.Double(kSpaceFields[i]);
    for (int i = 0; i < 3; ++i) angles[i] = reader_.Double(kSpaceFields[3 + i]);
    QuaternionFromAngles(angles, value + 3);
    NormaliseQuaternion(value + 3);
  }

  VariableId AddVertex(bool space, std::uint64_t id, const double* value) {
    Graph& graph = recording_.graph;
    try {
      const VariableId variable =
          graph.Add(keys_.KeyOf(id, "pose"), graph.VariableTypeId(space ? "se3/1" : "se2/1"),
                    {value, static_cast<std::size_t>(space ? 7 : 3)}, false);
      ids_.Define(id, variable, reader_.LineOffset());
      return variable;
    } catch (const Error& error) {
      RethrowAt(reader_, reader_.LineOffset(), error);
    }
  }

  VariableId VertexOf(bool space, std::uint64_t id) {
    const VariableId variable = ids_.Find(id);
    if (variable != Layout::kNone) return variable;
    if (!make_vertices_) reader_.Fail("there is no vertex " + std::to_string(id) + " in this file");
    const double identity[7] = {0, 0, 0, 0, 0, 0, 1};
    return AddVertex(space, id, identity);
  }

  void ReadEdge(std::size_t place) {
    reader_.Seek(place);
    const bool space = reader_.Word() == "EDGE3";
    VariableId variables[2];
    const std::uint64_t a = reader_.Integer("the id of the edge's vertex");
    variables[0] = VertexOf(space, a);
    const std::uint64_t b = reader_.Integer("the id of the edge's second vertex");
    variables[1] = VertexOf(space, b);
    double measurement[7];
    ReadPose(space, measurement);
    double line[21], information[21];
    const int entries = space ? 21 : 6;
    for (int i = 0; i < entries; ++i)
      line[i] = reader_.Double("an entry of the information matrix");
    for (int i = 0; i < entries; ++i) information[i] = line[space ? i : kToroOrder[i]];
    reader_.ExpectEnd();

    const bool equivalent =
        !equivalent_.empty() && equivalent_.count({std::min(a, b), std::max(a, b)}) > 0;
    Graph& graph = recording_.graph;
    try {
      const auto type = graph.FactorTypeId(space ? "between_se3/1" : "between_se2/1");
      guard_.Try({NoiseKind::kInformation, {information, static_cast<std::size_t>(entries)}}, place,
                 [&](NoiseView noise) {
                   graph.Add(type, {variables, 2},
                             {measurement, static_cast<std::size_t>(space ? 7 : 3)}, noise, Loss(),
                             equivalent ? "equiv" : "");
                 });
    } catch (const Error& error) {
      RethrowAt(reader_, place, error);
    }
  }

  void CheckEquivalence(std::size_t place) {
    reader_.Seek(place);
    reader_.Word();
    for (int i = 0; i < 2; ++i) {
      const std::uint64_t id = reader_.Integer(nullptr);
      if (ids_.Find(id) == Layout::kNone)
        reader_.Fail("there is no vertex " + std::to_string(id) + " in this file");
    }
  }

  TextReader reader_;
  Recording recording_;
  IdTable ids_;
  KeyComments keys_;
  SkippedTags skipped_;
  InformationGuard guard_;
  bool make_vertices_ = false;
  std::vector<std::size_t> edges_, equivalences_;
  std::set<std::pair<std::uint64_t, std::uint64_t>> equivalent_;
};

}  // namespace

Recording ParseToro(std::string_view text, const std::string& name, const Registry& types,
                    const ReadOptions& options) {
  return Reader(text, name, types, options).Read();
}

}  // namespace graticule
