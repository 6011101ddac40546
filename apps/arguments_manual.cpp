#include "arguments_parts.hpp"
#include "manual.hpp"

namespace graticule::apps {
namespace {

constexpr char kExamples[] = "Examples:\n";

// CLI11 says type and checks as "TEXT:{half,double,full}" and "INT:INT in [1 - 1000]".
void ReadTypeName(const std::string& text, ManualOption* option) {
  const std::size_t colon = text.find(':');
  option->argument = colon == 0 ? "TEXT" : text.substr(0, colon);  // a flag's value has no type
  if (colon == std::string::npos) return;
  std::string checks = text.substr(colon + 1);
  if (checks.size() > 1 && checks.front() == '{' && checks.back() == '}') {
    for (std::string& choice : CLI::detail::split(checks.substr(1, checks.size() - 2), ','))
      option->choices.push_back(std::move(choice));
    return;
  }
  const std::size_t open = checks.find('['), close = checks.find(']');
  option->range = open == std::string::npos || close == std::string::npos
                      ? checks
                      : checks.substr(open + 1, close - open - 1);
}

ManualOption Describe(const CLI::Option& option) {
  ManualOption described;
  if (option.get_positional()) {
    described.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) described.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) described.names.push_back("--" + name);
  }
  const std::string type = option.get_type_name();
  if (!type.empty() && (option.get_items_expected_max() > 0 || type.find('{') != type.npos))
    ReadTypeName(type, &described);
  described.argument_may_miss =
      described.TakesValue() && option.get_items_expected_min() == 0 && !option.get_positional();
  if (described.TakesValue()) described.standard = option.get_default_str();
  described.help = option.get_description();
  described.is_required = option.get_required();
  described.takes_several = option.get_expected_max() == CLI::detail::expected_max_vector_size &&
                            option.get_allow_extra_args();
  return described;
}

ManualCommand Describe(const CLI::App& app, std::vector<std::string> words) {
  ManualCommand command;
  words.push_back(app.get_name());
  command.words = words;
  command.summary = app.get_description();
  const std::string footer = app.get_footer();
  const std::size_t examples = footer.find(kExamples);
  command.notes = footer.substr(0, examples);
  if (examples != std::string::npos)
    command.examples = footer.substr(examples + sizeof(kExamples) - 1);
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? command.positionals : command.options).push_back(Describe(*option));
  for (const CLI::App* sub : app.get_subcommands({}))
    command.commands.push_back(Describe(*sub, words));
  return command;
}

}  // namespace

void AddManual(CLI::App* app, Chosen* chosen) {
  auto command = std::make_shared<WriteManualCommand>();
  CLI::App* sub = AddCommand(
      app, "manual", "write the manual's pages, or a shell's completion of the command line",
      "  graticule manual bash > ~/.local/share/bash-completion/completions/graticule\n"
      "  graticule manual man -o ~/.local/share/man/man1 && man graticule-solve",
      command, chosen);
  sub->add_option("WHAT", command->what,
                  "man: a page a command; a shell; or markdown: docs/reference.md")
      ->required()
      ->check(CLI::IsMember({"man", "bash", "zsh", "fish", "markdown"}));
  sub->add_option("-o,--output", command->output,
                  "of man: the folder for the pages; else a file instead of stdout");
  sub->callback([app, command, chosen] {
    command->program = std::make_shared<ManualCommand>(Describe(*app, {}));
    *chosen = [command](const Console& console) { return Run(*command, console); };
  });
}

}  // namespace graticule::apps
