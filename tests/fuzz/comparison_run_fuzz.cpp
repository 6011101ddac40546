#include "fuzz.hpp"
#include "graticule/io/comparison_run.hpp"

// Lines of runs, as a comparison's state has them.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  TextReader reader(text, "fuzz.state");
  while (reader.NextLine()) {
    const std::string once = RunText(ParseRun(&reader));
    TextReader again(once, "again.state");
    again.NextLine();
    if (RunText(ParseRun(&again)) != once) std::abort();
  }
}
