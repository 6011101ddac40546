#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace graticule {

/// Reads lines of whitespace-separated words (space, tab; a carriage return counts as a blank, so
/// files of either line ending load), and knows where it is.  It looks at the text and copies
/// nothing; line and column are only computed for an error, by counting.  The text and the name
/// must outlive the reader.
///
/// Every refusal is an Error "file:line:column: expected ..., found '...'".  `what` says in words
/// what is being read ("the x of the vertex"), and may be null.
class TextReader {
 public:
  TextReader(std::string_view text, std::string_view name);

  /// Goes to the first word of the next line that is not blank.  False at the end of the text.
  bool NextLine();
  /// Skips blanks and line ends: for formats that are a stream of numbers.  False at the end.
  bool NextWord();

  /// The next word of this line, or "" at its end.
  std::string_view Word();
  /// The next word of this line; refuses the end of the line.
  std::string_view Word(const char* what);
  /// A finite number.
  double Double(const char* what);
  /// A whole number, 0 or greater.
  std::uint64_t Integer(const char* what);
  /// True, and the word is passed, if the next word of this line is this one.
  bool Accept(std::string_view word);
  /// Whether this line has no more words.
  bool AtLineEnd();
  /// Refuses more words in this line.
  void ExpectEnd();
  /// What is left of this line, without blanks around it.
  std::string_view Rest();

  // --- places: offsets in bytes from the beginning of the text

  std::size_t Offset() const { return static_cast<std::size_t>(cursor_ - begin_); }
  /// Of the first word of this line.
  std::size_t LineOffset() const { return static_cast<std::size_t>(line_ - begin_); }
  /// Of the word that was read last.
  std::size_t WordOffset() const { return static_cast<std::size_t>(word_ - begin_); }
  /// Goes on reading at an offset, which begins a line or a word.
  void Seek(std::size_t offset);
  std::size_t Size() const { return static_cast<std::size_t>(end_ - begin_); }
  /// The text's name, as errors say it.
  std::string_view Name() const { return name_; }

  std::size_t LineNumber(std::size_t offset) const;
  [[noreturn]] void FailAt(std::size_t offset, const std::string& message) const;
  /// At the word that was read last.
  [[noreturn]] void Fail(const std::string& message) const { FailAt(WordOffset(), message); }
  /// "expected EXPECTED (WHAT), found ...", at the word that was read last.
  [[noreturn]] void FailExpected(const char* expected, const char* what);

 private:
  void SkipBlanks();
  std::string_view WordAt(const char* first) const;
  [[noreturn]] void RefuseNumber(const char* what);
  bool Underflows(double* value);

  const char* begin_;
  const char* end_;
  const char* cursor_;
  const char* line_;
  const char* word_;
  std::string_view name_;
  bool started_ = false;  // NextLine was called: the cursor is in a line that it has to leave
};

/// Bytes that are not printable ASCII as \x1b: an error message is one line, and no file's contents
/// steer a terminal.
std::string Printable(std::string_view text);

/// A word of a file for an error message: in quotes, cut after 60 bytes, unprintable bytes as \x1b.
std::string Quoted(std::string_view word);

/// The shortest text that reads back as the same number, to the bit.
void AppendNumber(std::string* text, double number);
void AppendInteger(std::string* text, std::uint64_t number);

}  // namespace graticule
