// The two small languages that no library of ours reads: OpenCV's XML and Python's literals.

#include <algorithm>

#include "graticule/io/document.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

using Kind = DocumentNode::Kind;

constexpr int kDeepest = 100;  // levels of nesting
constexpr std::size_t kMostKeys = 1000;

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& name)
      : text_(text), name_(name), reader_(text, name) {}

 protected:
  static bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  bool AtEnd() const { return at_ >= text_.size(); }
  char Next() const { return AtEnd() ? '\0' : text_[at_]; }
  bool Begins(std::string_view word) const { return text_.substr(at_, word.size()) == word; }
  void SkipSpace() {
    while (!AtEnd() && IsSpace(text_[at_])) ++at_;
  }
  /// Goes to behind the next of these words.
  void SkipBehind(std::string_view word) {
    const std::size_t found = text_.find(word, at_);
    if (found == std::string_view::npos) FailExpected("'" + std::string(word) + "'");
    at_ = found + word.size();
  }

  DocumentNode Node(Kind kind) {
    DocumentNode node;
    node.kind = kind;
    node.file = name_;
    // Nodes come in the order of the text: lines are counted once.
    for (; counted_ < at_; ++counted_)
      if (text_[counted_] == '\n') {
        ++line_;
        line_begin_ = counted_ + 1;
      }
    node.line = line_;
    node.column = at_ - line_begin_ + 1;
    return node;
  }

  [[noreturn]] void Fail(const std::string& message) const {
    reader_.FailAt(std::min(at_, text_.size()), message);
  }
  [[noreturn]] void FailExpected(const std::string& expected) const {
    Fail("expected " + expected + ", found " +
         (AtEnd() ? "the end of the file" : Quoted(text_.substr(at_, 1))));
  }

  std::string_view text_;
  const std::string& name_;
  TextReader reader_;
  std::size_t at_ = 0, counted_ = 0, line_ = 1, line_begin_ = 0;
};

class XmlReader : public Scanner {
 public:
  using Scanner::Scanner;

  DocumentNode Read() {
    SkipMisc();
    std::string root;
    DocumentNode node = Element(&root, 0);
    SkipMisc();
    if (!AtEnd()) FailExpected("the end of the file");
    return node;
  }

 private:
  void SkipMisc() {
    for (;;) {
      SkipSpace();
      if (Begins("<?"))
        SkipBehind("?>");
      else if (Begins("<!--"))
        SkipBehind("-->");
      else
        return;
    }
  }

  std::string Name() {
    const std::size_t first = at_;
    while (!AtEnd() && !IsSpace(Next()) && Next() != '>' && Next() != '/' && Next() != '<') ++at_;
    if (at_ == first) FailExpected("the name of an element");
    return std::string(text_.substr(first, at_ - first));
  }

  DocumentNode Element(std::string* name, int depth) {
    if (depth > kDeepest) Fail("expected at most 100 levels");
    DocumentNode node = Node(Kind::kScalar);
    if (Next() != '<') FailExpected("'<'");
    ++at_;
    *name = Name();
    const std::size_t attributes = at_;
    SkipBehind(">");
    const std::string_view inside = text_.substr(attributes, at_ - 1 - attributes);
    if (!inside.empty() && inside.back() == '/') return node;
    for (;;) {
      if (AtEnd()) FailExpected("'</" + *name + ">'");
      if (Begins("<!--")) {
        SkipBehind("-->");
      } else if (Begins("</")) {
        at_ += 2;
        if (Name() != *name) Fail("expected '</" + *name + ">'");
        SkipSpace();
        if (Next() != '>') FailExpected("'>'");
        ++at_;
        break;
      } else if (Next() == '<') {
        std::string child_name;
        DocumentNode child = Element(&child_name, depth + 1);
        node.kind = Kind::kMap;
        // OpenCV's lists have children that are all called "_".
        if (child_name != "_" && node.Find(child_name))
          child.Fail(Quoted(child_name) + " is there already");
        if (child_name != "_" && node.keys.size() >= kMostKeys)
          child.Fail("expected at most 1000 elements");
        node.keys.push_back(child_name);
        node.values.push_back(std::move(child));
      } else {
        node.text += Next();
        ++at_;
      }
    }
    Trim(&node.text);
    return node;
  }

  static void Trim(std::string* text) {
    while (!text->empty() && IsSpace(text->back())) text->pop_back();
    std::size_t first = 0;
    while (first < text->size() && IsSpace((*text)[first])) ++first;
    text->erase(0, first);
    if (text->size() > 1 && text->front() == '"' && text->back() == '"')
      *text = text->substr(1, text->size() - 2);
  }
};

class PythonReader : public Scanner {
 public:
  using Scanner::Scanner;

  DocumentNode Read() {
    SkipBlank();
    DocumentNode node = Value(0);
    SkipBlank();
    if (!AtEnd()) FailExpected("the end of the file");
    return node;
  }

 private:
  void SkipBlank() {
    for (;;) {
      SkipSpace();
      if (Next() != '#') return;
      at_ = std::min(text_.find('\n', at_), text_.size());
    }
  }

  std::string Text() {
    const char quote = Next();
    std::string text;
    for (++at_;; ++at_) {
      if (AtEnd() || Next() == '\n') FailExpected("the end of the text");
      if (Next() == quote) break;
      if (Next() == '\\') {
        ++at_;
        if (AtEnd()) FailExpected("the end of the text");
      }
      text += Next();
    }
    ++at_;
    return text;
  }

  DocumentNode Value(int depth) {
    if (depth > kDeepest) Fail("expected at most 100 levels");
    const char first = Next();
    if (first == '{') return Dictionary(depth);
    if (first == '[') return Sequence(']', depth);
    if (first == '(') return Sequence(')', depth);
    DocumentNode node = Node(Kind::kScalar);
    if (first == 'b' && at_ + 1 < text_.size() && (text_[at_ + 1] == '\'' || text_[at_ + 1] == '"'))
      ++at_;
    if (Next() == '\'' || Next() == '"') {
      node.text = Text();
      return node;
    }
    const std::size_t begin = at_;
    while (!AtEnd() && !IsSpace(Next()) &&
           std::string_view(",:]})#").find(Next()) == std::string_view::npos)
      ++at_;
    if (at_ == begin) FailExpected("a value");
    node.text = std::string(text_.substr(begin, at_ - begin));
    return node;
  }

  DocumentNode Dictionary(int depth) {
    DocumentNode node = Node(Kind::kMap);
    ++at_;
    for (;;) {
      SkipBlank();
      if (Next() == '}') break;
      if (Next() != '\'' && Next() != '"') FailExpected("a name in quotes");
      const DocumentNode place = Node(Kind::kScalar);
      std::string key = Text();
      if (node.Find(key)) place.Fail(Quoted(key) + " is there already");
      if (node.keys.size() >= kMostKeys) place.Fail("expected at most 1000 names");
      SkipBlank();
      if (Next() != ':') FailExpected("':'");
      ++at_;
      SkipBlank();
      node.values.push_back(Value(depth + 1));
      node.keys.push_back(std::move(key));
      if (!Comma('}')) break;
    }
    ++at_;
    return node;
  }

  DocumentNode Sequence(char end, int depth) {
    DocumentNode node = Node(Kind::kList);
    ++at_;
    for (;;) {
      SkipBlank();
      if (Next() == end) break;
      node.values.push_back(Value(depth + 1));
      if (!Comma(end)) break;
    }
    ++at_;
    return node;
  }

  // Behind a value: whether another may follow.
  bool Comma(char end) {
    SkipBlank();
    if (Next() == end) return false;
    if (Next() != ',') FailExpected(std::string("',' or '") + end + "'");
    ++at_;
    return true;
  }
};

}  // namespace

DocumentNode ParseXml(std::string_view text, const std::string& name) {
  return XmlReader(text, name).Read();
}

DocumentNode ParsePythonLiteral(std::string_view text, const std::string& name) {
  return PythonReader(text, name).Read();
}

}  // namespace graticule
