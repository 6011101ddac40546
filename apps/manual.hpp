#pragma once

#include <string>
#include <vector>

namespace graticule::apps {

/// A word of a command: an option with its names, or a positional one.
struct ManualOption {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional its one name
  std::string argument;            ///< "FILE"; "" where there is none
  std::string range;               ///< "1 - 1000", "POSITIVE"; "" where nothing is said
  std::vector<std::string> choices;
  std::string standard;  ///< what holds where it is not given; "" where nothing is said
  std::string help;
  bool argument_may_miss = false;  ///< --name or --name=VALUE
  bool is_required = false;
  bool takes_several = false;  ///< values one after the other

  bool TakesValue() const { return !argument.empty(); }
  /// A value of it may be a file's name.
  bool TakesFile() const;
};

/// A command as the manual and the shells know it.
struct ManualCommand {
  std::vector<std::string> words;  ///< "graticule", "calibrate", "guide"
  std::string summary;
  std::string notes;     ///< what its help ends with, before the examples
  std::string examples;  ///< a line each, indented by two spaces
  std::vector<ManualOption> positionals, options;
  std::vector<ManualCommand> commands;  ///< below it

  std::string Name() const { return Joined(" "); }
  /// "graticule-calibrate-guide": of its page.
  std::string PageName() const { return Joined("-"); }

 private:
  std::string Joined(const char* between) const;
};

/// The command and all below it, in the order of their declaration.
std::vector<const ManualCommand*> WithCommandsBelow(const ManualCommand& program);

/// A page of section 1 in the macros man(7), for one command of `program`; `source` is the footer's
/// "graticule 0.1.0".
std::string ManualPage(const ManualCommand& command, const ManualCommand& program,
                       const std::string& source);

/// With a full stop, and a capital where it begins with a word of prose.
std::string Sentence(std::string text);
/// What an option takes and is for, in sentences: its help, its choices or range, and its default.
std::string Explained(const ManualOption& option, bool is_positional);

/// The pages of graticule-vision and graticule-mpi, which people have no need to call.
std::string VisionPage(const std::string& source);
std::string MpiPage(const std::string& source);

/// docs/reference.md: every command with its options, in one page.
std::string MarkdownReference(const ManualCommand& program);

/// Completion scripts, of commands, options, choices and files.
std::string BashCompletion(const ManualCommand& program);
std::string ZshCompletion(const ManualCommand& program);
std::string FishCompletion(const ManualCommand& program);

}  // namespace graticule::apps
