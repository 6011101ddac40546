#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "commands.hpp"
#include "launcher.hpp"

namespace graticule::apps {

/// A command with its words bound; `run` is set where it was chosen.
using Chosen = std::function<int(const Console&)>;

/// Whether a command spreads its work over a launcher's processes.
template <class Command>
inline constexpr bool kIsSpread =
    std::is_same_v<Command, CompareCommand> || std::is_same_v<Command, SignalTuneCommand>;

/// A subcommand that runs `command`; `examples` end its help.
template <class Command>
CLI::App* AddCommand(CLI::App* app, const char* name, const char* what, const char* examples,
                     std::shared_ptr<Command> command, Chosen* chosen) {
  CLI::App* sub = app->add_subcommand(name, what);
  sub->footer(std::string("Examples:\n") + examples);
  sub->callback([sub, command, chosen] {
    if (!sub->get_subcommands().empty()) return;  // that one was meant
    *chosen = [sub, command](const Console& console) {
      if (!kIsSpread<Command>) ExpectAlone(sub->get_name());
      return Run(*command, console);
    };
  });
  return sub;
}

/// `--plugin`: whose types are loaded beside the built-in ones.
void AddPlugins(CLI::App* sub, Reading* reading);
/// The words that say how problems are read, `--plugin` among them.
void AddReading(CLI::App* sub, Reading* reading);
/// Which configuration and what is changed in it, in these words.
void AddChoosing(CLI::App* sub, Choosing* choosing, const char* config, const char* setting);

/// `graticule calibrate` and what is below it.
void AddCalibrate(CLI::App* app, Chosen* chosen);
/// `graticule signal` and what is below it.
void AddSignal(CLI::App* app, Chosen* chosen);
/// `calibrate --guide ...` as `calibrate guide ...`.
std::vector<std::string> GuideAsCommand(std::vector<std::string> words);

/// `graticule segment`.
void AddSegment(CLI::App* app, Chosen* chosen);
/// `graticule simulate` and what is below it.
void AddSimulate(CLI::App* app, Chosen* chosen);

/// `graticule coregister`.
void AddCoregister(CLI::App* app, Chosen* chosen);

/// `graticule manual`, which describes all the others.
void AddManual(CLI::App* app, Chosen* chosen);

}  // namespace graticule::apps
