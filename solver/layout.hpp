#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graticule/solver/factor.hpp"
#include "graticule/solver/key.hpp"

namespace graticule {

/// Which key is at which position, and where its numbers begin.  Shared by a graph and the values
/// that came out of it.
class Layout {
 public:
  static constexpr VariableId kNone = 0xffffffffu;

  std::size_t Count() const { return keys_.size(); }
  /// Numbers of all variables together.
  std::size_t DataSize() const { return offsets_.back(); }
  const Key& KeyOf(VariableId id) const { return keys_[id]; }
  std::size_t Offset(VariableId id) const { return offsets_[id]; }
  std::size_t Size(VariableId id) const { return offsets_[id + 1] - offsets_[id]; }

  /// kNone if the key is not there.
  VariableId Find(const Key& key) const;
  /// Of a family's keys; nothing where there is no such family.
  std::optional<std::uint64_t> LargestNumber(std::string_view family) const;
  /// kNone if the key is already there.
  VariableId Add(const Key& key, std::size_t size);
  /// Positions in the order of their keys.
  std::vector<VariableId> KeyOrder() const;
  void Reserve(std::size_t variables);

 private:
  // Numbers of a family mostly count up from near 0: a plain table, and a hash for what lies far
  // out.
  struct Family {
    std::vector<VariableId> dense;
    std::unordered_map<std::uint64_t, VariableId> sparse;
    std::uint64_t largest = 0;
  };
  std::vector<Key> keys_;
  std::vector<std::size_t> offsets_{0};
  std::map<std::string, Family, std::less<>> families_;
};

}  // namespace graticule
