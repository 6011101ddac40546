#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>

#include "graticule/io/document.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Takes the parser's events instead of its tree, which forgets names that come twice.
class Builder : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& name) : name_(name) {}

  DocumentNode Take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) Fail(mark, "expected one YAML document, found a second one");
    root_ = Node(mark, DocumentNode::Kind::kNothing);
  }
  void OnDocumentEnd() override {}

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Begin(Node(mark, DocumentNode::Kind::kMap));
  }
  void OnMapEnd() override { End(); }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Begin(Node(mark, DocumentNode::Kind::kList));
  }
  void OnSequenceEnd() override { End(); }

  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& value) override {
    if (ExpectsKey()) {
      std::vector<std::string>& keys = open_.back().keys;
      if (std::find(keys.begin(), keys.end(), value) != keys.end())
        Fail(mark, Quoted(value) + " is there already");
      // A list of names that is searched for each of them: what a person writes has few.
      if (keys.size() >= kMostKeys) Fail(mark, "expected at most 1000 names");
      keys.push_back(value);
      return;
    }
    DocumentNode node = Node(mark, DocumentNode::Kind::kScalar);
    node.text = value;
    Put(std::move(node));
  }

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (ExpectsKey()) Fail(mark, "expected a name, found none");
    Put(Node(mark, DocumentNode::Kind::kNothing));
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Fail(mark, "expected a plain value, found an alias (*name)");
  }

 private:
  static constexpr std::size_t kMostKeys = 1000;

  DocumentNode Node(const YAML::Mark& mark, DocumentNode::Kind kind) const {
    DocumentNode node;
    node.kind = kind;
    node.file = name_;
    node.line = static_cast<std::size_t>(mark.line + 1);
    node.column = static_cast<std::size_t>(mark.column + 1);
    return node;
  }

  bool ExpectsKey() const {
    return !open_.empty() && open_.back().IsMap() &&
           open_.back().keys.size() == open_.back().values.size();
  }

  void Begin(DocumentNode node) {
    if (ExpectsKey()) node.FailExpected("a name");
    open_.push_back(std::move(node));
  }

  void End() {
    DocumentNode node = std::move(open_.back());
    open_.pop_back();
    Put(std::move(node));
  }

  void Put(DocumentNode node) {
    if (open_.empty())
      root_ = std::move(node);
    else
      open_.back().values.push_back(std::move(node));
  }

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& message) const {
    Node(mark, DocumentNode::Kind::kNothing).Fail(message);
  }

  const std::string& name_;
  DocumentNode root_;
  std::vector<DocumentNode> open_;
  int documents_ = 0;
};

}  // namespace

DocumentNode ParseYaml(std::string_view text, const std::string& name) {
  std::string own(text);
  // OpenCV's first line is not YAML's, which has a blank for the colon.
  if (own.compare(0, 6, "%YAML:") == 0) own[0] = '#';
  std::istringstream stream(own);
  Builder builder(name);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    if (error.mark.is_null()) throw Error(name + ": not YAML: " + Printable(error.msg));
    throw Error(name, static_cast<std::size_t>(error.mark.line + 1),
                static_cast<std::size_t>(error.mark.column + 1),
                "not YAML: " + Printable(error.msg));
  }
  DocumentNode root = builder.Take();
  root.file = name;
  return root;
}

}  // namespace graticule
