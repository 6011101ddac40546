#include "graticule/io/id_table.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "graticule/solver/rotation.hpp"

namespace graticule {

void IdTable::Define(std::uint64_t id, VariableId variable, std::size_t offset) {
  if (id >= dense_.size() && id < dense_limit_) {
    std::size_t size = std::max<std::size_t>(64, dense_.size());
    while (size <= id) size *= 2;
    dense_.resize(size, Layout::kNone);
    for (auto it = sparse_.begin(); it != sparse_.end();) {
      if (it->first < size) {
        dense_[it->first] = it->second;
        it = sparse_.erase(it);
      } else {
        ++it;
      }
    }
  }
  if (id < dense_.size()) {
    dense_[id] = variable;
  } else {
    sparse_[id] = variable;
  }
  offsets_.push_back(offset);
}

void KeyComments::Read(TextReader* reader, const IdTable& ids) {
  const std::uint64_t id = reader->Integer("the id of a vertex");
  if (ids.Find(id) != Layout::kNone)
    reader->Fail("the key of vertex " + std::to_string(id) + " must come before the vertex");
  Key key("a", 0);
  if (!Key::Parse(reader->Word("the vertex's key"), &key))
    reader->FailExpected("a key such as pose:12", "the vertex's key");
  if (!keys_.emplace(id, key).second)
    reader->Fail("vertex " + std::to_string(id) + " already has a key");
  reader->ExpectEnd();
}

std::vector<std::uint64_t> AssignIds(const Graph& graph,
                                     const std::vector<std::string_view>& families,
                                     std::string* comments) {
  constexpr std::uint64_t kLargest = 2147483647;  // ids are an int in g2o and TORO
  const std::vector<VariableId> order = graph.KeyOrder();
  std::vector<std::uint64_t> ids(graph.VariableCount());
  std::vector<VariableId> others;
  std::unordered_set<std::uint64_t> taken;
  taken.reserve(order.size());
  std::uint64_t next = 0;
  // Poses before landmarks: where both want a number, the pose keeps it.
  for (const bool poses : {true, false})
    for (const VariableId id : order) {
      const Key& key = graph.KeyOf(id);
      if ((key.Family() == "pose") != poses) continue;
      const bool own = key.Family() == families[graph.VariableTypeIndex(id)] &&
                       key.Number() <= kLargest && taken.insert(key.Number()).second;
      if (!own) {
        others.push_back(id);
        continue;
      }
      ids[id] = key.Number();
      next = std::max(next, key.Number() + 1);
    }
  std::sort(others.begin(), others.end(),
            [&](VariableId a, VariableId b) { return graph.KeyOf(a) < graph.KeyOf(b); });
  for (const VariableId id : others) {
    if (next > kLargest) next = 0;
    while (!taken.insert(next).second) ++next;
    ids[id] = next;
    *comments += "# graticule-key ";
    AppendInteger(comments, next);
    *comments += ' ' + graph.KeyOf(id).ToString() + '\n';
  }
  return ids;
}

void RethrowAt(const TextReader& reader, std::size_t offset, const Error& error) {
  try {
    reader.FailAt(offset, error.what());
  } catch (const Error& placed) {
    throw Error(placed.what(), error.Kind());
  }
}

void ReadQuaternion(TextReader* reader, const char* const what[4], double* q) {
  q[0] = reader->Double(what[0]);
  const std::size_t place = reader->WordOffset();
  for (int i = 1; i < 4; ++i) q[i] = reader->Double(what[i]);
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (NormaliseQuaternion(q)) return;
  std::string text;
  AppendNumber(&text, norm);
  reader->FailAt(place, "expected a unit quaternion (qx qy qz qw), found one of length " + text);
}

void NamePoseSources(Graph* graph) {
  // Ranks of poses in key order; a family begins two further on, so that none follows another's.
  constexpr std::uint32_t kNoPose = 0xffffffffu;
  std::vector<std::uint32_t> rank(graph->VariableCount(), kNoPose);
  std::uint32_t next = 0;
  std::string_view family;
  for (const VariableId id : graph->KeyOrder()) {
    if (!IsPose(graph->TypeOf(id))) continue;
    if (graph->KeyOf(id).Family() != family) {
      family = graph->KeyOf(id).Family();
      ++next;
    }
    rank[id] = next++;
  }
  for (FactorId id = 0; id < graph->FactorCount(); ++id) {
    const FactorView factor = graph->FactorAt(id);
    if (!factor.source.empty() || factor.variables.size() != 2) continue;
    const std::uint32_t a = rank[factor.variables[0]], b = rank[factor.variables[1]];
    if (a == kNoPose || b == kNoPose) continue;
    graph->SetSource(id, (a > b ? a - b : b - a) == 1 ? "odometry" : "loop");
  }
}

}  // namespace graticule
