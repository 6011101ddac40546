#include "graticule/solver/schema.hpp"

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

bool IsWord(std::string_view text) {
  for (const char c : text)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'))
      return false;
  return !text.empty();
}

bool IsUnit(std::string_view text) {
  for (const char c : text)
    if (c <= ' ' || c > '~' || c == ':' || c == '*' || c == '|') return false;
  return text.size() < 32;
}

std::vector<std::string_view> Words(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < text.size();) {
    while (i < text.size() && (text[i] == ' ' || text[i] == '\t')) ++i;
    std::size_t end = i;
    while (end < text.size() && text[end] != ' ' && text[end] != '\t') ++end;
    if (end > i) words.push_back(text.substr(i, end - i));
    i = end;
  }
  return words;
}

// "x:m" -> x, m.  The part after the colon may be missing.
Field ParseField(std::string_view word) {
  const std::size_t colon = word.find(':');
  const std::string_view name = word.substr(0, colon);
  const std::string_view unit = colon == std::string_view::npos ? "" : word.substr(colon + 1);
  if (!IsWord(name) || !IsUnit(unit))
    throw Error("expected a field such as yaw:rad in a schema, found '" +
                std::string(word.substr(0, 60)) + "'");
  return {std::string(name), std::string(unit)};
}

Fields ParseRepeatingFields(std::string_view text, bool* repeats_last) {
  Fields fields;
  *repeats_last = false;
  for (std::string_view word : Words(text)) {
    if (*repeats_last) throw Error("in a schema, only the last field may have a '*'");
    if (word.back() == '*') {
      *repeats_last = true;
      word.remove_suffix(1);
    }
    fields.push_back(ParseField(word));
  }
  return fields;
}

}  // namespace

bool FactorSchema::AcceptsBlocks(std::size_t count) const {
  return count == blocks.size() || (repeats_last_block && count >= blocks.size());
}

bool FactorSchema::AcceptsMeasurement(std::size_t count) const {
  return count == measurement.size() || (repeats_last_measurement && count >= measurement.size());
}

const std::string& FactorSchema::BlockType(std::size_t i) const {
  return blocks[i < blocks.size() ? i : blocks.size() - 1].variable_type;
}

bool IsTypeName(std::string_view name) {
  const std::size_t slash = name.find('/');
  if (slash == std::string_view::npos || slash > 60 || !IsWord(name.substr(0, slash))) return false;
  const std::string_view version = name.substr(slash + 1);
  if (version.empty() || version.size() > 6 || version[0] == '0') return false;
  for (const char c : version)
    if (c < '0' || c > '9') return false;
  return true;
}

FactorSchema ParseFactorSchema(std::string_view text) {
  FactorSchema schema;
  const std::size_t first = text.find('|');
  const std::size_t second = first == std::string_view::npos ? first : text.find('|', first + 1);
  for (std::string_view word : Words(text.substr(0, first))) {
    if (schema.repeats_last_block) throw Error("in a schema, only the last block may have a '*'");
    if (word.back() == '*') {
      schema.repeats_last_block = true;
      word.remove_suffix(1);
    }
    const std::size_t colon = word.find(':');
    if (colon == std::string_view::npos || !IsWord(word.substr(0, colon)) ||
        !IsTypeName(word.substr(colon + 1)))
      throw Error("expected a block such as a:se2/1 in a schema, found '" +
                  std::string(word.substr(0, 60)) + "'");
    schema.blocks.push_back(
        {std::string(word.substr(0, colon)), std::string(word.substr(colon + 1))});
  }
  if (schema.blocks.empty())
    throw Error("a factor's schema names at least one block, such as a:se2/1");
  if (first != std::string_view::npos) {
    schema.measurement = ParseRepeatingFields(
        text.substr(first + 1, second == std::string_view::npos ? second : second - first - 1),
        &schema.repeats_last_measurement);
  }
  if (second != std::string_view::npos) {
    schema.residual = ParseRepeatingFields(text.substr(second + 1), &schema.repeats_last_residual);
  } else {
    schema.residual = schema.measurement;
    schema.repeats_last_residual = schema.repeats_last_measurement;
  }
  if (schema.residual.empty()) throw Error("a factor's schema names at least one residual field");
  return schema;
}

Fields ParseFields(std::string_view text) {
  bool repeats = false;
  Fields fields = ParseRepeatingFields(text, &repeats);
  if (repeats || fields.empty())
    throw Error("expected fields such as x:m y:m, found '" + std::string(text) + "'");
  return fields;
}

std::string ToString(const Fields& fields) {
  std::string text;
  for (const Field& field : fields) {
    if (!text.empty()) text += ' ';
    text += field.name;
    if (!field.unit.empty()) text += ":" + field.unit;
  }
  return text;
}

std::string ToString(const FactorSchema& schema) {
  std::string text;
  for (const Block& block : schema.blocks) text += block.role + ":" + block.variable_type + " ";
  if (schema.repeats_last_block) text.insert(text.size() - 1, "*");
  const std::string measurement =
      ToString(schema.measurement) + (schema.repeats_last_measurement ? "*" : "");
  const std::string residual =
      ToString(schema.residual) + (schema.repeats_last_residual ? "*" : "");
  text += measurement.empty() ? "|" : "| " + measurement;
  if (residual != measurement) text += " | " + residual;
  return text;
}

}  // namespace graticule
