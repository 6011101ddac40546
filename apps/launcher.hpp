#pragma once

#include <string>

namespace graticule::apps {

/// This process among those that a launcher (mpirun, srun) started together.
struct Launched {
  int rank = 0, size = 1;
};

/// As the launcher's environment says; one process by itself where there is none, or where
/// GRATICULE_LAUNCHER is `none`.
Launched LaunchedAs();

/// Throws Error (kUsage) where a launcher started several processes of a command that does not
/// spread its work over them: each would do all of it, and write the same files.
void ExpectAlone(const std::string& command);

/// Becomes the program of this name beside this one, with the same words; returns only by a throw.
/// Throws Error (kOther) "path: LACK: reason".
int Become(const char* program, const char* lack);

}  // namespace graticule::apps
