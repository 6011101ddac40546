#include <fmt/core.h>

#include "commands.hpp"
#include "configuration.hpp"
#include "graticule/io/opencv_version.hpp"
#include "graticule/solver/plugin_abi.h"
#include "graticule/solver/provenance.hpp"
#include "problem.hpp"

namespace graticule::apps {

int Run(const OptionsCommand& command, const Console&) {
  if (command.markdown) {
    fmt::print(
        "# Options\n\nWhat a configuration file, `--set NAME=VALUE` and the library's "
        "`SolveOptions` understand.  "
        "Written by\n`graticule options --markdown`; a test holds this page against the "
        "program.\n\n"
        "| option | accepts | default | what it does |\n|---|---|---|---|\n");
    for (OptionLine& line : DescribeOptions()) {
      for (std::size_t i = 0; (i = line.accepts.find('|', i)) != std::string::npos; i += 2)
        line.accepts.insert(i, "\\");
      fmt::print("| `{}` | {} | {} | {} |\n", line.name, line.accepts, line.value, line.help);
    }
    return kDone;
  }
  for (const OptionLine& line : DescribeOptions())
    fmt::print("{:<28} {}\n{:<28} {} (default {})\n", line.name, line.help, "", line.accepts,
               line.value);
  fmt::print("\nready configurations:");
  for (const std::string& name : ReadyConfigurations()) fmt::print(" {}", name);
  fmt::print("\n");
  return kDone;
}

int Run(const TypesCommand& command, const Console&) {
  const Registry types = LoadTypes(command.reading);
  fmt::print("variable types (and vectorN/1 for any N)\n");
  for (const VariableType* type : types.VariableTypes())
    fmt::print("  {:<30} {}\n  {:<30} {} [{}]\n", type->name, ToString(type->fields), "",
               type->summary, type->origin);
  fmt::print(
      "factor types (and gaussian/1, which marginalising makes): blocks | measurement | residual "
      "where it differs\n");
  for (const FactorType* type : types.FactorTypes())
    fmt::print("  {:<30} {}\n  {:<30} {} [{}]\n", type->name, ToString(type->schema), "",
               type->summary, type->origin);
  return kDone;
}

std::string Versions() {
  std::string text = "graticule " + Version();
  for (const auto& [what, which] : Provenance())
    if (what != "graticule") text += "\n  " + what + " " + which;
  text += "\n  opencv " + OpenCvVersion();
  return text + "\n  plugin-abi " + std::to_string(GRATICULE_ABI_VERSION);
}

}  // namespace graticule::apps
