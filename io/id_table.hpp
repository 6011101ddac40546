#pragma once

// Internal to the readers and writers of formats that number their variables (g2o, TORO).

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// Which variable a file's number means, and at which offset of the file it was defined.
class IdTable {
 public:
  /// A file of that many bytes: bounds the memory, whatever numbers it contains.
  explicit IdTable(std::size_t file_size) : dense_limit_(file_size / 8 + 64) {}

  /// Layout::kNone if the number has not been defined.
  VariableId Find(std::uint64_t id) const {
    if (id < dense_.size()) return dense_[id];
    if (sparse_.empty()) return Layout::kNone;
    const auto it = sparse_.find(id);
    return it == sparse_.end() ? Layout::kNone : it->second;
  }
  /// The id must be new; variables are defined in their order.
  void Define(std::uint64_t id, VariableId variable, std::size_t offset);
  std::size_t Offset(VariableId variable) const { return offsets_[variable]; }
  bool Empty() const { return offsets_.empty(); }

 private:
  std::size_t dense_limit_;
  std::vector<VariableId> dense_;
  std::unordered_map<std::uint64_t, VariableId> sparse_;
  std::vector<std::size_t> offsets_;
};

/// The comments by which such files keep keys: `# graticule-key 12 robot1:3`.
class KeyComments {
 public:
  /// Reads what follows `graticule-key`.
  void Read(TextReader* reader, const IdTable& ids);
  /// `family:id`, unless a comment said otherwise.
  Key KeyOf(std::uint64_t id, std::string_view family) const {
    if (!keys_.empty()) {
      const auto it = keys_.find(id);
      if (it != keys_.end()) return it->second;
    }
    return Key(family, id);
  }

 private:
  std::unordered_map<std::uint64_t, Key> keys_;
};

/// The numbers that a graph's variables get in a file, by position: their own where `families` (the
/// default family of each variable's type) and uniqueness allow; the others follow in key order,
/// each with a comment in `comments`.
std::vector<std::uint64_t> AssignIds(const Graph& graph,
                                     const std::vector<std::string_view>& families,
                                     std::string* comments);

/// The error that something threw, again, with a place in the file before it and its kind kept.
[[noreturn]] void RethrowAt(const TextReader& reader, std::size_t offset, const Error& error);

/// Reads x y z w and normalises them.
void ReadQuaternion(TextReader* reader, const char* const what[4], double* q);

/// Names the source of the factors between two poses that have none yet: "odometry" where no other
/// pose of the family stands between them by number (landmarks may: they share g2o's numbers), else
/// "loop".
void NamePoseSources(Graph* graph);

}  // namespace graticule
