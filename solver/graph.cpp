#include "graticule/solver/graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "graticule/solver/error.hpp"
#include "graticule/solver/gaussian.hpp"
#include "graticule/solver/guarded.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {
namespace {

constexpr std::size_t kMaxTypes = std::numeric_limits<Graph::TypeId>::max();
constexpr std::size_t kMaxCount = Layout::kNone;
constexpr Graph::TypeId kAnyType = kMaxTypes;  // beyond all that are given out

bool AllFinite(Span<const double> values) {
  for (const double value : values)
    if (!std::isfinite(value)) return false;
  return true;
}

std::string OffManifold(const Key& key, const VariableType& type) {
  return "variable " + key.ToString() + ": not a " + type.name + " (" + type.summary + ")";
}

template <class Type>
std::size_t IndexOf(const std::deque<Type>& types, std::string_view name) {
  std::size_t i = 0;
  while (i < types.size() && types[i].name != name) ++i;
  return i;
}

template <class Type>
std::string NotLoaded(const char* what, std::string_view name,
                      const std::vector<const Type*>& known) {
  std::vector<std::string_view> names;
  for (const Type* type : known) names.push_back(type->name);
  return std::string(what) + " type " + std::string(name.substr(0, 60)) + " is not loaded" +
         DidYouMean(name, names);
}

bool HasRepeats(Span<const VariableId> variables) {
  constexpr std::size_t kFew = 16;  // nothing is allocated for these
  if (variables.size() > kFew) {
    std::vector<VariableId> sorted(variables.begin(), variables.end());
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  }
  for (std::size_t i = 0; i < variables.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (variables[j] == variables[i]) return true;
  return false;
}

constexpr const char* kLossScale = "expected a loss scale above zero whose square is a number";

bool HasScale(const Loss& loss) { return loss.scale > 0 && std::isnormal(loss.scale * loss.scale); }

// What `create` makes of a factor; destroyed at once.  Only the number of residuals is kept.
int ResidualSizeOf(const FactorType& type, Span<const double> measurement, const Graph& graph,
                   Span<const VariableId> variables) {
  const graticule_measurement c = {sizeof(graticule_measurement),
                                   static_cast<std::int32_t>(measurement.size()),
                                   measurement.data()};
  std::int32_t residual_size = static_cast<std::int32_t>(type.schema.residual.size());
  std::string why;
  void* made = CreateFactor(*type.table, c, static_cast<std::int32_t>(variables.size()),
                            &residual_size, &why);
  if (!made) throw Error(why);
  if (IsGaussian(type.table)) why = static_cast<const Gaussian*>(made)->Misfit(graph, variables);
  type.table->destroy(made);
  if (!why.empty()) throw Error(why);
  if (residual_size < 1 || residual_size > 100000 ||
      (!type.schema.repeats_last_residual &&
       residual_size != static_cast<std::int32_t>(type.schema.residual.size())))
    throw Error("its schema has " + std::to_string(type.schema.residual.size()) +
                    " residuals, the factor says " + std::to_string(residual_size),
                ErrorKind::kMissingType);
  return residual_size;
}

// Only the factor itself knows how many residuals a schema with a `*` means.  Where it is not
// loaded the noise tells, as far as it has a number for each.
int ResidualSizeOf(NoiseView noise, int otherwise) {
  const std::size_t count = noise.values.size();
  if (noise.kind == NoiseKind::kSigma && count > 1) return static_cast<int>(count);
  if (noise.kind != NoiseKind::kInformation) return otherwise;
  std::size_t size = 1;
  while (size * (size + 1) / 2 < count) ++size;
  return static_cast<int>(size);
}

}  // namespace

Layout& Graph::MutableLayout() {
  if (layout_.use_count() > 1) layout_ = std::make_shared<Layout>(*layout_);
  return *layout_;
}

template <class Action>
auto Graph::AddOrForgetTypes(Action&& add) {
  const std::size_t variable_types = variable_types_.size(), factor_types = factor_types_.size();
  try {
    return add();
  } catch (...) {
    while (variable_types_.size() > variable_types) variable_types_.pop_back();
    while (factor_types_.size() > factor_types) factor_types_.pop_back();
    block_types_.resize(factor_types);
    last_noise_.resize(factor_types);
    throw;
  }
}

VariableId Graph::IdOf(const Key& key) const {
  const VariableId id = layout_->Find(key);
  if (id == Layout::kNone) throw Error("there is no variable " + key.ToString());
  return id;
}

// ----------------------------------------------------------------------------------------------
// types

Graph::TypeId Graph::VariableTypeId(std::string_view name) {
  const std::size_t index = IndexOf(variable_types_, name);
  if (index < variable_types_.size()) return static_cast<TypeId>(index);
  auto type = types_.FindVariableType(name);
  if (!type)
    throw Error(NotLoaded("variable", name, types_.VariableTypes()), ErrorKind::kMissingType);
  if (index >= kMaxTypes) throw Error("more than 65535 variable types");
  variable_types_.push_back(std::move(*type));
  return static_cast<TypeId>(index);
}

Graph::TypeId Graph::FactorTypeId(std::string_view name) {
  const std::size_t index = IndexOf(factor_types_, name);
  if (index < factor_types_.size()) return static_cast<TypeId>(index);
  auto type = types_.FindFactorType(name);
  if (!type) throw Error(NotLoaded("factor", name, types_.FactorTypes()), ErrorKind::kMissingType);
  if (index >= kMaxTypes) throw Error("more than 65535 factor types");
  std::vector<TypeId> blocks;
  for (const Block& block : type->schema.blocks)
    blocks.push_back(block.variable_type == kAnyVariable ? kAnyType
                                                         : VariableTypeId(block.variable_type));
  factor_types_.push_back(std::move(*type));
  block_types_.push_back(std::move(blocks));
  last_noise_.push_back(Layout::kNone);
  return static_cast<TypeId>(index);
}

Graph::TypeId Graph::DeclareVariableType(std::string_view name, std::string_view fields) {
  const Fields declared = ParseFields(fields);
  const std::size_t index = IndexOf(variable_types_, name);
  if (index < variable_types_.size() || types_.FindVariableType(name)) {
    const TypeId id = VariableTypeId(name);
    if (ToString(variable_types_[id].fields) != ToString(declared))
      throw Error("variable type " + std::string(name) + " is '" +
                  ToString(variable_types_[id].fields) + "' here, and declared as '" +
                  ToString(declared) + "'");
    return id;
  }
  if (!IsTypeName(name))
    throw Error("expected a type name such as se2/1, found '" + std::string(name) + "'");
  if (index >= kMaxTypes) throw Error("more than 65535 variable types");
  VariableType type;
  type.name = name;
  type.fields = declared;
  variable_types_.push_back(std::move(type));
  return static_cast<TypeId>(index);
}

Graph::TypeId Graph::DeclareFactorType(std::string_view name, std::string_view schema) {
  FactorSchema declared = ParseFactorSchema(schema);
  const std::size_t index = IndexOf(factor_types_, name);
  if (index < factor_types_.size() || types_.FindFactorType(name)) {
    const TypeId id = FactorTypeId(name);
    if (ToString(factor_types_[id].schema) != ToString(declared))
      throw Error("factor type " + std::string(name) + " is '" +
                  ToString(factor_types_[id].schema) + "' here, and declared as '" +
                  ToString(declared) + "'");
    return id;
  }
  if (!IsTypeName(name))
    throw Error("expected a type name such as between_se2/1, found '" + std::string(name) + "'");
  if (index >= kMaxTypes) throw Error("more than 65535 factor types");
  std::vector<TypeId> blocks;
  for (const Block& block : declared.blocks) blocks.push_back(VariableTypeId(block.variable_type));
  FactorType type;
  type.name = name;
  type.schema = std::move(declared);
  factor_types_.push_back(std::move(type));
  block_types_.push_back(std::move(blocks));
  last_noise_.push_back(Layout::kNone);
  return static_cast<TypeId>(index);
}

// ------------------------------------------------------------------------------------------
// variables

VariableId Graph::Add(const Key& key, std::string_view type, const std::vector<double>& value,
                      bool fixed) {
  return AddOrForgetTypes([&] { return Add(key, VariableTypeId(type), value, fixed); });
}

VariableId Graph::Add(const Key& key, TypeId type, Span<const double> value, bool fixed) {
  const VariableType& variable_type = variable_types_[type];
  if (value.size() != variable_type.fields.size())
    throw Error("variable " + key.ToString() + ": expected " +
                std::to_string(variable_type.fields.size()) + " numbers (" +
                ToString(variable_type.fields) + "), found " + std::to_string(value.size()));
  if (!AllFinite(value))
    throw Error("variable " + key.ToString() + ": expected finite numbers, found nan or inf");
  if (VariableCount() + 1 >= kMaxCount) throw Error("more variables than a graph holds");
  const std::size_t first = data_.size();
  data_.insert(data_.end(), value.begin(), value.end());
  if (!variable_type.Normalise(data_.data() + first)) {
    data_.resize(first);
    throw Error(OffManifold(key, variable_type));
  }
  const VariableId id = MutableLayout().Add(key, value.size());
  if (id == Layout::kNone) {
    data_.resize(first);
    throw Error("variable " + key.ToString() + " is there already: a key may be used once");
  }
  variable_type_.push_back(type);
  fixed_.push_back(fixed);
  return id;
}

void Graph::WriteNormalised(VariableId id, Span<const double> value, double* to) const {
  if (value.size() != layout_->Size(id) || !AllFinite(value))
    throw Error("variable " + KeyOf(id).ToString() + ": expected " +
                std::to_string(layout_->Size(id)) + " finite numbers");
  std::copy(value.begin(), value.end(), to);
  if (!TypeOf(id).Normalise(to)) throw Error(OffManifold(KeyOf(id), TypeOf(id)));
}

void Graph::SetValue(VariableId id, Span<const double> value) {
  std::vector<double> normalised(layout_->Size(id));
  WriteNormalised(id, value, normalised.data());
  std::copy(normalised.begin(), normalised.end(),
            data_.begin() + static_cast<std::ptrdiff_t>(layout_->Offset(id)));
}

void Graph::SetValues(const Values& values) {
  std::vector<double> data = data_;
  for (VariableId from = 0; from < values.Count(); ++from) {
    const VariableId id = values.layout_ == layout_ ? from : IdOf(values.KeyOf(from));
    WriteNormalised(id, values[from], data.data() + layout_->Offset(id));
  }
  data_ = std::move(data);
}

void Graph::CheckLayout(const Values& values) const {
  if (values.layout_ == layout_) return;
  if (values.Count() != VariableCount())
    throw Error("these values are of another graph: expected those of " +
                    std::to_string(VariableCount()) + " variables, found " +
                    std::to_string(values.Count()),
                ErrorKind::kUsage);
  for (VariableId id = 0; id < VariableCount(); ++id)
    if (values.KeyOf(id) != KeyOf(id) || values[id].size() != layout_->Size(id))
      throw Error("these values are of another graph: expected " + KeyOf(id).ToString() +
                      " at position " + std::to_string(id) + ", found " +
                      values.KeyOf(id).ToString(),
                  ErrorKind::kUsage);
}

void Graph::Reserve(std::size_t variables, std::size_t factors) {
  MutableLayout().Reserve(variables);
  variable_type_.reserve(variables);
  fixed_.reserve(variables);
  factors_.reserve(factors);
}

// --------------------------------------------------------------------------------------------
// factors

void Graph::RefuseFactor(TypeId type, Span<const VariableId> variables,
                         const std::string& why) const {
  std::string text = factor_types_[type].name + " (";
  for (std::size_t i = 0; i < std::min<std::size_t>(variables.size(), 4); ++i)
    text +=
        (i ? " " : "") + (variables[i] < VariableCount() ? KeyOf(variables[i]).ToString() : "?");
  throw Error(text + (variables.size() > 4 ? " ..." : "") + "): " + why);
}

FactorId Graph::Add(const Factor& factor) {
  return AddOrForgetTypes([&] {
    const TypeId type = FactorTypeId(factor.type);
    std::vector<VariableId> variables;
    variables.reserve(factor.keys.size());
    for (const Key& key : factor.keys) variables.push_back(IdOf(key));
    return Add(type, variables, factor.measurement, factor.noise.View(), factor.loss,
               factor.source);
  });
}

FactorId Graph::Add(TypeId type, Span<const VariableId> variables, Span<const double> measurement,
                    NoiseView noise, const Loss& loss, std::string_view source) {
  const FactorType& factor_type = factor_types_[type];
  const FactorSchema& schema = factor_type.schema;
  if (!schema.AcceptsBlocks(variables.size()))
    RefuseFactor(type, variables,
                 "expected " + std::to_string(schema.blocks.size()) +
                     (schema.repeats_last_block ? " or more" : "") + " keys, found " +
                     std::to_string(variables.size()));
  const std::vector<TypeId>& blocks = block_types_[type];
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (variables[i] >= VariableCount()) RefuseFactor(type, variables, "unknown variable");
    const TypeId expected = blocks[std::min(i, blocks.size() - 1)];
    if (expected != kAnyType && variable_type_[variables[i]] != expected)
      RefuseFactor(type, variables,
                   "expected " + variable_types_[expected].name + " at " +
                       KeyOf(variables[i]).ToString() + ", which is " + TypeOf(variables[i]).name);
  }
  if (HasRepeats(variables)) RefuseFactor(type, variables, "the same key twice");
  if (!schema.AcceptsMeasurement(measurement.size()))
    RefuseFactor(type, variables,
                 "expected " + std::to_string(schema.measurement.size()) +
                     (schema.repeats_last_measurement ? " or more" : "") + " measured numbers (" +
                     ToString(schema.measurement) + "), found " +
                     std::to_string(measurement.size()));
  if (!AllFinite(measurement))
    RefuseFactor(type, variables, "expected finite numbers, found nan or inf");
  if (!HasScale(loss)) RefuseFactor(type, variables, kLossScale);
  if (FactorCount() + 1 >= kMaxCount) throw Error("more factors than a graph holds");

  int residual_size = static_cast<int>(schema.residual.size());
  std::uint32_t noise_id = 0;
  try {
    if (factor_type.Known())
      residual_size = ResidualSizeOf(factor_type, measurement, *this, variables);
    else if (schema.repeats_last_residual)
      residual_size = ResidualSizeOf(noise, residual_size);
    noise_id = InternNoise(type, noise, residual_size);
  } catch (const Error& error) {
    if (error.Kind() != ErrorKind::kInput)
      throw Error(factor_type.name + ": " + error.what(), error.Kind());
    RefuseFactor(type, variables, error.what());
  }
  Record record;
  record.first_variable = variable_pool_.size();
  record.first_measurement = measurement_pool_.size();
  record.loss = loss;
  record.noise = noise_id;
  record.source = InternSource(source);
  record.variable_count = static_cast<std::uint32_t>(variables.size());
  record.measurement_count = static_cast<std::uint32_t>(measurement.size());
  record.residual_size = residual_size;
  record.type = type;
  variable_pool_.insert(variable_pool_.end(), variables.begin(), variables.end());
  measurement_pool_.insert(measurement_pool_.end(), measurement.begin(), measurement.end());
  factors_.push_back(record);
  return static_cast<FactorId>(factors_.size() - 1);
}

std::uint32_t Graph::InternNoise(TypeId type, NoiseView noise, int residual_size) {
  // Recorded problems repeat one noise for thousands of factors in a row: comparing with the latest
  // of the same type finds nearly all of them, at the price of one memcmp.
  const std::uint32_t last = last_noise_[type];
  if (last != Layout::kNone) {
    const NoiseRecord& record = noises_[last];
    if (record.kind == noise.kind && record.count == noise.values.size() &&
        record.residual_size == residual_size &&
        (noise.values.empty() || std::memcmp(noise_pool_.data() + record.first, noise.values.data(),
                                             noise.values.size() * sizeof(double)) == 0))
      return last;
  }
  CheckNoise(noise, residual_size);
  noises_.push_back({noise_pool_.size(), static_cast<std::uint32_t>(noise.values.size()),
                     residual_size, noise.kind});
  noise_pool_.insert(noise_pool_.end(), noise.values.begin(), noise.values.end());
  return last_noise_[type] = static_cast<std::uint32_t>(noises_.size() - 1);
}

std::uint32_t Graph::InternSource(std::string_view source) {
  if (!sources_.empty() && !factors_.empty() && sources_[factors_.back().source] == source)
    return factors_.back().source;
  const auto it = source_ids_.find(source);
  if (it != source_ids_.end()) return it->second;
  sources_.emplace_back(source);
  return source_ids_[std::string(source)] = static_cast<std::uint32_t>(sources_.size() - 1);
}

FactorView Graph::FactorAt(FactorId id) const {
  const Record& record = factors_[id];
  FactorView view;
  view.type = &factor_types_[record.type];
  view.variables = {variable_pool_.data() + record.first_variable, record.variable_count};
  view.measurement = {measurement_pool_.data() + record.first_measurement,
                      record.measurement_count};
  view.noise = NoiseAt(record.noise);
  view.noise_id = record.noise;
  view.loss = record.loss;
  view.source = sources_[record.source];
  return view;
}

Factor Graph::FactorRecord(FactorId id) const {
  const FactorView view = FactorAt(id);
  Factor factor;
  factor.type = view.type->name;
  for (const VariableId variable : view.variables) factor.keys.push_back(KeyOf(variable));
  factor.measurement.assign(view.measurement.begin(), view.measurement.end());
  factor.noise.kind = view.noise.kind;
  factor.noise.values.assign(view.noise.values.begin(), view.noise.values.end());
  factor.loss = view.loss;
  factor.source = view.source;
  return factor;
}

Graph::Record& Graph::RecordOf(FactorId id) {
  if (id >= FactorCount())
    throw Error("there is no factor " + std::to_string(id) + ": the graph has " +
                    std::to_string(FactorCount()),
                ErrorKind::kUsage);
  return factors_[id];
}

void Graph::SetSource(FactorId id, std::string_view source) {
  Record& record = RecordOf(id);
  record.source = InternSource(source);
}

void Graph::SetLoss(FactorId id, const Loss& loss) {
  Record& record = RecordOf(id);
  if (!HasScale(loss)) throw Error(kLossScale);
  record.loss = loss;
}

void Graph::SetLosses(const Loss& loss) {
  if (!HasScale(loss)) throw Error(kLossScale);
  for (Record& record : factors_) record.loss = loss;
}

Graph Graph::Slice(const std::set<Key>& keep) const {
  Graph slice(types_);
  slice.variable_types_ = variable_types_;  // declared types included, ids alike
  slice.factor_types_ = factor_types_;
  slice.block_types_ = block_types_;
  slice.last_noise_.assign(factor_types_.size(), Layout::kNone);
  std::vector<VariableId> renumbered(VariableCount(), Layout::kNone);
  for (const Key& key : keep) IdOf(key);
  for (VariableId id = 0; id < VariableCount(); ++id)
    if (keep.count(KeyOf(id)))
      renumbered[id] = slice.Add(KeyOf(id), variable_type_[id], ValueOf(id), IsFixed(id));
  std::vector<VariableId> variables;
  for (FactorId id = 0; id < FactorCount(); ++id) {
    const FactorView view = FactorAt(id);
    variables.clear();
    for (const VariableId variable : view.variables)
      if (renumbered[variable] != Layout::kNone) variables.push_back(renumbered[variable]);
    if (variables.size() == view.variables.size())
      slice.Add(factors_[id].type, variables, view.measurement, view.noise, view.loss, view.source);
  }
  return slice;
}

}  // namespace graticule
