#pragma once

// Internal to the readers of files that are trees: YAML, OpenCV's XML, Python's literals.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// A node of a document, which knows where in the file it stands.  Every refusal is an Error
/// "file:line:column: expected ..., found ...".
class DocumentNode {
 public:
  enum class Kind { kNothing, kScalar, kList, kMap };

  Kind kind = Kind::kNothing;
  std::string file;  ///< what messages call it
  std::size_t line = 0, column = 0;
  std::string text;                  ///< of a scalar, without quotes
  std::vector<std::string> keys;     ///< of a map, as they come
  std::vector<DocumentNode> values;  ///< of a map or a list

  bool IsMap() const { return kind == Kind::kMap; }
  bool IsList() const { return kind == Kind::kList; }
  /// The member of that name, or null; null also where this is no map.
  const DocumentNode* Find(std::string_view key) const;
  /// The first of these members that there is; refuses where there is none.
  const DocumentNode& Member(std::string_view key) const;
  const DocumentNode& Map() const;   ///< itself; anything else is refused
  const DocumentNode& List() const;  ///< itself; anything else is refused
  const std::string& Scalar() const;
  double Number() const;  ///< finite
  /// A whole number in a range.
  long Integer(long least, long most) const;
  /// A list of numbers; of that many, unless 0.
  std::vector<double> Numbers(std::size_t count = 0) const;

  [[noreturn]] void Fail(const std::string& message) const;
  [[noreturn]] void FailExpected(const std::string& expected) const;
};

/// One YAML document; also OpenCV's, which begins with `%YAML:1.0`.  Refuses names that come twice,
/// and aliases.
DocumentNode ParseYaml(std::string_view text, const std::string& name);

/// XML as OpenCV's FileStorage writes it: an element is a map of its children, or a scalar where it
/// has none.  Attributes are passed over.
DocumentNode ParseXml(std::string_view text, const std::string& name);

/// A literal of Python: dictionaries, lists, tuples, numbers, texts, bytes, None, True, False, and
/// comments.
DocumentNode ParsePythonLiteral(std::string_view text, const std::string& name);

}  // namespace graticule
