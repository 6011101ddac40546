#include "manual.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "commands.hpp"
#include "graticule/io/file.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/provenance.hpp"
#include "output_folder.hpp"

namespace graticule::apps {

bool ManualOption::TakesFile() const {
  return choices.empty() && (argument == "TEXT" || argument == "FILE" || argument == "YAML" ||
                             argument == "OUT" || argument == "RADIO=FILE");
}

std::string ManualCommand::Joined(const char* between) const {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : between) + word;
  return joined;
}

std::string Sentence(std::string text) {
  if (text.empty()) return text;
  const std::size_t word = text.find_first_of(" ,:;.");
  const bool is_prose =
      std::all_of(text.begin(),
                  text.begin() + static_cast<std::ptrdiff_t>(std::min(word, text.size())),
                  [](unsigned char c) { return std::islower(c) || c == '-'; }) &&
      word != 0 && (word == std::string::npos || text[word] != ':');
  if (is_prose) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  if (text.back() != '.') text += '.';
  return text;
}

std::string Explained(const ManualOption& option, bool is_positional) {
  std::string text = Sentence(option.help);
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : " ") + more; };
  if (!option.choices.empty()) {
    std::string choices;
    for (const std::string& choice : option.choices)
      choices += (choices.empty() ? "" : ", ") + choice;
    add("One of " + choices + ".");
  }
  if (!option.range.empty()) {
    std::string range = option.range;
    std::transform(range.begin(), range.end(), range.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::size_t dash = range.find(" - ");
    if (dash != std::string::npos) range.replace(dash, 3, " to ");
    add("A number: " + range + ".");
  }
  if (!option.standard.empty()) add("Default: " + option.standard + ".");
  if (option.is_required && !is_positional) add("Has to be given.");
  return text.empty() ? "A file." : text;
}

std::vector<const ManualCommand*> WithCommandsBelow(const ManualCommand& program) {
  std::vector<const ManualCommand*> all{&program};
  for (const ManualCommand& command : program.commands)
    for (const ManualCommand* below : WithCommandsBelow(command)) all.push_back(below);
  return all;
}

int Run(const WriteManualCommand& command, const Console&) {
  const ManualCommand& program = *command.program;
  if (command.what == "man") {
    if (command.output.empty())
      throw Error("manual man: expected --output and a folder for the pages", ErrorKind::kUsage);
    const std::string source = "graticule " + Version();
    const OutputFolder folder(command.output);
    for (const ManualCommand* page : WithCommandsBelow(program))
      folder.Write(page->PageName() + ".1", ManualPage(*page, program, source));
    folder.Write("graticule-vision.1", VisionPage(source));
    folder.Write("graticule-mpi.1", MpiPage(source));
    return kDone;
  }
  const std::string text = command.what == "bash"   ? BashCompletion(program)
                           : command.what == "zsh"  ? ZshCompletion(program)
                           : command.what == "fish" ? FishCompletion(program)
                                                    : MarkdownReference(program);
  if (command.output.empty())
    fmt::print("{}", text);
  else
    WriteFile(command.output, text);
  return kDone;
}

}  // namespace graticule::apps
