#include "manual.hpp"

namespace graticule::apps {
namespace {

// In a cell of a table, outside of code.
std::string Cell(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') cell += '\\';
    cell += c;
  }
  return cell;
}

std::string Row(const ManualOption& option, bool is_positional) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "`" : "`, `") + name;
  if (!is_positional && option.TakesValue())
    names += (option.argument_may_miss ? "[=" : " ") + option.argument +
             (option.argument_may_miss ? "]" : "");
  if (option.takes_several) names += " ...";
  return "| " + names + "` | " + Cell(Explained(option, is_positional)) + " |\n";
}

}  // namespace

std::string MarkdownReference(const ManualCommand& program) {
  std::string text =
      "# Every command and option\n\nWritten by `graticule manual markdown`, from what the program "
      "takes; a test holds this page against it. `graticule\nCOMMAND --help` and `man "
      "graticule-COMMAND` say the same. Exit codes, output and environment: "
      "[the command](command.md).\n";
  for (const ManualCommand* command : WithCommandsBelow(program)) {
    text += "\n## " + command->Name() + "\n\n" + Sentence(command->summary) + "\n";
    text += "\n| | |\n|---|---|\n";
    for (const ManualOption& positional : command->positionals) text += Row(positional, true);
    for (const ManualOption& option : command->options)
      if (command == &program || option.names.front() != "-h") text += Row(option, false);
    for (const ManualCommand& below : command->commands)
      text += "| `" + below.words.back() + "` | " + Cell(Sentence(below.summary)) + " |\n";
  }
  return text;
}

}  // namespace graticule::apps
