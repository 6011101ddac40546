#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/read_options.hpp"
#include "graticule/io/repaired_information.hpp"
#include "graticule/solver/graph.hpp"

namespace graticule {

/// A problem as files carry it: the graph, and what is known about where it came from.
struct Recording {
  explicit Recording(Registry types) : graph(std::move(types)) {}

  Graph graph;
  std::string title;      ///< one line, for people
  std::string made_by;    ///< program, version, command
  std::string frames;     ///< the coordinate frames in use, for people
  std::string solved_by;  ///< empty: the values are an initial guess, not a solution
  std::string report;     ///< what the solver reported, as one line of JSON; kept as it is
  /// Which reading of a g2o file's rotations the factors state; empty where none was taken.
  std::optional<G2oRotation> g2o_rotation;
  /// False: the values are placeholders (a g2o file without vertices), to be initialised first.
  bool has_initial_guess = true;

  /// About the reading, not part of the file: tags that were skipped because they are not known,
  /// and remarks for the user.
  std::map<std::string, std::size_t> skipped;
  std::vector<std::string> notes;
  /// Empty where no information matrix had to be repaired.
  std::optional<RepairedInformation> repaired;
};

/// Reads a recorded problem, text or binary (docs/formats.md).  Types that the registry does not
/// know are taken from the file's header.  Throws Error "name:line:column: ..." for anything that
/// is not whole: cut short anywhere, checksum, counts, numbers, keys, schemas that differ.  Of the
/// options only `repair_information` matters here.
Recording ParseRecording(std::string_view text, const std::string& name, const Registry& types,
                         const ReadOptions& options = {});

/// The recording as a file's contents.  The same recording gives the same bytes, and reading them
/// gives the same graph to the last bit, as text and as binary.
std::string FormatRecording(const Recording& recording, bool binary = false);

}  // namespace graticule
