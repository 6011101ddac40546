#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/read_options.hpp"
#include "graticule/io/recording.hpp"

namespace graticule {

enum class ProblemFormat { kRecording, kG2o, kToro, kBal };

/// The format that a file's name says (`.fg`, `.g2o`, `.graph`, `.toro`, `.bal`, each also `.gz`),
/// or empty where it says nothing, as with `.txt`.
std::optional<ProblemFormat> FormatOfName(std::string_view path);
/// The format that a file's first words say, or empty.
std::optional<ProblemFormat> FormatOfContents(std::string_view text);

/// Reads a problem file of any format: by its name, and where that says nothing by its contents.
/// `-` is the standard input.  Throws Error.
Recording ReadProblem(const std::string& path, const Registry& types,
                      const ReadOptions& options = {});
/// The same for contents at hand.
Recording ParseProblem(std::string_view text, const std::string& path, const Registry& types,
                       const ReadOptions& options = {});

struct WriteOptions {
  bool binary = false;  ///< `.fg` only
  /// Instead of what the name says: for `/dev/stdout` and the like.
  std::optional<ProblemFormat> format;
};

/// Writes a problem in the format that the name says; `.txt` is BAL.  Returns what the format could
/// not hold, one line each.  Throws Error, and then the file is as it was.
std::vector<std::string> WriteProblem(const std::string& path, const Recording& recording,
                                      const WriteOptions& options = {});

}  // namespace graticule
