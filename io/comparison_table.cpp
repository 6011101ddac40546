#include <algorithm>

#include "graticule/io/comparison.hpp"
#include "graticule/io/comparison_columns.hpp"
#include "graticule/io/readable.hpp"

namespace graticule {
namespace {

constexpr std::size_t kWidest = 120, kGap = 2, kWidestName = 32;

// Columns given up first where the table is too wide.
constexpr const char* kExpendable[] = {"linear", "CPU", "solve", "RPE", "memory", "ATE", "gap"};

// One line, at most `width` columns of the terminal; control characters become spaces.
std::string Clip(const std::string& text, std::size_t width) {
  std::string line = text;
  for (char& c : line)
    if ((c >= 0 && c < ' ') || c == 0x7f) c = ' ';
  if (DisplayWidth(line) <= width) return line;
  while (!line.empty() && DisplayWidth(line) + 1 > width) {
    while ((static_cast<unsigned char>(line.back()) & 0xc0) == 0x80 && line.size() > 1)
      line.pop_back();
    line.pop_back();
  }
  return line + "…";
}

// A remark on as many lines as it takes.
std::string Wrapped(std::string text) {
  std::string lines;
  while (DisplayWidth(text) > kWidest) {
    std::size_t cut = text.rfind(' ', kWidest);
    if (cut == std::string::npos || cut == 0) break;
    lines += Clip(text.substr(0, cut), kWidest) + "\n";
    text.erase(0, cut + 1);
  }
  return lines + Clip(text, kWidest) + "\n";
}

std::string Padded(const std::string& text, std::size_t width, bool right) {
  const std::size_t used = DisplayWidth(text);
  const std::string pad(width > used ? width - used : 0, ' ');
  return right ? pad + text : text + pad;
}

std::string Coloured(const std::string& text, const char* code, bool colour) {
  return colour ? std::string("\x1b[") + code + "m" + text + "\x1b[0m" : text;
}

// The best is starred, so that it shows without colour too.
std::string CellText(const ComparisonColumn& column, const ComparisonCell& cell) {
  return column.number ? cell.text + (cell.best ? "*" : " ") : Clip(cell.text, kWidestName);
}

std::size_t ColumnWidth(const ComparisonColumn& column) {
  std::size_t width = DisplayWidth(column.name) + (column.number ? 1 : 0);
  for (const ComparisonCell& cell : column.cells)
    width = std::max(width, DisplayWidth(CellText(column, cell)));
  return width;
}

std::size_t TableWidth(const std::vector<ComparisonColumn>& columns) {
  std::size_t width = 0;
  for (const ComparisonColumn& column : columns) width += ColumnWidth(column) + kGap;
  return width - kGap;
}

// What the errors refer to; of several families each one's absolute error, aligned by itself.
std::string AgainstTruth(const ComparisonBlock& block) {
  constexpr std::size_t kMost = 8, kWidth = 12;
  std::string head, body;
  for (const ComparisonRun* run : block.runs) {
    if (!run->accuracy || run->accuracy->families.empty()) continue;
    const auto& families = run->accuracy->families;
    const std::size_t shown = std::min(families.size(), kMost);
    const bool first = head.empty();
    if (first) head = Padded("ATE of each [m]", kWidestName - kWidth, false);
    body += Padded(Clip(run->configuration, kWidestName - kWidth), kWidestName - kWidth, false);
    for (std::size_t i = 0; i < shown; ++i) {
      if (first) head += Padded(Clip(families[i].family, kWidth - 1), kWidth, true);
      body += Padded(ReadableNumber(families[i].ate.translation_m.rmse, 3), kWidth, true);
    }
    if (first && shown < families.size()) head += " …";
    body += "\n";
  }
  if (!head.empty()) head += "\n" + body;
  for (const ComparisonRun* run : block.runs)
    if (run->accuracy) return head + Wrapped("truth: " + AccuracyTitle(*run->accuracy));
  return head;
}

std::string Table(const ComparisonBlock& block, bool colour) {
  std::vector<ComparisonColumn> columns;
  for (const ComparisonColumn& column : block.columns)
    if (column.main) columns.push_back(column);
  for (const char* name : kExpendable) {
    if (TableWidth(columns) <= kWidest) break;
    columns.erase(std::remove_if(columns.begin(), columns.end(),
                                 [&](const auto& column) { return column.name == name; }),
                  columns.end());
  }
  std::string head, body;
  for (const ComparisonColumn& column : columns) {
    const bool last = &column == &columns.back();
    head += Padded(column.name + (column.number ? " " : ""), last ? 0 : ColumnWidth(column),
                   column.number) +
            (last ? "" : std::string(kGap, ' '));
  }
  for (std::size_t i = 0; i < block.runs.size(); ++i) {
    for (const ComparisonColumn& column : columns) {
      const ComparisonCell& cell = column.cells[i];
      const bool last = &column == &columns.back();
      const std::string text =
          Padded(CellText(column, cell), last ? 0 : ColumnWidth(column), column.number);
      body += cell.best  ? Coloured(text, "1;32", colour)
              : cell.bad ? Coloured(text, "31", colour)
                         : text;
      body += last ? "\n" : std::string(kGap, ' ');
    }
  }
  std::string table = Coloured(Clip(block.file, kWidest), "1", colour) + "\n";
  table += Coloured(head, "2", colour) + "\n" + body;
  table += AgainstTruth(block);
  for (const std::string& remark : block.remarks) table += Wrapped(remark);
  for (const ComparisonRun* run : block.runs)
    if (!run->error.empty())
      table += Clip(run->configuration, kWidestName) + ": " +
               Clip(run->error, kWidest - kWidestName - 2) + "\n";
  return table;
}

}  // namespace

std::string ComparisonTable(const Comparison& comparison, bool colour) {
  std::string out;
  bool starred = false;
  for (const ComparisonBlock& block : ComparisonBlocks(comparison)) {
    if (!out.empty()) out += "\n";
    out += Table(block, colour);
    for (const ComparisonColumn& column : block.columns)
      for (const ComparisonCell& cell : column.cells) starred = starred || cell.best;
  }
  if (starred)
    out +=
        Coloured("* best of its column; times and memory: of those that converged", "2", colour) +
        "\n";
  return out;
}

}  // namespace graticule
