#include "fuzz.hpp"
#include "graticule/io/csv_table.hpp"

GRATICULE_FUZZ(text) {
  using namespace graticule;
  CsvTable table(text, "fuzz.csv");
  const std::size_t x = table.Find({"x", "y"});
  while (table.Next()) {
    for (std::size_t i = 0; i < table.Columns().size(); ++i)
      if (table.Cell(i).find(',') != std::string_view::npos) std::abort();
    if (x != CsvTable::kNone) table.Number(x);
  }
}
