#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/read_options.hpp"
#include "graticule/io/recording.hpp"

namespace graticule {

/// Reads a g2o file (docs/formats.md lists the tags).  Vertex ids become keys `pose:ID` and
/// `landmark:ID`.  Vertices may stand anywhere; in a file with edges only, they are made from the
/// edges and `has_initial_guess` is false.  Throws Error "name:line:column: ...".
Recording ParseG2o(std::string_view text, const std::string& name, const Registry& types,
                   const ReadOptions& options = {});

/// The recording as a g2o file.  Keys that g2o cannot express become comments, which ParseG2o reads
/// back.  What is lost (losses) is said in `notes`, one line each.  Throws Error for types that g2o
/// has no tag for.
std::string FormatG2o(const Recording& recording, std::vector<std::string>* notes);

}  // namespace graticule
