#pragma once

namespace graticule::apps {

/// Reads the command line, runs what it asks for, and returns the exit code.  Prints usage errors
/// and help; throws graticule::Error from the command itself.
int RunFromArguments(int argc, char** argv);

}  // namespace graticule::apps
