// The binary body; docs/formats.md describes it byte by byte.

#include <algorithm>
#include <cstring>

#include "graticule/io/recording_parts.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Flags of a factor's record.
constexpr std::uint8_t kSameNoise = 1;  // as the factor before of this type: not repeated
constexpr std::uint8_t kNewSource = 2;  // a text follows; otherwise its number does
constexpr std::uint8_t kHasLoss = 4;

constexpr std::size_t kSmallestVariable = 13;  // family of one letter, number, type, flags
constexpr std::size_t kSmallestFactor = 15;

class ByteReader {
 public:
  ByteReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  std::size_t Offset() const { return offset_; }
  std::size_t Left() const { return bytes_.size() - offset_; }
  void Seek(std::size_t offset) { offset_ = std::min(offset, bytes_.size()); }

  template <class Unsigned>
  Unsigned Number() {
    const std::string_view bytes = Take(sizeof(Unsigned));
    Unsigned value = 0;
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
      value = static_cast<Unsigned>(
          value | static_cast<Unsigned>(static_cast<Unsigned>(static_cast<unsigned char>(bytes[i]))
                                        << (8 * i)));
    return value;
  }

  double Double() {
    const auto bits = Number<std::uint64_t>();
    double value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  void Doubles(std::size_t count, std::vector<double>* values) {
    if (count > Left() / sizeof(double)) Fail("expected " + std::to_string(count) + " numbers");
    values->resize(count);
    for (double& value : *values) value = Double();
  }

  std::string_view Text(std::size_t size) { return Take(size); }

  [[noreturn]] void Fail(const std::string& message) const {
    throw Error(name_ + ": at byte " + std::to_string(offset_) + ": " + Printable(message));
  }

 private:
  std::string_view Take(std::size_t size) {
    if (size > Left()) Fail("the file was cut short, or is damaged");
    offset_ += size;
    return bytes_.substr(offset_ - size, size);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t offset_ = 0;
};

template <class Unsigned>
void Append(Unsigned value, std::string* bytes) {
  char buffer[sizeof(Unsigned)];
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
    buffer[i] = static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  bytes->append(buffer, sizeof(buffer));
}

void AppendDouble(double value, std::string* bytes) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  Append(bits, bytes);
}

void AppendDoubles(Span<const double> values, std::string* bytes) {
  for (const double value : values) AppendDouble(value, bytes);
}

class BodyReader {
 public:
  BodyReader(ByteReader* bytes, const DeclaredTypes& types, InformationGuard* guard, Graph* graph)
      : bytes_(*bytes),
        types_(types),
        guard_(*guard),
        graph_(*graph),
        last_noise_(types.factors.size()),
        is_repaired_(types.factors.size()) {}

  void ReadVariable() {
    const std::string_view family = bytes_.Text(bytes_.Number<std::uint8_t>());
    const auto number = bytes_.Number<std::uint64_t>();
    const Graph::TypeId type = TypeAt(types_.variables, bytes_.Number<std::uint16_t>());
    const bool fixed = bytes_.Number<std::uint8_t>() != 0;
    bytes_.Doubles(graph_.UsedVariableTypes()[type].fields.size(), &numbers_);
    Guard([&] { graph_.Add(Key(family, number), type, numbers_, fixed); });
  }

  void ReadFactor() {
    const auto declared = bytes_.Number<std::uint16_t>();
    const Graph::TypeId type = TypeAt(types_.factors, declared);
    const auto flags = bytes_.Number<std::uint8_t>();
    const auto key_count = bytes_.Number<std::uint32_t>();
    if (key_count > bytes_.Left() / 4) bytes_.Fail("more keys than the file can hold");
    keys_.resize(key_count);
    for (VariableId& key : keys_) key = bytes_.Number<std::uint32_t>();
    bytes_.Doubles(bytes_.Number<std::uint32_t>(), &numbers_);

    Noise& noise = last_noise_[declared];
    if (!(flags & kSameNoise)) {
      const auto kind = bytes_.Number<std::uint8_t>();
      if (kind > 2) bytes_.Fail("there is no noise number " + std::to_string(kind));
      noise.kind = static_cast<NoiseKind>(kind);
      is_repaired_[declared] = false;
      bytes_.Doubles(bytes_.Number<std::uint32_t>(), &noise.values);
    }
    Loss loss;
    if (flags & kHasLoss) {
      const auto kind = bytes_.Number<std::uint8_t>();
      if (kind > static_cast<std::uint8_t>(LossKind::kGemanMcClure))
        bytes_.Fail("there is no loss number " + std::to_string(kind));
      loss = {static_cast<LossKind>(kind), bytes_.Double()};
    }
    const auto source = bytes_.Number<std::uint32_t>();
    if (flags & kNewSource) {
      sources_.emplace_back(bytes_.Text(source));
    } else if (source >= sources_.size()) {
      bytes_.Fail("there is no source number " + std::to_string(source));
    }
    const std::string& text = flags & kNewSource ? sources_.back() : sources_[source];
    Guard([&] {
      const bool good = guard_.Try(noise.View(), bytes_.Offset(), [&](NoiseView view) {
        graph_.Add(type, keys_, numbers_, view, loss, text);
      });
      if (is_repaired_[declared]) guard_.CountAgain();
      if (good) return;
      // Those after it that share it need no second projection.
      noise.values = guard_.Nearest();
      is_repaired_[declared] = true;
    });
  }

 private:
  Graph::TypeId TypeAt(const std::vector<Graph::TypeId>& types, std::size_t index) const {
    if (index >= types.size())
      bytes_.Fail("the header declares no type number " + std::to_string(index));
    return types[index];
  }

  template <class Add>
  void Guard(Add add) const {
    try {
      add();
    } catch (const Error& error) {
      bytes_.Fail(error.what());
    }
  }

  ByteReader& bytes_;
  const DeclaredTypes& types_;
  InformationGuard& guard_;
  Graph& graph_;
  std::vector<VariableId> keys_;
  std::vector<double> numbers_;
  std::vector<Noise> last_noise_;
  std::vector<bool> is_repaired_;  // the last noise, of a factor type
  std::vector<std::string> sources_;
};

// Sources get their numbers in the order in which a file names them.  Graphs keep each text once,
// so that its address tells it.
class SourceNumbers {
 public:
  /// True if the source is new.
  bool Number(std::string_view source, std::uint32_t* number) {
    const auto [it, added] =
        numbers_.emplace(source.data(), static_cast<std::uint32_t>(numbers_.size()));
    *number = it->second;
    return added;
  }

 private:
  std::map<const char*, std::uint32_t> numbers_;
};

}  // namespace

std::size_t ReadBinaryBody(TextReader* reader, std::string_view text, const std::string& name,
                           const DeclaredTypes& types, std::size_t variables,
                           InformationGuard* guard, Recording* recording) {
  Graph* graph = &recording->graph;
  ByteReader bytes(text, name);
  bytes.Seek(reader->Offset() + 1);  // past the line's end
  if (variables > bytes.Left() / kSmallestVariable)
    bytes.Fail("more variables than the file holds");
  graph->Reserve(variables, 0);
  BodyReader body(&bytes, types, guard, graph);
  for (std::size_t i = 0; i < variables; ++i) body.ReadVariable();

  reader->Seek(bytes.Offset());
  const std::size_t factors = ReadFactorsLine(reader);
  bytes.Seek(reader->Offset() + 1);
  if (factors > bytes.Left() / kSmallestFactor) bytes.Fail("more factors than the file holds");
  graph->Reserve(variables, factors);
  for (std::size_t i = 0; i < factors; ++i) body.ReadFactor();
  if (bytes.Text(bytes.Left()) != "\n") bytes.Fail("expected 'end' after the last factor");
  if (guard->IsEmpty()) return factors;
  bytes.Seek(guard->FirstOffset());
  if (!guard->MayRepair()) bytes.Fail(guard->Refusal(*graph));
  recording->repaired =
      guard->Record(*graph, name + ", byte " + std::to_string(guard->FirstOffset()));
  return factors;
}

void AppendBinaryBody(const Graph& graph, std::string* text) {
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    const Key& key = graph.KeyOf(id);
    Append(static_cast<std::uint8_t>(key.Family().size()), text);
    *text += key.Family();
    Append(key.Number(), text);
    Append(graph.VariableTypeIndex(id), text);
    Append(static_cast<std::uint8_t>(graph.IsFixed(id)), text);
    AppendDoubles(graph.ValueOf(id), text);
  }
  *text += "\nfactors ";
  AppendInteger(text, graph.FactorCount());
  *text += '\n';

  SourceNumbers sources;
  std::vector<std::uint32_t> last_noise(graph.UsedFactorTypes().size(), Layout::kNone);
  for (FactorId id = 0; id < graph.FactorCount(); ++id) {
    const FactorView factor = graph.FactorAt(id);
    const Graph::TypeId type = graph.FactorTypeIndex(id);
    const bool same_noise = last_noise[type] == factor.noise_id;
    last_noise[type] = factor.noise_id;
    const bool has_loss = !(factor.loss == Loss());
    std::uint32_t source = 0;
    const bool new_source = sources.Number(factor.source, &source);

    Append(type, text);
    Append(static_cast<std::uint8_t>((same_noise ? kSameNoise : 0) | (new_source ? kNewSource : 0) |
                                     (has_loss ? kHasLoss : 0)),
           text);
    Append(static_cast<std::uint32_t>(factor.variables.size()), text);
    for (const VariableId variable : factor.variables) Append(variable, text);
    Append(static_cast<std::uint32_t>(factor.measurement.size()), text);
    AppendDoubles(factor.measurement, text);
    if (!same_noise) {
      Append(static_cast<std::uint8_t>(factor.noise.kind), text);
      Append(static_cast<std::uint32_t>(factor.noise.values.size()), text);
      AppendDoubles(factor.noise.values, text);
    }
    if (has_loss) {
      Append(static_cast<std::uint8_t>(factor.loss.kind), text);
      AppendDouble(factor.loss.scale, text);
    }
    if (new_source) {
      Append(static_cast<std::uint32_t>(factor.source.size()), text);
      *text += factor.source;
    } else {
      Append(source, text);
    }
  }
  *text += '\n';
}

}  // namespace graticule
