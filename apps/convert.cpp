#include <fmt/core.h>

#include "commands.hpp"
#include "problem.hpp"

namespace graticule::apps {

int Run(const ConvertCommand& command, const Console& console) {
  ExpectEnding(command.output, "OUT", ProblemEndings());
  ExpectWritable(command.output);
  Recording recording = Load(command.input, command.reading, LoadTypes(command.reading), console);
  if (recording.made_by.empty())
    recording.made_by =
        MadeBy("convert " + command.input + (recording.repaired ? " --repair-information" : ""));
  WriteOptions options;
  options.binary = command.binary;
  for (const std::string& note : WriteProblem(command.output, recording, options))
    console.Note(command.output + ": " + note);
  console.Note(fmt::format("{}: {} variables, {} factors", command.output,
                           recording.graph.VariableCount(), recording.graph.FactorCount()));
  return kDone;
}

}  // namespace graticule::apps
