#include <array>
#include <map>

#include "graticule/io/g2o.hpp"
#include "graticule/io/g2o_tags.hpp"
#include "graticule/io/id_table.hpp"
#include "graticule/io/information.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Offset = std::array<double, kOffsetSize>;
constexpr Offset kIdentity = {0, 0, 0, 0, 0, 0, 1};

// Which row of kEdgeTags writes a factor type.
struct Row {
  const EdgeTag* tag = nullptr;
  bool full = false;
  bool has_offset = false;
};

Row FindRow(std::string_view type) {
  for (const EdgeTag& tag : kEdgeTags)
    for (const bool full : {false, true})
      for (const bool has_offset : {false, true}) {
        const char* name = tag.types[full][has_offset];
        if (name && type == name) return {&tag, full, has_offset};
      }
  return {};
}

class Writer {
 public:
  Writer(const Recording& recording, std::vector<std::string>* notes)
      : recording_(recording), graph_(recording.graph), notes_(*notes) {}

  std::string Write() {
    FindRows();
    ChooseRotation();
    std::string comments;
    const std::vector<std::uint64_t> ids = AssignIds(graph_, Families(), &comments);
    if (rotation_) Line("# graticule-rotation " + std::string(ToString(*rotation_)));
    if (!recording_.has_initial_guess) Line("# graticule-initial-guess none");
    text_ += comments;
    WriteOffsets();
    for (VariableId id = 0; id < graph_.VariableCount(); ++id) {
      text_ += TagOf(id).tag;
      Integer(ids[id]);
      Numbers(graph_.ValueOf(id));
      text_ += '\n';
    }
    for (VariableId id = 0; id < graph_.VariableCount(); ++id)
      if (graph_.IsFixed(id)) Line("FIX " + std::to_string(ids[id]));
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) WriteFactor(id, ids);
    return std::move(text_);
  }

 private:
  void FindRows() {
    for (const FactorType& type : graph_.UsedFactorTypes()) rows_.push_back(FindRow(type.name));
    std::map<std::string, std::size_t> refused;
    std::size_t losses = 0;
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const FactorView factor = graph_.FactorAt(id);
      const Row& row = rows_[graph_.FactorTypeIndex(id)];
      if (!row.tag) ++refused[factor.type->name];
      if (factor.loss.kind != LossKind::kNone) ++losses;
      if (row.tag && row.tag->residual == 6) ++(row.full ? full_ : quaternion_);
    }
    RefuseTypes("factors", refused);
    for (VariableId id = 0; id < graph_.VariableCount(); ++id)
      if (!FindTag(graph_.TypeOf(id).name)) ++refused[graph_.TypeOf(id).name];
    RefuseTypes("variables", refused);
    if (losses)
      notes_.push_back("g2o has no losses: those of " + std::to_string(losses) +
                       " factors are not in the file");
  }

  static void RefuseTypes(const char* what, const std::map<std::string, std::size_t>& refused) {
    if (refused.empty()) return;
    std::string list;
    for (const auto& [type, count] : refused)
      list += (list.empty() ? "" : ", ") + type + " (" + std::to_string(count) + ")";
    throw Error(std::string("g2o has no tag for the ") + what + " " + list + "; write .fg");
  }

  void ChooseRotation() {
    if (full_ && quaternion_)
      throw Error("a g2o file has one reading of rotations, and the graph has " +
                  std::to_string(quaternion_) + " factors of the quaternion's vector part and " +
                  std::to_string(full_) + " of the full angle; write .fg");
    if (full_) rotation_ = G2oRotation::kFull;
    if (quaternion_)
      rotation_ = recording_.g2o_rotation == G2oRotation::kDouble ? G2oRotation::kDouble
                                                                  : G2oRotation::kHalf;
  }

  static const VertexTag* FindTag(std::string_view type) {
    for (const VertexTag& tag : kVertexTags)
      if (type == tag.type) return &tag;
    return nullptr;
  }
  const VertexTag& TagOf(VariableId id) const { return *FindTag(graph_.TypeOf(id).name); }

  std::vector<std::string_view> Families() const {
    std::vector<std::string_view> families;
    for (const VariableType& type : graph_.UsedVariableTypes()) {
      const VertexTag* tag = FindTag(type.name);
      families.push_back(tag ? tag->family : "");
    }
    return families;
  }

  Offset OffsetOf(const FactorView& factor, const Row& row) const {
    Offset offset = kIdentity;
    if (row.has_offset)
      std::copy(factor.measurement.begin() + row.tag->size, factor.measurement.end(),
                offset.begin());
    return offset;
  }

  // Parameters stand first, numbered in the order of their first use.
  void WriteOffsets() {
    for (FactorId id = 0; id < graph_.FactorCount(); ++id) {
      const Row& row = rows_[graph_.FactorTypeIndex(id)];
      if (!row.tag->has_parameter) continue;
      const Offset offset = OffsetOf(graph_.FactorAt(id), row);
      if (!offsets_.emplace(offset, offsets_.size()).second) continue;
      text_ += "PARAMS_SE3OFFSET";
      Integer(offsets_.size() - 1);
      Numbers({offset.data(), offset.size()});
      text_ += '\n';
    }
  }

  void WriteFactor(FactorId id, const std::vector<std::uint64_t>& ids) {
    const FactorView factor = graph_.FactorAt(id);
    const Row& row = rows_[graph_.FactorTypeIndex(id)];
    text_ += row.tag->tag;
    for (const VariableId variable : factor.variables) Integer(ids[variable]);
    if (row.tag->has_parameter) Integer(offsets_.at(OffsetOf(factor, row)));
    Numbers({factor.measurement.data(), static_cast<std::size_t>(row.tag->size)});
    InformationOf(factor.noise, row.tag->residual, &information_);
    if (row.tag->residual == 6 && rotation_ == G2oRotation::kDouble)
      ScaleRotation(0.5, information_.data());
    Numbers(information_);
    text_ += '\n';
  }

  void Line(const std::string& line) { text_ += line + '\n'; }
  void Integer(std::uint64_t number) {
    text_ += ' ';
    AppendInteger(&text_, number);
  }
  void Numbers(Span<const double> numbers) {
    for (const double number : numbers) {
      text_ += ' ';
      AppendNumber(&text_, number);
    }
  }

  const Recording& recording_;
  const Graph& graph_;
  std::vector<std::string>& notes_;
  std::vector<Row> rows_;  // a factor type's
  std::size_t full_ = 0, quaternion_ = 0;
  std::optional<G2oRotation> rotation_;
  std::map<Offset, std::size_t> offsets_;
  std::vector<double> information_;
  std::string text_;
};

}  // namespace

std::string FormatG2o(const Recording& recording, std::vector<std::string>* notes) {
  return Writer(recording, notes).Write();
}

}  // namespace graticule
