#pragma once

#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "configuration.hpp"
#include "graticule/io/problem_file.hpp"
#include "graticule/io/report_json.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {

/// The built-in types, those of the plug-in folders, and of `--plugin`.  Throws Error
/// (kMissingType).
Registry LoadTypes(const Reading& reading);

/// What the words say of reading.
ReadOptions OptionsOf(const Reading& reading);
/// What has to be said of a file as it was read: lines that were skipped, matrices that were
/// repaired.  Each begins with the file's name.
std::vector<std::string> NotesOf(const Recording& recording, const std::string& file);
/// Reads a problem as the words say, and notes on stderr what was skipped.
Recording Load(const std::string& file, const Reading& reading, const Registry& types,
               const Console& console);

/// Runs `work`; what it throws about the problem gets the file's name in front.
template <class Work>
auto About(const std::string& file, const Work& work) {
  try {
    return work();
  } catch (const graticule::Error& error) {
    if (error.Kind() == ErrorKind::kUsage) throw;
    throw graticule::Error(file + ": " + error.what(), error.Kind());
  }
}

/// The configuration of `--config` with `--set` applied.
Configuration Choose(const Choosing& choosing);

/// Throws Error (kOther) unless a file can be made at this path: before a long solve, not after.
void ExpectWritable(const std::string& path);

/// Endings of the files that problems are written to.
std::vector<std::string> ProblemEndings();
/// The ending without .gz: ".g2o".
std::string Ending(const std::string& path);
/// Throws Error (kUsage) unless the path ends in one of these.
void ExpectEnding(const std::string& path, const char* option,
                  const std::vector<std::string>& endings);

/// Which file gets which family's trajectory: the path itself where there is one family of poses,
/// else `out.robot1.tum`, `out.robot2.tum` for `out.tum`.  None for an empty path.  Throws Error
/// (kUsage) where there are no poses.
std::vector<std::pair<std::string, std::string>> TrajectoryFiles(const std::string& path,
                                                                 const Graph& graph);
/// The same of families that are known.
std::vector<std::pair<std::string, std::string>> FilesOfFamilies(
    const std::string& path, const std::vector<std::string>& families);

/// Who made a recording, and from what: "graticule 0.1.0 convert a.g2o".  Names no outputs: the
/// same words give the same bytes wherever they are written.
std::string MadeBy(const std::string& words);

/// "1234 se2/1, 20 point2/1": how many of each type.
std::string CountVariables(const Graph& graph);
std::string CountFactors(const Graph& graph);

}  // namespace graticule::apps
