#include "fuzz.hpp"
#include "graticule/io/file.hpp"

// What is no gzip is packed and unpacked.
GRATICULE_FUZZ(bytes) {
  using namespace graticule;
  if (Gunzip(Gzip(bytes), "packed.gz") != bytes) std::abort();
  const std::string contents = Gunzip(bytes, "fuzz.gz");
  if (Gunzip(Gzip(contents), "again.gz") != contents) std::abort();
}
