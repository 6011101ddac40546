#include "graticule/solver/layout.hpp"

#include <algorithm>
#include <numeric>

namespace graticule {

VariableId Layout::Find(const Key& key) const {
  const auto family = families_.find(key.Family());
  if (family == families_.end()) return kNone;
  const auto& [dense, sparse, largest] = family->second;
  if (key.Number() < dense.size()) return dense[key.Number()];
  if (sparse.empty()) return kNone;
  const auto it = sparse.find(key.Number());
  return it == sparse.end() ? kNone : it->second;
}

std::optional<std::uint64_t> Layout::LargestNumber(std::string_view name) const {
  const auto family = families_.find(name);
  if (family == families_.end()) return std::nullopt;
  return family->second.largest;
}

VariableId Layout::Add(const Key& key, std::size_t size) {
  auto family = families_.find(key.Family());
  if (family == families_.end())
    family = families_.emplace(std::string(key.Family()), Family()).first;
  auto& [dense, sparse, largest] = family->second;
  const std::uint64_t number = key.Number();
  const auto id = static_cast<VariableId>(keys_.size());
  if (number >= dense.size() && number < 64 + 2 * (dense.size() + sparse.size())) {
    std::size_t grown = std::max<std::size_t>(64, 2 * dense.size());
    while (grown <= number) grown *= 2;
    dense.resize(grown, kNone);
    for (auto it = sparse.begin(); it != sparse.end();) {
      if (it->first >= grown) {
        ++it;
        continue;
      }
      dense[it->first] = it->second;
      it = sparse.erase(it);
    }
  }
  if (number < dense.size()) {
    if (dense[number] != kNone) return kNone;
    dense[number] = id;
  } else if (!sparse.emplace(number, id).second) {
    return kNone;
  }
  largest = std::max(largest, number);
  keys_.push_back(key);
  offsets_.push_back(offsets_.back() + size);
  return id;
}

std::vector<VariableId> Layout::KeyOrder() const {
  std::vector<VariableId> order(keys_.size());
  std::iota(order.begin(), order.end(), VariableId{0});
  if (!std::is_sorted(keys_.begin(), keys_.end()))
    std::sort(order.begin(), order.end(),
              [&](VariableId a, VariableId b) { return keys_[a] < keys_[b]; });
  return order;
}

void Layout::Reserve(std::size_t variables) {
  keys_.reserve(variables);
  offsets_.reserve(variables + 1);
}

}  // namespace graticule
