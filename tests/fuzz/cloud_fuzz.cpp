#include "fuzz.hpp"
#include "graticule/io/cloud_files.hpp"
#include "graticule/io/sweep.hpp"

// The first byte chooses the format.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  if (text.empty()) return;
  const std::string_view rest = text.substr(1);
  switch (text[0]) {
    case 'p': {
      const std::string once = FormatPcd(ParsePcd(rest, "fuzz.pcd"));
      if (FormatPcd(ParsePcd(once, "again.pcd")) != once) std::abort();
      break;
    }
    case 'l': {
      const std::string once = FormatPly(ParsePly(rest, "fuzz.ply"));
      if (FormatPly(ParsePly(once, "again.ply")) != once) std::abort();
      break;
    }
    case 'k':
      OrganiseSpinning(ParseKittiScan(rest, "fuzz.bin"));
      break;
    default: {
      const std::string once = FormatSweep(ParseSweep(text, "fuzz.csv"));
      const Sweep again = ParseSweep(once, "again.csv");
      if (FormatSweep(again) != once) std::abort();
      ToCloud(again);
    }
  }
}
