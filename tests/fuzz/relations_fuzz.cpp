#include "fuzz.hpp"
#include "graticule/io/relations.hpp"

GRATICULE_FUZZ(text) { graticule::ParseRelations(text, "fuzz.relations"); }
