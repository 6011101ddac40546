#include "graticule/io/config.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// Takes the parser's events instead of a tree of nodes: a tree forgets names that come twice, and
// where things stood.
class Handler : public YAML::EventHandler {
 public:
  Handler(const std::string& name, std::vector<ConfigEntry>* entries)
      : name_(name), entries_(*entries) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) Fail(mark, "expected one YAML document, found a second one");
  }
  void OnDocumentEnd() override {}

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    if (in_map_) RefuseNested(mark, "a mapping");
    in_map_ = true;
  }
  void OnMapEnd() override { in_map_ = false; }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    if (!in_map_) Fail(mark, "expected lines `name: value`, found a list");
    RefuseNested(mark, "a list");
  }
  void OnSequenceEnd() override {}

  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& value) override {
    if (!in_map_) Fail(mark, "expected lines `name: value`, found " + Quoted(value));
    if (has_name_) {
      entries_.back().value = value;
      has_name_ = false;
      return;
    }
    const auto [first, added] = lines_.emplace(value, mark.line + 1);
    if (!added)
      Fail(mark, Quoted(value) + " is there already, in line " + std::to_string(first->second));
    entries_.push_back({value, "", static_cast<std::size_t>(mark.line + 1),
                        static_cast<std::size_t>(mark.column + 1)});
    has_name_ = true;
  }

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (!in_map_) return;  // an empty document
    if (has_name_)
      throw Error(name_, entries_.back().line, entries_.back().column,
                  "expected a value of " + Quoted(entries_.back().name) + ", found none");
    Fail(mark, "expected a name, found none");
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Fail(mark, "expected a plain value, found an alias (*name)");
  }

 private:
  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& message) const {
    throw Error(name_, static_cast<std::size_t>(mark.line + 1),
                static_cast<std::size_t>(mark.column + 1), message);
  }
  [[noreturn]] void RefuseNested(const YAML::Mark& mark, const std::string& found) const {
    Fail(mark, has_name_ ? "expected a plain value of " + Quoted(entries_.back().name) +
                               ", found " + found
                         : "expected a name, found " + found);
  }

  const std::string& name_;
  std::vector<ConfigEntry>& entries_;
  std::map<std::string, int> lines_;
  int documents_ = 0;
  bool in_map_ = false;
  bool has_name_ = false;
};

}  // namespace

std::vector<ConfigEntry> ParseConfig(std::string_view text, const std::string& name) {
  std::vector<ConfigEntry> entries;
  Handler handler(name, &entries);
  std::istringstream stream{std::string(text)};
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(handler)) {
    }
  } catch (const YAML::Exception& error) {
    if (error.mark.is_null()) throw Error(name + ": not YAML: " + Printable(error.msg));
    throw Error(name, static_cast<std::size_t>(error.mark.line + 1),
                static_cast<std::size_t>(error.mark.column + 1),
                "not YAML: " + Printable(error.msg));
  }
  return entries;
}

}  // namespace graticule
