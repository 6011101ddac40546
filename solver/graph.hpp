#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/solver/factor.hpp"
#include "graticule/solver/registry.hpp"
#include "graticule/solver/values.hpp"

namespace graticule {

/// A factor graph: variables with a value each, and factors between them.  Data, not code: it can
/// be written, read, sliced and compared, even past factor types that are not installed.
///
/// Every Add checks what it is given and throws Error without having changed the graph.  Memory is
/// pooled: a million factors are a handful of allocations.  Not thread-safe while it is being
/// changed.
class Graph {
 public:
  using TypeId = std::uint16_t;

  explicit Graph(Registry types) : types_(std::move(types)), layout_(std::make_shared<Layout>()) {}

  // --- adding

  /// A variable with its initial value.  Throws Error: key used twice, unknown type, wrong number
  /// of fields, not finite, off its manifold.  A fixed variable is held at its value.
  VariableId Add(const Key& key, std::string_view type, const std::vector<double>& value,
                 bool fixed = false);

  /// A factor.  Throws Error: unknown type, unknown key, the same key twice, wrong variable types,
  /// wrong count, not finite, bad noise, bad loss.
  FactorId Add(const Factor& factor);

  // --- adding in bulk: names looked up once, nothing allocated a call

  TypeId VariableTypeId(
      std::string_view name);  ///< Throws Error (kMissingType): neither known nor declared.
  TypeId FactorTypeId(std::string_view name);  ///< The same.
  VariableId Add(const Key& key, TypeId type, Span<const double> value, bool fixed);
  FactorId Add(TypeId type, Span<const VariableId> variables, Span<const double> measurement,
               NoiseView noise, const Loss& loss, std::string_view source);
  void Reserve(std::size_t variables, std::size_t factors);

  /// Makes a type that nobody here implements legal in this graph, as a file's header describes it.
  /// Where the type is known, the two must agree: throws Error otherwise.
  TypeId DeclareVariableType(std::string_view name, std::string_view fields);
  TypeId DeclareFactorType(std::string_view name, std::string_view schema);

  // --- variables

  std::size_t VariableCount() const { return layout_->Count(); }
  const Key& KeyOf(VariableId id) const { return layout_->KeyOf(id); }
  /// Layout::kNone if there is none.
  VariableId Find(const Key& key) const { return layout_->Find(key); }
  /// The largest number of a family's keys; nothing where there is no such family.
  std::optional<std::uint64_t> LargestNumber(std::string_view family) const {
    return layout_->LargestNumber(family);
  }
  /// Throws Error if there is none.
  VariableId IdOf(const Key& key) const;
  const VariableType& TypeOf(VariableId id) const { return variable_types_[variable_type_[id]]; }
  bool IsFixed(VariableId id) const { return fixed_[id] != 0; }
  void SetFixed(VariableId id, bool fixed) { fixed_[id] = fixed; }
  Span<const double> ValueOf(VariableId id) const {
    return {data_.data() + layout_->Offset(id), layout_->Size(id)};
  }
  std::size_t Offset(VariableId id) const { return layout_->Offset(id); }
  /// Positions in the order of their keys.
  std::vector<VariableId> KeyOrder() const { return layout_->KeyOrder(); }

  /// The graph's own values (the initial guess), and a way to replace them: from any Values that
  /// covers a part of the graph's keys; the others keep theirs.  SetValues throws Error: unknown
  /// key, wrong size, not finite.
  Values InitialValues() const { return Values(layout_, data_); }
  void SetValues(const Values& values);
  /// Throws Error (kUsage) unless the values are laid out as the graph's own: the same keys and
  /// sizes, in the same order.  Values from before the last variable was added are not.
  void CheckLayout(const Values& values) const;
  void SetValue(VariableId id, Span<const double> value);

  // --- factors

  std::size_t FactorCount() const { return factors_.size(); }
  FactorView FactorAt(FactorId id) const;
  /// Parts of it, for inner loops.
  Span<const VariableId> VariablesOf(FactorId id) const {
    return {variable_pool_.data() + factors_[id].first_variable, factors_[id].variable_count};
  }
  const Loss& LossOf(FactorId id) const { return factors_[id].loss; }
  /// A copy of a factor, with keys.
  Factor FactorRecord(FactorId id) const;
  int ResidualSize(FactorId id) const { return factors_[id].residual_size; }
  std::size_t NoiseCount() const { return noises_.size(); }
  /// Replaces who said so.  Throws Error (kUsage): no such factor.
  void SetSource(FactorId id, std::string_view source);
  /// Replaces a factor's loss.  Throws Error: no such factor (kUsage), a scale that Add refuses.
  void SetLoss(FactorId id, const Loss& loss);
  /// Replaces every factor's loss.  Throws Error: a scale that Add refuses; then none is replaced.
  void SetLosses(const Loss& loss);

  // --- types

  const Registry& Types() const { return types_; }
  /// The types in use, in the order of their first use.
  const std::deque<VariableType>& UsedVariableTypes() const { return variable_types_; }
  const std::deque<FactorType>& UsedFactorTypes() const { return factor_types_; }
  TypeId VariableTypeIndex(VariableId id) const { return variable_type_[id]; }
  TypeId FactorTypeIndex(FactorId id) const { return factors_[id].type; }

  /// The variables in `keep`, and every factor that touches no other.  Throws Error: unknown key.
  Graph Slice(const std::set<Key>& keep) const;

 private:
  struct Record {
    std::size_t first_variable;
    std::size_t first_measurement;
    Loss loss;
    std::uint32_t noise;
    std::uint32_t source;
    std::uint32_t variable_count;
    std::uint32_t measurement_count;
    std::int32_t residual_size;
    TypeId type;
  };
  struct NoiseRecord {
    std::size_t first;
    std::uint32_t count;
    std::int32_t residual_size;
    NoiseKind kind;
  };

  Layout& MutableLayout();
  Record& RecordOf(FactorId id);  // throws Error (kUsage): no such factor
  /// Runs `add`; where it throws, types that came into use only by it are not in use.
  template <class Action>
  auto AddOrForgetTypes(Action&& add);
  void WriteNormalised(VariableId id, Span<const double> value, double* to) const;
  std::uint32_t InternNoise(TypeId type, NoiseView noise, int residual_size);
  std::uint32_t InternSource(std::string_view source);
  NoiseView NoiseAt(std::uint32_t id) const {
    const NoiseRecord& record = noises_[id];
    return {record.kind, {noise_pool_.data() + record.first, record.count}};
  }
  [[noreturn]] void RefuseFactor(TypeId type, Span<const VariableId> variables,
                                 const std::string& why) const;

  Registry types_;
  std::deque<VariableType> variable_types_;
  std::deque<FactorType> factor_types_;

  std::shared_ptr<Layout> layout_;  // copied before a change while a Values shares it
  std::vector<TypeId> variable_type_;
  std::vector<std::uint8_t> fixed_;
  std::vector<double> data_;

  std::vector<Record> factors_;
  std::vector<VariableId> variable_pool_;
  std::vector<double> measurement_pool_;
  std::vector<NoiseRecord> noises_;
  std::vector<double> noise_pool_;
  std::vector<std::uint32_t> last_noise_;         // a factor type's latest
  std::vector<std::vector<TypeId>> block_types_;  // a factor type's blocks, as TypeId
  std::deque<std::string> sources_;
  std::map<std::string, std::uint32_t, std::less<>> source_ids_;
};

}  // namespace graticule
