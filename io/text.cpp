#include "graticule/io/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool IsBreak(char c) { return IsBlank(c) || c == '\n'; }

}  // namespace

TextReader::TextReader(std::string_view text, std::string_view name)
    : begin_(text.data()),
      end_(text.data() + text.size()),
      cursor_(begin_),
      line_(begin_),
      word_(begin_),
      name_(name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors begin files with it
  if (text.substr(0, 3) == kByteOrderMark) cursor_ += 3;
}

void TextReader::SkipBlanks() {
  while (cursor_ != end_ && IsBlank(*cursor_)) ++cursor_;
}

bool TextReader::NextWord() {
  while (cursor_ != end_ && IsBreak(*cursor_)) ++cursor_;
  return cursor_ != end_;
}

bool TextReader::NextLine() {
  SkipBlanks();
  // After a line that was read to its end, this is where the cursor already stands.
  if (started_ && cursor_ != end_ && *cursor_ != '\n') {
    const void* next = std::memchr(cursor_, '\n', static_cast<std::size_t>(end_ - cursor_));
    cursor_ = next ? static_cast<const char*>(next) : end_;
  }
  started_ = true;
  const bool found = NextWord();
  line_ = word_ = cursor_;
  return found;
}

std::string_view TextReader::WordAt(const char* first) const {
  const char* last = first;
  while (last != end_ && !IsBreak(*last)) ++last;
  return {first, static_cast<std::size_t>(last - first)};
}

std::string_view TextReader::Word() {
  SkipBlanks();
  word_ = cursor_;
  const std::string_view word = WordAt(cursor_);
  cursor_ += word.size();
  return word;
}

std::string_view TextReader::Word(const char* what) {
  const std::string_view word = Word();
  if (word.empty()) FailExpected("a word", what);
  return word;
}

double TextReader::Double(const char* what) {
  SkipBlanks();
  word_ = cursor_;
  const char* first = cursor_;
  if (first != end_ && *first == '+' && first + 1 != end_ && first[1] != '-') ++first;
  double value = 0;
  const auto [stop, problem] = std::from_chars(first, end_, value);
  const bool whole = stop == end_ || IsBreak(*stop);
  if (problem == std::errc() && whole && std::isfinite(value)) {
    cursor_ = stop;
    return value;
  }
  if (problem == std::errc::result_out_of_range && whole && Underflows(&value)) {
    cursor_ = stop;
    return value;
  }
  RefuseNumber(what);
}

// A number too small for a double is zero; one too large is not a number that we could keep.
bool TextReader::Underflows(double* value) {
  const std::string_view word = WordAt(word_);
  const std::size_t exponent = word.find_first_of("eE");
  const std::string_view mantissa = word.substr(0, exponent);
  // Its first digit that is not zero stands for 10^magnitude.
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  const std::size_t digit = std::min(mantissa.find_first_of("123456789"), mantissa.size());
  double magnitude = static_cast<double>(point) - static_cast<double>(digit) - (digit < point);
  if (exponent != std::string_view::npos) {
    std::string_view power = word.substr(exponent + 1);
    const bool is_negative = power.substr(0, 1) == "-";
    if (is_negative || power.substr(0, 1) == "+") power.remove_prefix(1);
    // Of an exponent beyond an int64 nothing but its sign counts.
    std::int64_t size = 0;
    const auto end = power.data() + power.size();
    if (std::from_chars(power.data(), end, size).ec != std::errc()) size = INT64_MAX;
    magnitude += static_cast<double>(is_negative ? -size : size);
  }
  const bool small = magnitude < 0;
  *value = word[0] == '-' ? -0.0 : 0.0;
  return small;
}

void TextReader::RefuseNumber(const char* what) {
  const std::string_view word = WordAt(word_);
  const char* first = word.data();
  const char* last = first + word.size();
  if (first != last && *first == '+') ++first;
  double value = 0;
  const auto [stop, problem] = std::from_chars(first, last, value);
  if (!word.empty() && stop == last) {
    if (problem == std::errc::result_out_of_range)
      FailExpected("a number that a double can hold", what);
    if (problem == std::errc() && !std::isfinite(value)) FailExpected("a finite number", what);
  }
  FailExpected("a number", what);
}

std::uint64_t TextReader::Integer(const char* what) {
  SkipBlanks();
  word_ = cursor_;
  const char* first = cursor_;
  if (first != end_ && *first == '+') ++first;
  std::uint64_t value = 0;
  const auto [stop, problem] = std::from_chars(first, end_, value);
  if (problem != std::errc() || (stop != end_ && !IsBreak(*stop)))
    FailExpected("a whole number, 0 or greater", what);
  cursor_ = stop;
  return value;
}

bool TextReader::Accept(std::string_view word) {
  SkipBlanks();
  if (WordAt(cursor_) != word) return false;
  word_ = cursor_;
  cursor_ += word.size();
  return true;
}

bool TextReader::AtLineEnd() {
  SkipBlanks();
  return cursor_ == end_ || *cursor_ == '\n';
}

void TextReader::ExpectEnd() {
  if (AtLineEnd()) return;
  word_ = cursor_;
  FailExpected("the end of the line", nullptr);
}

std::string_view TextReader::Rest() {
  SkipBlanks();
  word_ = cursor_;
  const char* first = cursor_;
  const void* next = std::memchr(cursor_, '\n', static_cast<std::size_t>(end_ - cursor_));
  cursor_ = next ? static_cast<const char*>(next) : end_;
  const char* last = cursor_;
  while (last != first && IsBlank(last[-1])) --last;
  return {first, static_cast<std::size_t>(last - first)};
}

void TextReader::Seek(std::size_t offset) { line_ = word_ = cursor_ = begin_ + offset; }

std::size_t TextReader::LineNumber(std::size_t offset) const {
  return 1 + static_cast<std::size_t>(std::count(begin_, begin_ + offset, '\n'));
}

void TextReader::FailAt(std::size_t offset, const std::string& message) const {
  std::size_t line_begin = offset;
  while (line_begin > 0 && begin_[line_begin - 1] != '\n') --line_begin;
  throw Error(std::string(name_), LineNumber(offset), offset - line_begin + 1, Printable(message));
}

void TextReader::FailExpected(const char* expected, const char* what) {
  std::string message = std::string("expected ") + expected;
  if (what) message += std::string(" (") + what + ")";
  const std::string_view word = WordAt(word_);
  if (!word.empty()) {
    message += ", found " + Quoted(word);
  } else {
    message += word_ == end_ ? ", found the end of the file" : ", found the end of the line";
  }
  Fail(message);
}

std::string Printable(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string printable;
  for (const char c : text) {
    if (c >= ' ' && c <= '~') {
      printable += c;
    } else {
      printable += {'\\', 'x', kHex[(c >> 4) & 15], kHex[c & 15]};
    }
  }
  return printable;
}

std::string Quoted(std::string_view word) {
  constexpr std::size_t kLongest = 60;
  return "'" + Printable(word.substr(0, kLongest)) + (word.size() > kLongest ? "...'" : "'");
}

void AppendNumber(std::string* text, double number) {
  char digits[32];  // the longest is -2.2250738585072014e-308
  const auto [end, problem] = std::to_chars(digits, digits + sizeof(digits), number);
  (void)problem;
  text->append(digits, static_cast<std::size_t>(end - digits));
}

void AppendInteger(std::string* text, std::uint64_t number) {
  char digits[20];
  const auto [end, problem] = std::to_chars(digits, digits + sizeof(digits), number);
  (void)problem;
  text->append(digits, static_cast<std::size_t>(end - digits));
}

}  // namespace graticule
