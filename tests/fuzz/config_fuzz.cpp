#include "fuzz.hpp"
#include "graticule/io/config.hpp"

GRATICULE_FUZZ(text) { graticule::ParseConfig(text, "fuzz.yaml"); }
