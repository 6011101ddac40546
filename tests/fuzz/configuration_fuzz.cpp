#include "fuzz.hpp"
#include "graticule/io/config.hpp"
#include "graticule/problems/attenuation/settings.hpp"
#include "graticule/problems/mapping/front_end.hpp"
#include "graticule/problems/mapping/georeference.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/robustify.hpp"
#include "graticule/solver/options.hpp"

// Every option of a file, offered to each table that has names; a datum where that is one's name.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  for (const ConfigEntry& entry : ParseConfig(text, "fuzz.yaml")) {
    const auto offer = [&](const auto& table, auto options) {
      try {
        SetOption(table, entry.name, entry.value, &options);
      } catch (const Error&) {
        return;
      }
      // What an option says of itself is understood again.
      for (const auto& row : table)
        if (row.name == entry.name && !row.set(options, row.get(options))) std::abort();
    };
    offer(SolveOptionTable(), SolveOptions());
    offer(InitialiseOptionTable(), InitialiseOptions());
    offer(RejectionOptionTable(), RejectionOptions());
    offer(FrontEndOptionTable(), FrontEndOptions());
    if (entry.name == "datum") ParseDatum(entry.value);
  }
}
