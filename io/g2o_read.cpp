#include <algorithm>
#include <array>
#include <unordered_map>

#include "graticule/io/g2o.hpp"
#include "graticule/io/g2o_tags.hpp"
#include "graticule/io/id_table.hpp"
#include "graticule/io/information_guard.hpp"
#include "graticule/io/skipped_tags.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr const char* kVertexFields[] = {
    "the x of the vertex",  "the y of the vertex",  "the z of the vertex", "the qx of the vertex",
    "the qy of the vertex", "the qz of the vertex", "the qw of the vertex"};
constexpr const char* kMeasuredFields[] = {"the measured x",  "the measured y",  "the measured z",
                                           "the measured qx", "the measured qy", "the measured qz",
                                           "the measured qw"};
constexpr const char* kOffsetFields[] = {
    "the x of the offset",  "the y of the offset",  "the z of the offset", "the qx of the offset",
    "the qy of the offset", "the qz of the offset", "the qw of the offset"};
constexpr double kIdentity[kOffsetSize] = {0, 0, 0, 0, 0, 0, 1};
constexpr std::size_t kTypicalLine = 64;  // for reserving; not a limit

class Reader {
 public:
  Reader(std::string_view text, const std::string& name, const Registry& types,
         const ReadOptions& options)
      : reader_(text, name),
        recording_(types),
        options_(options),
        ids_(text.size()),
        skipped_(options.skip_unknown),
        guard_(options.repair_information),
        rotation_(options.rotation.value_or(G2oRotation::kHalf)) {
    for (auto& type : edge_types_) type = kNoType;
    for (auto& type : vertex_types_) type = kNoType;
    recording_.graph.Reserve(text.size() / kTypicalLine, text.size() / kTypicalLine);
  }

  Recording Read() {
    while (reader_.NextLine()) ReadLine();
    skipped_.Finish(reader_, "g2o", &recording_);
    ReadDeferred();
    for (const std::size_t place : fixes_) ReadFix(place);
    if (recording_.graph.VariableCount() == 0)
      reader_.FailAt(0, reader_.Size() == 0 ? "the file is empty"
                                            : "there is no vertex and no edge in this g2o file");
    guard_.Finish(reader_, &recording_);
    if (rotation_used_) recording_.g2o_rotation = rotation_;
    NamePoseSources(&recording_.graph);
    return std::move(recording_);
  }

 private:
  static constexpr int kNoType = -1;
  using Offset = std::array<double, kOffsetSize>;

  void ReadLine() {
    const std::string_view word = reader_.Word();
    if (word == kEdgeTags[last_edge_].tag) return ReadEdge(last_edge_);
    if (word[0] == '#') return ReadComment(word);
    for (std::size_t i = 0; i < kVertexTagCount; ++i)
      if (word == kVertexTags[i].tag) return ReadVertex(i);
    for (std::size_t i = 0; i < kEdgeTagCount; ++i)
      if (word == kEdgeTags[i].tag) return ReadEdge(last_edge_ = i);
    if (word == "FIX") {
      fixes_.push_back(reader_.WordOffset());
    } else if (word == "PARAMS_SE3OFFSET") {
      ReadOffset();
    } else if (word == "ROBOTLASER1" && options_.pass_over_sweeps) {
      return;
    } else {
      skipped_.Add(word, reader_.WordOffset());
    }
  }

  // `# graticule-... `; any other comment is for people.
  void ReadComment(std::string_view word) {
    if (word == "#") word = reader_.Word();
    if (word == "graticule-key") {
      keys_.Read(&reader_, ids_);
    } else if (word == "graticule-rotation") {
      const auto rotation = G2oRotationFromWord(reader_.Word("the reading of rotations"));
      if (!rotation) reader_.FailExpected("'half', 'double' or 'full'", nullptr);
      if (rotation_used_) reader_.Fail("the reading of rotations must come before the edges");
      if (!options_.rotation) rotation_ = *rotation;
      reader_.ExpectEnd();
    } else if (word == "graticule-initial-guess") {
      if (!reader_.Accept("none")) {
        reader_.Word();
        reader_.FailExpected("'none'", "the initial guess");
      }
      recording_.has_initial_guess = false;
    }
  }

  void ReadVertex(std::size_t kind) {
    const VertexTag& tag = kVertexTags[kind];
    const std::uint64_t id = reader_.Integer("the id of the vertex");
    RefuseTwice(id);
    double value[kOffsetSize];
    if (tag.quaternion < 0) {
      for (int i = 0; i < tag.size; ++i)
        value[i] = reader_.Double(kind == 0 && i == 2 ? "the yaw of the vertex" : kVertexFields[i]);
    } else {
      for (int i = 0; i < 3; ++i) value[i] = reader_.Double(kVertexFields[i]);
      ReadQuaternion(&reader_, kVertexFields + 3, value + 3);
    }
    reader_.ExpectEnd();
    AddVertex(kind, id, {value, static_cast<std::size_t>(tag.size)});
  }

  void RefuseTwice(std::uint64_t id) const {
    const VariableId there = ids_.Find(id);
    if (there != Layout::kNone)
      reader_.Fail("vertex " + std::to_string(id) + " is there already, from line " +
                   std::to_string(reader_.LineNumber(ids_.Offset(there))));
  }

  VariableId AddVertex(std::size_t kind, std::uint64_t id, Span<const double> value) {
    const VertexTag& tag = kVertexTags[kind];
    Graph& graph = recording_.graph;
    try {
      int& type = vertex_types_[kind];
      if (type == kNoType) type = graph.VariableTypeId(tag.type);
      const VariableId variable =
          graph.Add(keys_.KeyOf(id, tag.family), static_cast<Graph::TypeId>(type), value, false);
      ids_.Define(id, variable, reader_.LineOffset());
      return variable;
    } catch (const Error& error) {
      RethrowAt(reader_, reader_.LineOffset(), error);
    }
  }

  void ReadOffset() {
    const std::uint64_t id = reader_.Integer("the id of the parameter");
    const std::size_t place = reader_.WordOffset();
    Offset offset;
    for (std::size_t i = 0; i < 3; ++i) offset[i] = reader_.Double(kOffsetFields[i]);
    ReadQuaternion(&reader_, kOffsetFields + 3, offset.data() + 3);
    reader_.ExpectEnd();
    if (!offsets_.emplace(id, offset).second)
      reader_.FailAt(place, "parameter " + std::to_string(id) + " is there already");
  }

  // An edge may stand before what it names.  From the first such edge on, edges only leave their
  // place, and are read when all the rest has been: so factors keep the file's order.
  void ReadEdge(std::size_t row) {
    if (deferred_.empty() && TryEdge(row)) return;
    deferred_.push_back(reader_.LineOffset());
  }

  void ReadDeferred() {
    all_is_read_ = true;
    if (!deferred_.empty() && ids_.Empty()) {
      make_vertices_ = true;
      recording_.has_initial_guess = false;
      recording_.notes.push_back(
          "the file has no vertices: they were made from its edges, without an initial guess");
    }
    for (const std::size_t place : deferred_) {
      reader_.Seek(place);
      const std::string_view word = reader_.Word();
      std::size_t row = word == kEdgeTags[last_edge_].tag ? last_edge_ : 0;
      while (kEdgeTags[row].tag != word) ++row;
      TryEdge(last_edge_ = row);
    }
  }

  // False, and nothing is done, if the edge names something that may still come.
  bool TryEdge(std::size_t row) {
    const EdgeTag& tag = kEdgeTags[row];
    VariableId variables[2];
    const std::uint64_t a = reader_.Integer("the id of the edge's vertex");
    if ((variables[0] = VertexOf(a, tag.a)) == Layout::kNone) return false;
    std::size_t count = 1;
    const char* source = tag.source;
    if (tag.b != VertexKind::kNone) {
      const std::uint64_t b = reader_.Integer("the id of the edge's second vertex");
      if ((variables[1] = VertexOf(b, tag.b)) == Layout::kNone) return false;
      count = 2;
      if (!source) source = "";  // named at the end, when all poses are known
    }
    const Offset* offset = nullptr;
    if (tag.has_parameter) {
      const std::uint64_t id = reader_.Integer("the id of the sensor's offset");
      const auto it = offsets_.find(id);
      if (it == offsets_.end()) {
        if (!all_is_read_) return false;
        reader_.Fail("there is no PARAMS_SE3OFFSET " + std::to_string(id) + " in this file");
      }
      offset = std::equal(it->second.begin(), it->second.end(), kIdentity) ? nullptr : &it->second;
    }
    AddEdge(row, {variables, count}, offset, source);
    return true;
  }

  VariableId VertexOf(std::uint64_t id, VertexKind kind) {
    const VariableId variable = ids_.Find(id);
    if (variable != Layout::kNone || !all_is_read_) return variable;
    if (!make_vertices_) reader_.Fail("there is no vertex " + std::to_string(id) + " in this file");
    const VertexTag& tag = kVertexTags[static_cast<std::size_t>(kind)];
    double zero[kOffsetSize] = {};
    return AddVertex(static_cast<std::size_t>(kind), id,
                     {tag.quaternion < 0 ? zero : kIdentity, static_cast<std::size_t>(tag.size)});
  }

  void AddEdge(std::size_t row, Span<const VariableId> variables, const Offset* offset,
               const char* source) {
    const EdgeTag& tag = kEdgeTags[row];
    double measurement[kMaxMeasurement];
    int size = tag.size;
    if (tag.quaternion < 0) {
      const int angle = tag.a == VertexKind::kPose2 ? (size == 1 ? 0 : 2) : -1;
      for (int i = 0; i < size; ++i)
        measurement[i] = reader_.Double(i == angle ? "the measured angle" : kMeasuredFields[i]);
    } else {
      for (int i = 0; i < 3; ++i) measurement[i] = reader_.Double(kMeasuredFields[i]);
      ReadQuaternion(&reader_, kMeasuredFields + 3, measurement + 3);
    }
    if (offset) {
      std::copy(offset->begin(), offset->end(), measurement + size);
      size += kOffsetSize;
    }
    double information[kMaxInformation];
    const int entries = tag.residual * (tag.residual + 1) / 2;
    for (int i = 0; i < entries; ++i)
      information[i] = reader_.Double("an entry of the information matrix");
    reader_.ExpectEnd();

    bool full = false;
    if (tag.residual == 6) {
      rotation_used_ = true;
      full = rotation_ == G2oRotation::kFull;
      if (rotation_ == G2oRotation::kDouble) ScaleRotation(2, information);
    }
    try {
      int& type = edge_types_[row * 2 + (offset != nullptr)];
      if (type == kNoType) type = recording_.graph.FactorTypeId(tag.types[full][offset != nullptr]);
      guard_.Try({NoiseKind::kInformation, {information, static_cast<std::size_t>(entries)}},
                 reader_.LineOffset(), [&](NoiseView noise) {
                   recording_.graph.Add(static_cast<Graph::TypeId>(type), variables,
                                        {measurement, static_cast<std::size_t>(size)}, noise,
                                        Loss(), source);
                 });
    } catch (const Error& error) {
      RethrowAt(reader_, reader_.LineOffset(), error);
    }
  }

  void ReadFix(std::size_t place) {
    reader_.Seek(place);
    reader_.Word();
    do {
      const std::uint64_t id = reader_.Integer("the id of a vertex to fix");
      const VariableId variable = ids_.Find(id);
      if (variable == Layout::kNone)
        reader_.Fail("there is no vertex " + std::to_string(id) + " in this file");
      recording_.graph.SetFixed(variable, true);
    } while (!reader_.AtLineEnd());
  }

  TextReader reader_;
  Recording recording_;
  const ReadOptions& options_;
  IdTable ids_;
  KeyComments keys_;
  SkippedTags skipped_;
  InformationGuard guard_;
  G2oRotation rotation_;
  bool rotation_used_ = false;
  bool all_is_read_ = false;
  bool make_vertices_ = false;
  std::size_t last_edge_ = 0;
  int edge_types_[2 * kEdgeTagCount];
  int vertex_types_[kVertexTagCount];
  std::unordered_map<std::uint64_t, Offset> offsets_;
  std::vector<std::size_t> deferred_, fixes_;
};

}  // namespace

Recording ParseG2o(std::string_view text, const std::string& name, const Registry& types,
                   const ReadOptions& options) {
  return Reader(text, name, types, options).Read();
}

}  // namespace graticule
