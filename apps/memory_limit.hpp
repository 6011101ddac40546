#pragma once

namespace graticule::apps {

/// Where the address space is limited (`ulimit -v`): takes what OpenBLAS will need while there is
/// some, for OpenBLAS tries for ever where it gets none.  Throws Error (kOther) that says how much
/// is there and how much is needed.
void TakeMemoryOfBlas();

/// From here on a library that aborts (Ceres and GLib do where memory runs out under them) ends the
/// program with one error and an exit code: kOtherFailure where memory is limited, else kInternal.
/// Where memory is limited so does one that crashes, as fontconfig does.
void EndCleanlyWhereLibrariesAbort();

}  // namespace graticule::apps
