#include "graticule/io/problem_file.hpp"

#include "graticule/io/bal.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/g2o.hpp"
#include "graticule/io/text.hpp"
#include "graticule/io/toro.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

struct Extension {
  std::string_view ending;
  ProblemFormat format;
};
constexpr Extension kExtensions[] = {{".fg", ProblemFormat::kRecording},
                                     {".g2o", ProblemFormat::kG2o},
                                     {".graph", ProblemFormat::kToro},
                                     {".toro", ProblemFormat::kToro},
                                     {".bal", ProblemFormat::kBal}};

bool BeginsWith(std::string_view word, std::string_view beginning) {
  return word.substr(0, beginning.size()) == beginning;
}

bool IsToroTag(std::string_view word) {
  for (const std::string_view tag :
       {"VERTEX", "VERTEX2", "VERTEX3", "EDGE", "EDGE2", "EDGE3", "EQUIV"})
    if (word == tag) return true;
  return false;
}

bool IsG2oTag(std::string_view word) {
  return BeginsWith(word, "VERTEX_") || BeginsWith(word, "EDGE_") || BeginsWith(word, "PARAMS_") ||
         word == "FIX";
}

bool IsNumber(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::optional<ProblemFormat> FormatOfName(std::string_view path) {
  for (const Extension& extension : kExtensions)
    if (HasEnding(WithoutGz(path), extension.ending)) return extension.format;
  return std::nullopt;
}

std::optional<ProblemFormat> FormatOfContents(std::string_view text) {
  TextReader reader(text, "");
  while (reader.NextLine()) {
    const std::string_view word = reader.Word();
    if (word == "graticule-problem") return ProblemFormat::kRecording;
    if (word[0] == '#') continue;
    if (IsToroTag(word)) return ProblemFormat::kToro;
    if (IsG2oTag(word)) return ProblemFormat::kG2o;
    if (IsNumber(word) && IsNumber(reader.Word()) && IsNumber(reader.Word()))
      return ProblemFormat::kBal;
    return std::nullopt;
  }
  return std::nullopt;
}

Recording ParseProblem(std::string_view text, const std::string& path, const Registry& types,
                       const ReadOptions& options) {
  std::optional<ProblemFormat> format = FormatOfName(path);
  if (!format) format = FormatOfContents(text);
  if (!format) {
    if (text.empty()) throw Error(path + ": the file is empty");
    throw Error(path, 1, 1,
                "expected a problem of .fg, g2o, TORO or BAL, found " +
                    Quoted(text.substr(0, text.find_first_of(" \t\r\n"))));
  }
  switch (*format) {
    case ProblemFormat::kRecording:
      return ParseRecording(text, path, types, options);
    case ProblemFormat::kG2o:
      return ParseG2o(text, path, types, options);
    case ProblemFormat::kToro:
      return ParseToro(text, path, types, options);
    case ProblemFormat::kBal:
      break;
  }
  return ParseBal(text, path, types);
}

Recording ReadProblem(const std::string& path, const Registry& types, const ReadOptions& options) {
  const std::string contents = ReadFile(path);
  return ParseProblem(contents, path == "-" ? "standard input" : path, types, options);
}

std::vector<std::string> WriteProblem(const std::string& path, const Recording& recording,
                                      const WriteOptions& options) {
  std::optional<ProblemFormat> format = options.format;
  if (!format) format = FormatOfName(path);
  if (!format && HasEnding(WithoutGz(path), ".txt")) format = ProblemFormat::kBal;
  if (!format)
    throw Error(path +
                    ": the name does not say a format; expected .fg, .g2o, .graph, .toro, .bal "
                    "or .txt (BAL), also with .gz",
                ErrorKind::kUsage);
  std::vector<std::string> notes;
  std::string contents;
  try {
    switch (*format) {
      case ProblemFormat::kRecording:
        contents = FormatRecording(recording, options.binary);
        break;
      case ProblemFormat::kG2o:
        contents = FormatG2o(recording, &notes);
        break;
      case ProblemFormat::kToro:
        contents = FormatToro(recording, &notes);
        break;
      case ProblemFormat::kBal:
        contents = FormatBal(recording, &notes);
        break;
    }
  } catch (const Error& error) {
    throw Error(path + ": " + error.what(), error.Kind());
  }
  WriteFile(path, contents);
  return notes;
}

}  // namespace graticule
