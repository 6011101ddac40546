#pragma once

// Internal to readers of comma-separated values whose first line names the columns.

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// Goes through the lines of a table and knows where it is.  Blank lines and lines that begin with
/// `#` are passed over; blanks and a pair of quotes around a cell are not part of it.  The text and
/// the name must outlive it.  Every refusal is an Error "name:line:column: ...".
class CsvTable {
 public:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// Reads the first line.  Throws Error: there is none.
  CsvTable(std::string_view text, std::string_view name);

  /// The column that has one of these names (lower case, whatever the file's), or kNone.  Throws
  /// Error: two have.
  std::size_t Find(std::initializer_list<const char*> names) const;
  const std::vector<std::string>& Columns() const { return columns_; }

  /// Goes to the next line; false at the end.  Throws Error: more or fewer cells than columns.
  bool Next();
  std::string_view Cell(std::size_t column) const { return cells_[column]; }
  /// A finite number.
  double Number(std::size_t column) const;

  std::size_t Line() const { return line_; }
  [[noreturn]] void Fail(std::size_t column, const std::string& message) const;
  [[noreturn]] void FailLine(const std::string& message) const;

 private:
  bool SplitLine();

  std::string_view rest_, name_;
  std::string_view current_;
  std::size_t line_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::string_view> cells_;
};

}  // namespace graticule
