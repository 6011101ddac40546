#include <algorithm>
#include <cctype>
#include <string_view>

#include "manual.hpp"

// What man(1) shows: the macros of man(7).

namespace graticule::apps {
namespace {

// As text of a page: what roff would take for its own is said otherwise.
std::string Escaped(std::string_view text) {
  std::string escaped;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) escaped += "\\&";
    switch (c) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      case '`':
        escaped += "\\(ga";
        break;
      case '^':
        escaped += "\\(ha";
        break;
      case '~':
        escaped += "\\(ti";
        break;
      default:
        escaped += c;
    }
    starts_line = c == '\n';
  }
  return escaped;
}

std::string Bold(std::string_view text) { return "\\fB" + Escaped(text) + "\\fR"; }
std::string Slanted(std::string_view text) { return "\\fI" + Escaped(text) + "\\fR"; }

std::string Argument(const ManualOption& option) {
  std::string text = Slanted(option.argument);
  return option.takes_several ? text + " ..." : text;
}

std::string Item(const ManualOption& option, bool is_positional) {
  std::string names;
  if (is_positional) {
    names = Slanted(option.names.front()) + (option.takes_several ? " ..." : "");
  } else {
    for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + Bold(name);
    if (option.argument_may_miss)
      names += "[=" + Argument(option) + "]";
    else if (option.TakesValue())
      names += " " + Argument(option);
  }
  return ".TP\n" + names + "\n" + Escaped(Explained(option, is_positional)) + "\n";
}

std::string Synopsis(const ManualCommand& command) {
  std::string text = Bold(command.Name());
  if (!command.commands.empty() && command.positionals.empty()) {
    text += " [" + Slanted("OPTIONS") + "] " + Slanted("COMMAND") + " ...";
  } else {
    text += " [" + Slanted("OPTIONS") + "]";
    for (const ManualOption& positional : command.positionals) {
      std::string word =
          Slanted(positional.names.front()) + (positional.takes_several ? " ..." : "");
      text += positional.is_required ? " " + word : " [" + word + "]";
    }
  }
  return text + "\n";
}

std::string Upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string Title(const std::string& page, const std::string& source) {
  // No date: the same program gives the same pages.
  return ".TH " + Escaped(Upper(page)) + " 1 \"\" \"" + Escaped(source) + "\" \"Graticule\"\n";
}

std::string Reference(const std::string& page) { return Bold(page) + "(1)"; }

// "Exit codes: 0 done, 1 failed." as a list.
std::string ExitCodes(const std::string& notes) {
  constexpr std::string_view kStart = "Exit codes: ";
  if (notes.compare(0, kStart.size(), kStart) != 0) return "";
  std::string text = ".SH EXIT STATUS\n";
  std::string_view rest = std::string_view(notes).substr(kStart.size());
  while (!rest.empty()) {
    const std::size_t comma = rest.find(", ");
    std::string_view code = rest.substr(0, comma);
    rest = comma == rest.npos ? std::string_view() : rest.substr(comma + 2);
    while (!code.empty() && (code.back() == '\n' || code.back() == '.')) code.remove_suffix(1);
    const std::size_t space = code.find(' ');
    text += ".TP\n" + Bold(code.substr(0, space)) + "\n" +
            Escaped(Sentence(std::string(code.substr(space + 1)))) + "\n";
  }
  return text;
}

constexpr char kEnvironment[] =
    ".SH ENVIRONMENT\n"
    ".TP\n\\fBGRATICULE_PLUGIN_PATH\\fR\n"
    "Folders with plug\\-ins, separated by colons; looked in after \\fB\\-\\-plugin\\fR.\n"
    ".TP\n\\fBGRATICULE_CONFIG_PATH\\fR\n"
    "A folder with configurations, NAME.yaml each; looked in before the installed ones.\n"
    ".TP\n\\fBNO_COLOR\\fR\n"
    "Set and not empty: no colour.\n";

}  // namespace

std::string ManualPage(const ManualCommand& command, const ManualCommand& program,
                       const std::string& source) {
  const bool is_program = command.words.size() == 1;
  std::string summary = command.summary;
  if (!summary.empty() && summary.back() == '.') summary.pop_back();
  std::string text = Title(command.PageName(), source);
  text += ".SH NAME\n" + Escaped(command.PageName()) + " \\- " + Escaped(summary) + "\n";
  text += ".SH SYNOPSIS\n" + Synopsis(command);
  for (const ManualCommand& below : command.commands)
    if (!is_program) text += ".br\n" + Synopsis(below);
  text += ".SH DESCRIPTION\n" + Escaped(Sentence(summary)) + "\n";
  if (!command.positionals.empty())
    for (const ManualOption& positional : command.positionals) text += Item(positional, true);
  if (!command.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const ManualCommand& below : command.commands)
      text +=
          ".TP\n" + Reference(below.PageName()) + "\n" + Escaped(Sentence(below.summary)) + "\n";
  }
  text += ".SH OPTIONS\n";
  for (const ManualOption& option : command.options) text += Item(option, false);
  if (is_program) {
    text += ExitCodes(command.notes) + kEnvironment;
  } else {
    for (const ManualOption& option : program.options)  // of every command
      if (option.names.front() == "-q") text += Item(option, false);
  }
  if (!command.examples.empty())
    text += ".SH EXAMPLES\n.nf\n" + Escaped(command.examples) +
            (command.examples.back() == '\n' ? "" : "\n") + ".fi\n";
  text += ".SH SEE ALSO\n";
  std::string also;
  if (!is_program) also = Reference(program.PageName());
  for (const ManualCommand& below : command.commands)
    also += (also.empty() ? "" : ",\n") + Reference(below.PageName());
  return text + also + "\n";
}

std::string VisionPage(const std::string& source) {
  return Title("graticule-vision", source) +
         ".SH NAME\ngraticule\\-vision \\- the part of graticule that looks at pictures\n"
         ".SH SYNOPSIS\n\\fBgraticule\\-vision\\fR \\fICOMMAND\\fR ...\n"
         ".SH DESCRIPTION\n"
         "Runs the commands of \\fBgraticule\\fR(1) that need the readers of pictures and films. "
         "\\fBgraticule\\fR becomes this program by itself for these: there is no need to call it. "
         "It takes the same words.\n"
         ".SH SEE ALSO\n\\fBgraticule\\fR(1)\n";
}

std::string MpiPage(const std::string& source) {
  return Title("graticule-mpi", source) +
         ".SH NAME\ngraticule\\-mpi \\- graticule over the processes of a launcher\n"
         ".SH SYNOPSIS\n\\fBmpirun \\-n\\fR \\fIN\\fR \\fBgraticule compare\\fR ...\n"
         ".br\n\\fBmpirun \\-n\\fR \\fIN\\fR \\fBgraticule signal tune\\fR ...\n"
         ".br\n\\fBsrun \\-n\\fR \\fIN\\fR \\fBgraticule compare\\fR ...\n"
         ".SH DESCRIPTION\n"
         "Runs the commands of \\fBgraticule\\fR(1) that spread their work over the processes that "
         "a "
         "launcher has started. \\fBgraticule\\fR becomes this program by itself where it sees "
         "one: "
         "there is no need to call it. It takes the same words.\n"
         ".SH ENVIRONMENT\n"
         ".TP\n\\fBGRATICULE_LAUNCHER\\fR\n"
         "\\fInone\\fR: a launcher is not looked for, and each process does its own work.\n"
         ".SH SEE ALSO\n\\fBgraticule\\fR(1),\n\\fBgraticule\\-compare\\fR(1),\n"
         "\\fBgraticule\\-signal\\-tune\\fR(1),\n\\fBmpirun\\fR(1)\n";
}

}  // namespace graticule::apps
