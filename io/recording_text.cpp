#include <algorithm>
#include <vector>

#include "graticule/io/recording_parts.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::size_t kShortestLine = 8;  // `a:0 t/1 0` and its line's end, and a little less

class BodyReader {
 public:
  BodyReader(TextReader* reader, InformationGuard* guard, Graph* graph)
      : reader_(*reader), guard_(*guard), graph_(*graph) {}

  /// A line `KEY TYPE numbers... [fixed]`.
  void ReadVariable() {
    const std::string_view word = NextRecord("a variable");
    if (!Key::Parse(word, &key_)) reader_.FailExpected("a key such as pose:12", "a variable");
    const std::size_t place = reader_.WordOffset();
    const Graph::TypeId type = TypeOf(
        &last_variable_type_, [&](std::string_view name) { return graph_.VariableTypeId(name); });
    const Fields& fields = graph_.UsedVariableTypes()[type].fields;
    numbers_.clear();
    for (const Field& field : fields) numbers_.push_back(reader_.Double(field.name.c_str()));
    const bool fixed = reader_.Accept("fixed");
    reader_.ExpectEnd();
    try {
      graph_.Add(key_, type, numbers_, fixed);
    } catch (const Error& error) {
      throw Place(place, error);
    }
  }

  /// A line `TYPE KEYS... | measurement... | NOISE [| LOSS] [| from SOURCE]`.
  void ReadFactor() {
    reader_.Seek(PlaceOfNextRecord("a factor"));
    const std::size_t place = reader_.Offset();
    const Graph::TypeId type = TypeOf(
        &last_factor_type_, [&](std::string_view name) { return graph_.FactorTypeId(name); });
    ReadKeys();
    numbers_.clear();
    while (!reader_.Accept("|")) numbers_.push_back(reader_.Double("the measurement"));
    const NoiseKind kind = ReadNoise();
    Loss loss;
    std::string_view source;
    if (!reader_.AtLineEnd()) ReadLossAndSource(&loss, &source);
    std::string unescaped;
    if (source.find('\\') != std::string_view::npos) source = unescaped = Unescaped(source);
    try {
      guard_.Try({kind, noise_}, place,
                 [&](NoiseView noise) { graph_.Add(type, keys_, numbers_, noise, loss, source); });
    } catch (const Error& error) {
      throw Place(place, error);
    }
  }

 private:
  struct NamedType {
    std::string name;
    Graph::TypeId id = 0;
  };

  // The next line that is not a comment.
  std::size_t PlaceOfNextRecord(const char* what) {
    for (;;) {
      if (!reader_.NextLine())
        reader_.FailAt(reader_.Offset(), std::string("expected ") + what + ", found 'end'");
      const std::string_view word = reader_.Word();
      if (word[0] != '#') return reader_.WordOffset();
    }
  }
  std::string_view NextRecord(const char* what) {
    reader_.Seek(PlaceOfNextRecord(what));
    return reader_.Word();
  }

  template <class Find>
  Graph::TypeId TypeOf(NamedType* last, Find find) {
    const std::string_view name = reader_.Word("the name of a type");
    if (name == last->name) return last->id;
    try {
      last->id = find(name);
    } catch (const Error& error) {
      last->name.clear();
      throw Place(reader_.WordOffset(), error);
    }
    last->name = name;
    return last->id;
  }

  void ReadKeys() {
    keys_.clear();
    while (!reader_.Accept("|")) {
      const std::string_view word = reader_.Word("a key, or '|'");
      if (!Key::Parse(word, &key_)) reader_.FailExpected("a key such as pose:12, or '|'", nullptr);
      keys_.push_back(graph_.Find(key_));
      if (keys_.back() == Layout::kNone)
        reader_.Fail("there is no variable " + key_.ToString() + " in this file");
    }
  }

  NoiseKind ReadNoise() {
    NoiseKind kind = NoiseKind::kUnit;
    const std::string_view word = reader_.Word("the noise");
    if (word == "sigma") {
      kind = NoiseKind::kSigma;
    } else if (word == "information") {
      kind = NoiseKind::kInformation;
    } else if (word != "unit") {
      reader_.FailExpected("'unit', 'sigma' or 'information'", "the noise");
    }
    noise_.clear();
    while (!reader_.AtLineEnd() && !reader_.Accept("|"))
      noise_.push_back(reader_.Double("the noise"));
    return kind;
  }

  // The '|' before has been read.
  void ReadLossAndSource(Loss* loss, std::string_view* source) {
    std::string_view word = reader_.Word();
    if (word != "from") {
      const std::size_t place = reader_.WordOffset();
      const double scale = reader_.Double("the scale of the loss");
      try {
        *loss = MakeLoss(word, scale);
      } catch (const Error& error) {
        throw Place(place, error);
      }
      if (reader_.AtLineEnd()) return;
      const bool bar = reader_.Accept("|");
      if (reader_.Word() != "from" || !bar)
        reader_.FailExpected("'| from SOURCE' or the end of the line", nullptr);
    }
    *source = reader_.Rest();
  }

  // The graph's error, with the place in this file and its kind as it was.
  Error Place(std::size_t offset, const Error& error) const {
    if (error.Kind() == ErrorKind::kInput) reader_.FailAt(offset, error.what());
    try {
      reader_.FailAt(offset, error.what());
    } catch (const Error& placed) {
      return Error(placed.what(), error.Kind());
    }
  }

  TextReader& reader_;
  InformationGuard& guard_;
  Graph& graph_;
  Key key_{"a", 0};
  NamedType last_variable_type_, last_factor_type_;
  std::vector<VariableId> keys_;
  std::vector<double> numbers_, noise_;
};

void AppendNumbers(Span<const double> numbers, std::string* text) {
  for (const double number : numbers) {
    *text += ' ';
    AppendNumber(text, number);
  }
}

void AppendKey(const Key& key, std::string* text) {
  *text += key.Family();
  *text += ':';
  AppendInteger(text, key.Number());
}

void AppendFactor(const Graph& graph, const FactorView& factor, std::string* text) {
  constexpr std::string_view kNoise[] = {"unit", "sigma", "information"};  // as NoiseKind
  *text += factor.type->name;
  for (const VariableId variable : factor.variables) {
    *text += ' ';
    AppendKey(graph.KeyOf(variable), text);
  }
  *text += " |";
  AppendNumbers(factor.measurement, text);
  *text += " | ";
  *text += kNoise[static_cast<std::size_t>(factor.noise.kind)];
  AppendNumbers(factor.noise.values, text);
  if (!(factor.loss == Loss())) {
    *text += " | ";
    *text += LossName(factor.loss.kind);
    AppendNumbers({&factor.loss.scale, 1}, text);
  }
  if (!factor.source.empty()) {
    *text += " | from ";
    *text += Escaped(factor.source);
  }
  *text += '\n';
}

}  // namespace

std::size_t ReadTextBody(TextReader* reader, std::size_t variables, InformationGuard* guard,
                         Recording* recording) {
  Graph* graph = &recording->graph;
  const auto plausible = [&](std::size_t count) {
    return std::min(count, (reader->Size() - reader->Offset()) / kShortestLine);
  };
  graph->Reserve(plausible(variables), 0);
  BodyReader body(reader, guard, graph);
  for (std::size_t i = 0; i < variables; ++i) body.ReadVariable();
  const std::size_t factors = ReadFactorsLine(reader);
  graph->Reserve(graph->VariableCount(), plausible(factors));
  for (std::size_t i = 0; i < factors; ++i) body.ReadFactor();
  while (reader->NextLine()) {
    const std::string_view word = reader->Word();
    if (word[0] != '#') reader->FailExpected("'end'", "after the factors");
  }
  guard->Finish(*reader, recording);
  return factors;
}

void AppendTextBody(const Graph& graph, std::string* text) {
  for (VariableId id = 0; id < graph.VariableCount(); ++id) {
    AppendKey(graph.KeyOf(id), text);
    *text += ' ';
    *text += graph.TypeOf(id).name;
    AppendNumbers(graph.ValueOf(id), text);
    *text += graph.IsFixed(id) ? " fixed\n" : "\n";
  }
  *text += "\nfactors ";
  AppendInteger(text, graph.FactorCount());
  *text += '\n';
  for (FactorId id = 0; id < graph.FactorCount(); ++id)
    AppendFactor(graph, graph.FactorAt(id), text);
  *text += '\n';
}

}  // namespace graticule
