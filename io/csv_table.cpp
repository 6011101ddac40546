#include "graticule/io/csv_table.hpp"

#include <cctype>
#include <charconv>
#include <cmath>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string_view Trimmed(std::string_view cell) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!cell.empty() && is_blank(cell.front())) cell.remove_prefix(1);
  while (!cell.empty() && is_blank(cell.back())) cell.remove_suffix(1);
  return cell;
}

}  // namespace

CsvTable::CsvTable(std::string_view text, std::string_view name) : rest_(text), name_(name) {
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark)
    rest_.remove_prefix(kByteOrderMark.size());
  if (!SplitLine()) throw Error(std::string(name_) + ": there is no line in this file");
  for (const std::string_view cell : cells_) {
    std::string column(cell);
    for (char& c : column) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    columns_.push_back(std::move(column));
  }
}

std::size_t CsvTable::Find(std::initializer_list<const char*> names) const {
  std::size_t found = kNone;
  for (std::size_t i = 0; i < columns_.size(); ++i)
    for (const char* name : names) {
      if (columns_[i] != name) continue;
      if (found != kNone)
        throw Error(std::string(name_), 1, 0,
                    "the columns " + Quoted(columns_[found]) + " and " + Quoted(columns_[i]) +
                        " say the same: keep one");
      found = i;
    }
  return found;
}

bool CsvTable::SplitLine() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    current_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_;
    const std::string_view trimmed = Trimmed(current_);
    if (trimmed.empty() || trimmed.front() == '#') continue;
    cells_.clear();
    for (std::size_t begin = 0; begin <= current_.size();) {
      const std::size_t comma = std::min(current_.find(',', begin), current_.size());
      std::string_view cell = Trimmed(current_.substr(begin, comma - begin));
      if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"')
        cell = cell.substr(1, cell.size() - 2);
      cells_.push_back(cell);
      begin = comma + 1;
    }
    return true;
  }
  return false;
}

bool CsvTable::Next() {
  if (!SplitLine()) return false;
  if (cells_.size() != columns_.size())
    FailLine("expected " + std::to_string(columns_.size()) +
             " cells, as the first line has, found " + std::to_string(cells_.size()));
  return true;
}

double CsvTable::Number(std::size_t column) const {
  std::string_view cell = cells_[column];
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  double number = 0;
  const auto [stop, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (problem != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(number))
    Fail(column, "expected a number (" + Printable(columns_[column]) + "), found " +
                     Quoted(cells_[column]));
  return number;
}

void CsvTable::Fail(std::size_t column, const std::string& message) const {
  throw Error(std::string(name_), line_,
              static_cast<std::size_t>(cells_[column].data() - current_.data()) + 1, message);
}

void CsvTable::FailLine(const std::string& message) const {
  throw Error(std::string(name_), line_, 0, message);
}

}  // namespace graticule
