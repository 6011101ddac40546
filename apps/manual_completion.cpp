#include <algorithm>
#include <string_view>

#include "manual.hpp"

// What the shells ask when Tab is pressed.  Each script first finds out which command the words so
// far have reached ("graticule signal fit"), then offers that command's words.

namespace graticule::apps {
namespace {

using Commands = std::vector<const ManualCommand*>;

std::string Join(const std::vector<std::string>& words, const char* between = " ") {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : between) + word;
  return joined;
}

std::vector<std::string> NamesBelow(const ManualCommand& command) {
  std::vector<std::string> names;
  for (const ManualCommand& below : command.commands) names.push_back(below.words.back());
  return names;
}

// "'graticule solve' | 'graticule signal' | ...": every command but the program itself.
std::string Paths(const Commands& commands) {
  std::vector<std::string> paths;
  for (const ManualCommand* command : commands)
    if (command->words.size() > 1) paths.push_back("'" + command->Name() + "'");
  return Join(paths, " | ");
}

// Of every command: --quiet, which only the program declares.
std::vector<ManualOption> OptionsOf(const ManualCommand& command, const ManualCommand& program) {
  std::vector<ManualOption> options = command.options;
  if (command.words.size() > 1)
    for (const ManualOption& option : program.options)
      if (option.names.front() == "-q") options.push_back(option);
  return options;
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

// A text between single quotes, for the shells of the Bourne family.
std::string Quoted(const std::string& text) { return "'" + Replaced(text, "'", "'\\''") + "'"; }

bool HasChoices(const ManualOption& option) { return !option.choices.empty(); }

// In zsh's _arguments ':' ends a part, and '[' ']' hold the help.
std::string ZshText(std::string text) {
  for (const char* special : {":", "[", "]"})
    text = Replaced(text, special, "\\" + std::string(special));
  return text;
}

std::string ZshValue(const ManualOption& option) {
  std::string what = ZshText(option.argument.empty() ? option.names.front() : option.argument);
  if (HasChoices(option)) return ":" + what + ":(" + Join(option.choices) + ")";
  return ":" + what + ":" + (option.TakesFile() ? "_files" : " ");
}

std::string FishText(const std::string& text) {
  return "'" + Replaced(Replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

}  // namespace

std::string BashCompletion(const ManualCommand& program) {
  const Commands commands = WithCommandsBelow(program);
  std::string text =
      "# bash completion for graticule; written by `graticule manual bash`\n"
      "_graticule()\n{\n"
      "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "    local command=graticule words= options= values= i\n"
      "    COMPREPLY=()\n"
      "    if [[ $cur == = ]]; then cur=\n"  // --name=VALUE arrives in three words
      "    elif [[ $prev == = ]]; then prev=${COMP_WORDS[COMP_CWORD-2]}; fi\n"
      "    for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "        case \"$command ${COMP_WORDS[i]}\" in\n"
      "            " +
      Paths(commands) +
      ") command+=\" ${COMP_WORDS[i]}\" ;;\n"
      "        esac\n"
      "    done\n"
      "    case $command in\n";
  for (const ManualCommand* command : commands) {
    std::vector<std::string> options, words = NamesBelow(*command);
    std::string values;
    for (const ManualOption& option : OptionsOf(*command, program)) {
      options.insert(options.end(), option.names.begin(), option.names.end());
      if (!option.TakesValue()) continue;
      const std::string which = HasChoices(option)   ? Quoted(Join(option.choices))
                                : option.TakesFile() ? "files"
                                                     : "none";
      // Where the value may miss, the next word is a value only after '='.
      const std::string when = option.argument_may_miss ? "[[ ${COMP_WORDS[COMP_CWORD]} == = || "
                                                          "${COMP_WORDS[COMP_CWORD-1]} == = ]] && "
                                                        : "";
      values += "                " + Join(option.names, " | ") + ") " + when + "values=" + which +
                " ;;\n";
    }
    for (const ManualOption& positional : command->positionals)
      words.insert(words.end(), positional.choices.begin(), positional.choices.end());
    text += "        '" + command->Name() + "')\n            words=" + Quoted(Join(words)) +
            "\n            options=" + Quoted(Join(options)) + "\n";
    if (!values.empty()) text += "            case $prev in\n" + values + "            esac\n";
    text += "            ;;\n";
  }
  return text +
         "    esac\n"
         "    case $values in\n"
         "        none) return ;;\n"
         "        files | '') ;;\n"
         "        *) mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$cur\"); return ;;\n"
         "    esac\n"
         "    if [[ -z $values && $cur == -* ]]; then\n"
         "        mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$cur\")\n"
         "        return\n"
         "    fi\n"
         "    if [[ -z $values && -n $words ]]; then\n"
         "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$cur\")\n"
         "        [[ ${#COMPREPLY[@]} -gt 0 ]] && return\n"
         "    fi\n"
         "    [[ $command == graticule ]] && return\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")\n"
         "}\n"
         "complete -F _graticule graticule\n";
}

std::string ZshCompletion(const ManualCommand& program) {
  const Commands commands = WithCommandsBelow(program);
  std::string text =
      "#compdef graticule\n"
      "# zsh completion for graticule; written by `graticule manual zsh`\n"
      "_graticule() {\n"
      "  local command=graticule at=1 i\n"
      "  for ((i = 2; i < CURRENT; ++i)); do\n"
      "    case \"$command $words[i]\" in\n"
      "      (" +
      Paths(commands) +
      ") command+=\" $words[i]\"; at=$i ;;\n"
      "    esac\n"
      "  done\n"
      "  shift $((at - 1)) words\n"
      "  ((CURRENT -= at - 1))\n"
      "  case $command in\n";
  for (const ManualCommand* command : commands) {
    text += "    ('" + command->Name() + "')\n      _arguments -S";
    for (const ManualOption& option : OptionsOf(*command, program)) {
      const std::string help = "[" + ZshText(option.help) + "]";
      for (const std::string& name : option.names) {
        std::string word = name;
        if (option.argument_may_miss) word += "=-";  // the value only behind '='
        std::string spec = "*" + word + help;
        if (option.TakesValue()) spec += (option.argument_may_miss ? ":" : "") + ZshValue(option);
        text += " \\\n        " + Quoted(spec);
      }
    }
    const std::vector<std::string> names = NamesBelow(*command);
    if (!names.empty()) text += " \\\n        " + Quoted("1:command:(" + Join(names) + ")");
    int place = names.empty() ? 1 : 2;
    for (const ManualOption& positional : command->positionals) {
      const std::string which = positional.takes_several ? "*" : std::to_string(place++);
      const std::string value =
          HasChoices(positional) ? "(" + Join(positional.choices) + ")" : "_files";
      text += " \\\n        " + Quoted(which + ":" + positional.names.front() + ":" + value);
    }
    text += " ;;\n";
  }
  return text + "  esac\n}\n_graticule \"$@\"\n";
}

std::string FishCompletion(const ManualCommand& program) {
  const Commands commands = WithCommandsBelow(program);
  std::string text =
      "# fish completion for graticule; written by `graticule manual fish`\n"
      "function __graticule_at\n"
      "    set -l command graticule\n"
      "    for word in (commandline -opc)[2..-1]\n"
      "        switch \"$command $word\"\n"
      "            case " +
      Replaced(Paths(commands), " | ", " ") +
      "\n"
      "                set command \"$command $word\"\n"
      "        end\n"
      "    end\n"
      "    test \"$command\" = \"$argv\"\n"
      "end\n";
  for (const ManualCommand* command : commands) {
    const std::string begin = "complete -c graticule -n \"__graticule_at " + command->Name() + "\"";
    for (const ManualCommand& below : command->commands)
      text += begin + " -f -a " + below.words.back() + " -d " + FishText(below.summary) + "\n";
    for (const ManualOption& positional : command->positionals)
      if (HasChoices(positional)) text += begin + " -a " + Quoted(Join(positional.choices)) + "\n";
    for (const ManualOption& option : OptionsOf(*command, program)) {
      text += begin;
      for (const std::string& name : option.names)
        text += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (HasChoices(option))
        text += (option.argument_may_miss ? " -f -a " : " -x -a ") + Quoted(Join(option.choices));
      else if (option.TakesFile())
        text += " -r -F";
      else if (option.TakesValue())
        text += " -x";
      text += " -d " + FishText(option.help) + "\n";
    }
  }
  return text;
}

}  // namespace graticule::apps
