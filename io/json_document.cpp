#include "graticule/io/json_document.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/io/json_text.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using nlohmann::json;

// What stands there, for a message.
std::string Found(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  return Quoted(value.dump(-1, ' ', true, json::error_handler_t::replace));
}

const json& Of(const void* value) { return *static_cast<const json*>(value); }

}  // namespace

bool JsonPlace::Has(const char* key) const {
  return Of(value_).is_object() && Of(value_).contains(key);
}

bool JsonPlace::IsList() const { return Of(value_).is_array(); }
bool JsonPlace::IsText() const { return Of(value_).is_string(); }

JsonPlace JsonPlace::operator[](const char* key) const {
  Object();
  const auto found = Of(value_).find(key);
  if (found == Of(value_).end()) Fail(std::string("expected a member '") + key + "'");
  return {&*found, *name_, path_.empty() ? key : path_ + "." + key};
}

JsonPlace JsonPlace::At(std::size_t index) const {
  return {&Of(value_).at(index), *name_, path_ + "[" + std::to_string(index) + "]"};
}

std::size_t JsonPlace::Size() const {
  if (!Of(value_).is_array()) FailExpected("a list");
  return Of(value_).size();
}

const JsonPlace& JsonPlace::OfSize(std::size_t size) const {
  if (Size() != size) FailExpected("a list of " + std::to_string(size));
  return *this;
}

const JsonPlace& JsonPlace::Object() const {
  if (!Of(value_).is_object()) FailExpected("an object");
  return *this;
}

double JsonPlace::Number() const {
  if (!Of(value_).is_number()) FailExpected("a number");
  const double number = Of(value_).get<double>();
  if (!std::isfinite(number)) FailExpected("a finite number");
  return number;
}

long JsonPlace::Integer(long least, long most) const {
  const bool is_small_enough =
      Of(value_).is_number_integer() && (!Of(value_).is_number_unsigned() ||
                                         Of(value_).get<std::uint64_t>() <= std::uint64_t{1} << 62);
  const auto number = is_small_enough ? Of(value_).get<std::int64_t>() : 0;
  if (!is_small_enough || number < least || number > most)
    FailExpected("a whole number in " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<long>(number);
}

bool JsonPlace::Flag() const {
  if (!Of(value_).is_boolean()) FailExpected("true or false");
  return Of(value_).get<bool>();
}

std::string JsonPlace::Text() const {
  if (!Of(value_).is_string()) FailExpected("a text");
  return Of(value_).get<std::string>();
}

void JsonPlace::Fail(const std::string& message) const {
  throw Error(*name_ + ": " + (path_.empty() ? "" : path_ + ": ") + message);
}

void JsonPlace::FailExpected(const std::string& expected) const {
  Fail("expected " + expected + ", found " + Found(Of(value_)));
}

JsonDocument::JsonDocument(std::string_view text, const std::string& name) : name_(name) {
  try {
    value_ = std::make_shared<const json>(json::parse(text));
  } catch (const json::parse_error& error) {
    const TextReader reader(text, name);
    const std::size_t byte = std::min<std::size_t>(error.byte ? error.byte - 1 : 0, text.size());
    // Without the library's own place; what was last read may be as long as the file.
    const std::string whole = std::string(error.what()).substr(0, 200);
    const std::size_t colon = whole.find(": ");
    reader.FailAt(byte, byte >= text.size() ? "not JSON: the file is cut short"
                                            : "not JSON: " + whole.substr(colon + 2));
  } catch (const json::out_of_range&) {
    throw Error(name + ": a number is larger than a double can hold");
  }
}

std::string JsonQuoted(const std::string& text) { return JsonText(json(text)); }

void AppendJsonNumber(std::string* text, double number) {
  // JSON's "-0" is a whole number, and has no sign.
  if (number == 0 && std::signbit(number))
    *text += "-0.0";
  else
    AppendNumber(text, number);
}

}  // namespace graticule
