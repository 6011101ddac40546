#pragma once

#include <memory>
#include <vector>

#include "graticule/solver/layout.hpp"
#include "graticule/solver/span.hpp"

namespace graticule {

/// A number for every field of every variable of a graph, in one buffer.  Copying copies the
/// numbers only.
class Values {
 public:
  Values() = default;

  std::size_t Count() const { return layout_ ? layout_->Count() : 0; }
  bool Has(const Key& key) const { return layout_ && layout_->Find(key) != Layout::kNone; }
  /// The fields of one variable.  Throws Error if there is no such key.
  Span<const double> At(const Key& key) const;
  /// The fields of the variable at this position of the graph.
  Span<const double> operator[](VariableId id) const {
    return {data_.data() + layout_->Offset(id), layout_->Size(id)};
  }
  double* Mutable(VariableId id) { return data_.data() + layout_->Offset(id); }
  const Key& KeyOf(VariableId id) const { return layout_->KeyOf(id); }

  /// All numbers, in the graph's order.
  const std::vector<double>& Data() const { return data_; }
  std::vector<double>& MutableData() { return data_; }

 private:
  friend class Graph;
  friend class Snapshots;
  Values(std::shared_ptr<const Layout> layout, std::vector<double> data)
      : layout_(std::move(layout)), data_(std::move(data)) {}

  std::shared_ptr<const Layout> layout_;
  std::vector<double> data_;
};

}  // namespace graticule
