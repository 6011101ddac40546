#pragma once

// Internal to io/recording*.cpp: the two encodings of a recorded problem's body.

#include <string>
#include <string_view>
#include <vector>

#include "graticule/io/information_guard.hpp"
#include "graticule/io/recording.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

/// The types of a file's header, in the order of its lines: the numbers that a binary body uses.
struct DeclaredTypes {
  std::vector<Graph::TypeId> variables;
  std::vector<Graph::TypeId> factors;
};

/// Line breaks, backslashes and blanks at the ends of a text as \n \r \\ \s, so that it fits the
/// rest of a line.
std::string Escaped(std::string_view text);
std::string Unescaped(std::string_view text);

// Bodies begin after the line `variables N` and reach up to the line `end`.  The readers return the
// number of factors.

std::size_t ReadTextBody(TextReader* reader, std::size_t variables, InformationGuard* guard,
                         Recording* recording);
void AppendTextBody(const Graph& graph, std::string* text);

std::size_t ReadBinaryBody(TextReader* reader, std::string_view text, const std::string& name,
                           const DeclaredTypes& types, std::size_t variables,
                           InformationGuard* guard, Recording* recording);
void AppendBinaryBody(const Graph& graph, std::string* text);

/// Reads the line `factors N`.
std::size_t ReadFactorsLine(TextReader* reader);

}  // namespace graticule
