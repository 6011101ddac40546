#include "graticule/io/recording.hpp"

#include <iterator>

#include "graticule/io/checksum.hpp"
#include "graticule/io/recording_parts.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::string_view kMagic = "graticule-problem";
constexpr std::size_t kHashDigits = 16;

// Header lines that are free text, in the order of writing.
struct TextLine {
  std::string_view word;
  std::string Recording::*member;
};
constexpr TextLine kTextLines[] = {{"title", &Recording::title},
                                   {"made-by", &Recording::made_by},
                                   {"frames", &Recording::frames},
                                   {"solved-by", &Recording::solved_by}};

constexpr std::string_view kRotationWords[] = {"half", "double", "full"};

// Where the line `end` begins; it must be the last one.
std::size_t FindEnd(std::string_view text, const TextReader& whole) {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  if (last == std::string_view::npos) whole.FailAt(0, "the file is empty");
  const std::size_t line_break = text.rfind('\n', last);
  const std::size_t begin = line_break == std::string_view::npos ? 0 : line_break + 1;
  const std::string_view line = text.substr(begin, last + 1 - begin);
  if (line.substr(0, 4) != "end ")
    whole.FailAt(begin, "expected 'end COUNT' in the last line, found " + Quoted(line) +
                            ": the file was cut short, or goes on after its end");
  return begin;
}

// Reads `end COUNT [xxh64 HEX]`, checks the checksum and returns the count.
std::size_t ReadEnd(std::string_view text, std::size_t begin, std::string_view name) {
  TextReader reader(text, name);
  reader.Seek(begin);
  reader.Word();
  const std::size_t count = reader.Integer("the number of variables and factors");
  if (reader.AtLineEnd()) {
    // Written by hand.  Without the line's end it may as well be a checksum that was cut off.
    if (text.find('\n', begin) == std::string_view::npos)
      reader.FailAt(text.size(), "the file was cut short: expected the end of the line 'end'");
    return count;
  }
  if (!reader.Accept("xxh64")) {
    reader.Word();
    reader.FailExpected("'xxh64'", "the checksum's kind");
  }
  const std::string_view written = reader.Word("the checksum");
  if (written.size() != kHashDigits) reader.FailExpected("16 digits", "the checksum");
  const std::string found = Checksum(text.substr(0, begin));
  if (written != found)
    reader.Fail("the checksum is " + found + ", and the file says " + Quoted(written) +
                ": the file is damaged, or was edited (then end it with 'end " +
                std::to_string(count) + "' alone)");
  reader.ExpectEnd();
  return count;
}

class HeaderReader {
 public:
  HeaderReader(TextReader* reader, Recording* recording)
      : reader_(*reader), recording_(*recording) {}

  /// Up to and with the line `variables N`; returns N.
  std::size_t Read() {
    ReadMagic();
    while (reader_.NextLine()) {
      const std::string_view word = reader_.Word();
      if (word[0] == '#') continue;
      if (word == "variables") {
        const std::size_t count = reader_.Integer("the number of variables");
        reader_.ExpectEnd();
        return count;
      }
      ReadLine(word);
    }
    reader_.FailAt(reader_.Offset(), "expected 'variables N' after the header");
  }

  bool Binary() const { return encoding_ == "binary"; }
  const DeclaredTypes& Types() const { return types_; }

 private:
  void ReadMagic() {
    if (!reader_.NextLine() || reader_.Word() != kMagic)
      reader_.FailExpected("'graticule-problem 1'", "the first line");
    if (reader_.Integer("the format's version") != 1)
      reader_.FailExpected("version 1", "later ones need a later program");
    reader_.ExpectEnd();
  }

  void ReadLine(std::string_view word) {
    for (const TextLine& line : kTextLines)
      if (word == line.word) return ReadOnce(&(recording_.*line.member), true);
    if (word == "report") return ReadOnce(&recording_.report, false);
    if (word == "variable" || word == "factor") return Declare(word == "factor");
    if (word == "encoding") {
      ReadOnce(&encoding_, false);
      if (encoding_ != "text" && encoding_ != "binary")
        reader_.FailExpected("'text' or 'binary'", "the encoding");
    } else if (word == "g2o-rotation") {
      std::string rotation;
      ReadOnce(&rotation, false);
      recording_.g2o_rotation = G2oRotationFromWord(rotation);
      if (!recording_.g2o_rotation)
        reader_.FailExpected("'half', 'double' or 'full'", "the reading of g2o rotations");
    } else if (word == "initial-guess") {
      std::string guess;
      ReadOnce(&guess, false);
      if (guess != "none") reader_.FailExpected("'none'", "the initial guess");
      recording_.has_initial_guess = false;
    } else {
      reader_.FailExpected("a line of the header such as 'title', 'variable' or 'variables N'",
                           nullptr);
    }
  }

  void ReadOnce(std::string* text, bool escaped) {
    if (!text->empty()) reader_.Fail("this line of the header is there twice");
    const std::string_view rest = reader_.Rest();
    *text = escaped ? Unescaped(rest) : std::string(rest);
  }

  void Declare(bool factor) {
    const std::string_view type = reader_.Word("the name of a type");
    const std::size_t place = reader_.WordOffset();
    const std::string_view schema = reader_.Rest();
    try {
      if (factor) {
        types_.factors.push_back(recording_.graph.DeclareFactorType(type, schema));
      } else {
        types_.variables.push_back(recording_.graph.DeclareVariableType(type, schema));
      }
    } catch (const Error& error) {
      reader_.FailAt(place, error.what());
    }
  }

  TextReader& reader_;
  Recording& recording_;
  DeclaredTypes types_;
  std::string encoding_;
};

void AppendHeader(const Recording& recording, bool binary, std::string* text) {
  const auto line = [&](std::string_view word, std::string_view rest) {
    *text += word;
    text->append(word.size() < 10 ? 10 - word.size() : 1, ' ');
    *text += rest;
    *text += '\n';
  };
  *text += kMagic;
  *text += " 1\n";
  for (const TextLine& row : kTextLines)
    if (!(recording.*row.member).empty()) line(row.word, Escaped(recording.*row.member));
  if (recording.g2o_rotation) line("g2o-rotation", ToString(*recording.g2o_rotation));
  if (!recording.has_initial_guess) line("initial-guess", "none");
  if (!recording.report.empty()) {
    std::string report = recording.report;  // in JSON, a line break is only ever a blank
    for (char& c : report)
      if (c == '\n' || c == '\r') c = ' ';
    line("report", report);
  }
  line("encoding", binary ? "binary" : "text");
  for (const VariableType& type : recording.graph.UsedVariableTypes())
    line("variable", type.name + " " + ToString(type.fields));
  for (const FactorType& type : recording.graph.UsedFactorTypes())
    line("factor", type.name + " " + ToString(type.schema));
  *text += "\nvariables ";
  AppendInteger(text, recording.graph.VariableCount());
  *text += '\n';
}

}  // namespace

std::string_view ToString(G2oRotation rotation) {
  return kRotationWords[static_cast<std::size_t>(rotation)];
}

std::optional<G2oRotation> G2oRotationFromWord(std::string_view word) {
  for (std::size_t i = 0; i < std::size(kRotationWords); ++i)
    if (kRotationWords[i] == word) return static_cast<G2oRotation>(i);
  return std::nullopt;
}

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool at_an_end = i == 0 || i + 1 == text.size();
    if (c == '\n') {
      escaped += "\\n";
    } else if (c == '\r') {
      escaped += "\\r";
    } else if (c == '\t' && at_an_end) {
      escaped += "\\t";
    } else if (c == ' ' && at_an_end) {
      escaped += "\\s";
    } else {
      if (c == '\\') escaped += '\\';
      escaped += c;
    }
  }
  return escaped;
}

std::string Unescaped(std::string_view text) {
  constexpr std::string_view kLetters = "nrts\\", kMeanings = "\n\r\t \\";
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t letter = text[i] == '\\' && i + 1 < text.size() ? kLetters.find(text[i + 1])
                                                                      : std::string_view::npos;
    if (letter == std::string_view::npos) {
      plain += text[i];
    } else {
      plain += kMeanings[letter];
      ++i;
    }
  }
  return plain;
}

std::size_t ReadFactorsLine(TextReader* reader) {
  while (reader->NextLine()) {
    const std::string_view word = reader->Word();
    if (word[0] == '#') continue;
    if (word != "factors") reader->FailExpected("'factors N'", "after the variables");
    const std::size_t count = reader->Integer("the number of factors");
    reader->ExpectEnd();
    return count;
  }
  reader->FailAt(reader->Offset(), "expected 'factors N' after the variables");
}

Recording ParseRecording(std::string_view text, const std::string& name, const Registry& types,
                         const ReadOptions& options) {
  const TextReader whole(text, name);
  if (text.substr(0, kMagic.size()) != kMagic && text.find(kMagic) == std::string_view::npos)
    whole.FailAt(0, text.empty() ? "the file is empty"
                                 : "expected 'graticule-problem 1' (the first line), found " +
                                       Quoted(text.substr(0, text.find_first_of(" \r\n"))));
  const std::size_t end = FindEnd(text, whole);
  const std::size_t count = ReadEnd(text, end, name);

  const std::string_view body = text.substr(0, end);
  TextReader reader(body, name);
  Recording recording(types);
  HeaderReader header(&reader, &recording);
  const std::size_t variables = header.Read();
  InformationGuard guard(options.repair_information);
  const std::size_t factors =
      header.Binary()
          ? ReadBinaryBody(&reader, body, name, header.Types(), variables, &guard, &recording)
          : ReadTextBody(&reader, variables, &guard, &recording);
  if (count != variables + factors)
    whole.FailAt(end, "'end' counts " + std::to_string(count) + " variables and factors, found " +
                          std::to_string(variables + factors));
  return recording;
}

std::string FormatRecording(const Recording& recording, bool binary) {
  std::string text;
  AppendHeader(recording, binary, &text);
  if (binary) {
    AppendBinaryBody(recording.graph, &text);
  } else {
    AppendTextBody(recording.graph, &text);
  }
  const std::string hash = Checksum(text);
  text += "end ";
  AppendInteger(&text, recording.graph.VariableCount() + recording.graph.FactorCount());
  text += " xxh64 " + hash + "\n";
  return text;
}

}  // namespace graticule
