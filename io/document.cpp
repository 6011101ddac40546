#include "graticule/io/document.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

const DocumentNode* DocumentNode::Find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &values[static_cast<std::size_t>(found - keys.begin())];
}

const DocumentNode& DocumentNode::Member(std::string_view key) const {
  const DocumentNode* found = Map().Find(key);
  if (!found) Fail("expected a member '" + std::string(key) + "'");
  return *found;
}

const DocumentNode& DocumentNode::Map() const {
  if (kind != Kind::kMap) FailExpected("names with values");
  return *this;
}

const DocumentNode& DocumentNode::List() const {
  if (kind != Kind::kList) FailExpected("a list");
  return *this;
}

const std::string& DocumentNode::Scalar() const {
  if (kind != Kind::kScalar) FailExpected("a plain value");
  return text;
}

double DocumentNode::Number() const {
  if (kind != Kind::kScalar) FailExpected("a number");
  const char* first = text.data();
  const char* last = first + text.size();
  if (text.size() > 1 && *first == '+' && first[1] != '-') ++first;
  double value = 0;
  const auto [stop, problem] = std::from_chars(first, last, value);
  if (problem != std::errc() || stop != last) FailExpected("a number");
  if (!std::isfinite(value)) FailExpected("a finite number");
  return value;
}

long DocumentNode::Integer(long least, long most) const {
  long value = 0;
  const char* last = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), last, value);
  if (kind != Kind::kScalar || problem != std::errc() || stop != last || value < least ||
      value > most)
    FailExpected("a whole number in " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

std::vector<double> DocumentNode::Numbers(std::size_t count) const {
  List();
  if (count != 0 && values.size() != count)
    FailExpected("a list of " + std::to_string(count) + " numbers");
  std::vector<double> numbers;
  numbers.reserve(values.size());
  for (const DocumentNode& value : values) numbers.push_back(value.Number());
  return numbers;
}

void DocumentNode::Fail(const std::string& message) const {
  throw Error(file, line, column, Printable(message));
}

void DocumentNode::FailExpected(const std::string& expected) const {
  std::string found = "nothing";
  if (kind == Kind::kScalar) found = Quoted(text);
  if (kind == Kind::kList) found = "a list of " + std::to_string(values.size());
  if (kind == Kind::kMap) found = "names with values";
  Fail("expected " + expected + ", found " + found);
}

}  // namespace graticule
