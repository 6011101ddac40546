#pragma once

// Internal to the readers of JSON files: without the library's header, which takes seconds to
// compile.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace graticule {

/// A place in a JSON document, which says itself where it is: "views[3].ids[0]".  The document must
/// outlive it.  Every refusal is an Error "name: place: expected ..., found ...".
class JsonPlace {
 public:
  bool Has(const char* key) const;
  bool IsList() const;
  bool IsText() const;
  /// A member that must be there.
  JsonPlace operator[](const char* key) const;
  /// Of a list that is longer than that.
  JsonPlace At(std::size_t index) const;
  /// Of a list; anything else is refused.
  std::size_t Size() const;
  /// A list of this length.
  const JsonPlace& OfSize(std::size_t size) const;
  const JsonPlace& Object() const;

  double Number() const;  ///< finite
  /// A whole number in a range.
  long Integer(long least, long most) const;
  bool Flag() const;  ///< true or false
  std::string Text() const;

  [[noreturn]] void Fail(const std::string& message) const;
  [[noreturn]] void FailExpected(const std::string& expected) const;

 private:
  friend class JsonDocument;
  JsonPlace(const void* value, const std::string& name, std::string path)
      : value_(value), name_(&name), path_(std::move(path)) {}

  const void* value_;  // nlohmann::json
  const std::string* name_;
  std::string path_;
};

class JsonDocument {
 public:
  /// Throws Error "name:line:column: not JSON: ...".
  JsonDocument(std::string_view text, const std::string& name);
  JsonPlace Root() const { return {value_.get(), name_, ""}; }

 private:
  std::string name_;
  std::shared_ptr<const void> value_;
};

/// Text in quotes, as JSON has it; bytes that are not UTF-8 become U+FFFD.
std::string JsonQuoted(const std::string& text);
/// A number that reads back to the last bit, -0 too.
void AppendJsonNumber(std::string* text, double number);

}  // namespace graticule
